// Balls: what has a radius, with a mark on what turns.
const hues = new Map(data.followed.map((particle, k) => [particle, k]));

const roundOnes = new Set(motion.round);

// Whether there is anything that covers what is behind it.
const SOLID = motion.faces.length > 0 || (spatial && data.balls.length + motion.round.length > 0);

// Flat faces whose corners lie on a ball go through it; a ball that is smaller by this part does not show
// through them.
const WITHIN = motion.faces.length ? 0.99 : 1;

// All balls: where they are, how large, their colour, and which turn. Fixed ones have no number.
const balls = () => {
  const moving = Array.from(motion.round, (particle, i) => ({
    particle,
    number: i,
    at: Array.from(motion.points.subarray(3 * particle, 3 * particle + 3)),
    radius: motion.radii[i],
    style: hues.has(particle) ? colour(hues.get(particle)) : stage.colours.strong,
    turns: motion.turning.length > 0,
  }));
  const fixed = data.balls.map(([at, radius]) => ({ at, radius: WITHIN * radius, style: stage.colours.face, turns: false }));
  return [...fixed, ...moving];
};

// The canvas a unit of the scene, at a nearness to the eye.
const magnified = (near) => {
  const distance = EYE * camera.radius;
  return camera.fit * camera.zoom * (spatial ? distance / Math.max(distance - near, 0.1 * distance) : 1);
};

// The radius on the canvas: a ball that is there is seen.
const seenRadius = (ball, near) => Math.max(2, ball.radius * magnified(near));

// A wheel: its spokes, the one along its own first axis through to the middle.
const SPOKES = 4;
const drawSpokes = (x, y, size, number) => {
  const [cx, cy] = turned(number, [1, 0, 0]);
  const at = (k, r) => {
    const [c, s] = [Math.cos((2 * Math.PI * k) / SPOKES), Math.sin((2 * Math.PI * k) / SPOKES)];
    return [x + r * (c * cx - s * cy), y - r * (s * cx + c * cy)];
  };
  pen.strokeStyle = stage.colours.paper;
  pen.lineWidth = Math.max(1, Math.min(3, 0.1 * size));
  pen.beginPath();
  for (let k = 0; k < SPOKES; k++) {
    pen.moveTo(...at(k, k === 0 ? 0 : 0.72 * size));
    pen.lineTo(...at(k, 0.97 * size));
  }
  pen.stroke();
};

// The near halves of a ball's three great circles across its axes.
const drawCircles = (x, y, size, number) => {
  const [right, up, eye] = axes();
  const own = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map((axis) => turned(number, axis));
  pen.strokeStyle = stage.colours.paper;
  pen.lineWidth = Math.max(0.8, Math.min(2, 0.06 * size));
  pen.beginPath();
  for (let c = 0; c < 3; c++) {
    let drawing = false;
    for (let k = 0; k <= 32; k++) {
      const [cos, sin] = [Math.cos((Math.PI * k) / 16), Math.sin((Math.PI * k) / 16)];
      const point = [0, 1, 2].map((i) => cos * own[c][i] + sin * own[(c + 1) % 3][i]);
      const near = dot(point, eye) >= 0;
      const at = [x + size * dot(point, right), y - size * dot(point, up)];
      if (near && drawing) pen.lineTo(...at);
      else if (near) pen.moveTo(...at);
      drawing = near;
    }
  }
  pen.stroke();
};

// A ball on the canvas, lit like faces.
const drawBall = (ball, [x, y, near]) => {
  const size = seenRadius(ball, near);
  pen.beginPath();
  pen.arc(x, y, size, 0, 2 * Math.PI);
  const own = hex(ball.style);
  pen.fillStyle = ball.style;
  if (spatial) {
    const shading = pen.createRadialGradient(x - 0.4 * size, y - 0.5 * size, 0.1 * size, x, y, size);
    shading.addColorStop(0, rgb(own.map((light) => 1.1 * light)));
    shading.addColorStop(1, rgb(own.map((light) => 0.62 * light)));
    pen.fillStyle = shading;
  }
  pen.fill();
  if (!spatial) {
    pen.strokeStyle = stage.colours.paper;
    pen.lineWidth = 1.4;
    pen.stroke();
  }
  if (ball.turns && size > 4) (spatial ? drawCircles : drawSpokes)(x, y, size, ball.number);
};
