// The painter: solids on a canvas of two dimensions, far ones first, so that the near ones cover them.
// Where faces pass through each other one covers the other.

// How much light a face of a body in space gets.
const light = (a, b, c) => {
  const p = motion.points;
  const [u, v] = [b, c].map((end) => [0, 1, 2].map((k) => p[3 * end + k] - p[3 * a + k]));
  const normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
  const [right, up, eye] = axes();
  const size = Math.hypot(...normal) || 1;
  const facing = dot(normal, eye) < 0 ? -1 : 1;
  const lit = (facing / size) * (dot(normal, right) * SUN[0] + dot(normal, up) * SUN[1] + dot(normal, eye) * SUN[2]);
  return AMBIENT + SUNLIGHT * Math.max(0, lit);
};

// A face's colour: its field's, or its body's over that of all faces.
const faceColour = ([a, b, c, tint], base) => {
  if (data.field) return shade((motion.values[a] + motion.values[b] + motion.values[c]) / 3);
  return hex(colour(tint)).map((own, i) => TINT * own + (1 - TINT) * base[i]);
};
const TINT = 0.35;

// How much of the ink the sides of faces have.
const WIRE = data.field ? 0.1 : 0.4;

// How far lines stand before the faces that they bound, in radii of the scene.
const LIFT = 0.02;

const paintFace = (corners, base, ink) => {
  const { x, y } = seen;
  const [a, b, c] = corners;
  const lit = spatial ? light(a, b, c) : 1;
  const own = faceColour(corners, base).map((part) => lit * part);
  pen.beginPath();
  pen.moveTo(x[a], y[a]);
  pen.lineTo(x[b], y[b]);
  pen.lineTo(x[c], y[c]);
  pen.closePath();
  pen.fillStyle = rgb(own);
  pen.fill();
  // Without a line neighbours would leave a hair between them.
  pen.strokeStyle = data.wired ? rgb(own.map((part, i) => (1 - WIRE) * part + WIRE * ink[i])) : pen.fillStyle;
  pen.lineWidth = 0.8;
  pen.stroke();
};

const paintSolids = (project) => {
  const { x, y, near } = seen;
  const { faces } = motion;
  const [base, ink] = [stage.colours.face, stage.colours.ink].map(hex);
  const pieces = [];
  for (let k = 0; k < faces.length; k += 4) {
    const depth = (near[faces[k]] + near[faces[k + 1]] + near[faces[k + 2]]) / 3;
    pieces.push({ depth, paint: () => paintFace(faces.subarray(k, k + 4), base, ink) });
  }
  for (const { ends, style, width } of solidLines())
    for (let k = 0; k < ends.length; k += 2) {
      const [a, b] = [ends[k], ends[k + 1]];
      const paint = () => {
        pen.beginPath();
        pen.moveTo(x[a], y[a]);
        pen.lineTo(x[b], y[b]);
        [pen.strokeStyle, pen.lineWidth] = [style, width];
        pen.stroke();
      };
      pieces.push({ depth: 0.5 * (near[a] + near[b]) + LIFT * camera.radius, paint });
    }
  for (const ball of spatial ? balls() : []) {
    const at = project(...ball.at);
    pieces.push({ depth: at[2], paint: () => drawBall(ball, at) });
  }
  if (spatial) pieces.sort((one, other) => one.depth - other.depth);
  pieces.forEach((piece) => piece.paint());
};
