// Names beside marks and balls: each where it covers no ball, no mark and no other name, if need be
// farther out with a line to what it names. Where there is no room it is not written: pointing at what
// is there still says its name. A name stays on its side as long as there is room.
const NAMED = 60;
const CROWD = 400;

// Sides, those that are tried first in front: beside a mark, above a ball.
const BESIDE = [[1, 0], [-1, 0], [0, -1], [0, 1], [1, -1], [1, 1], [-1, -1], [-1, 1]];
const ABOVE = [[0, -1], [0, 1], [1, -1], [-1, -1], [1, 1], [-1, 1], [1, 0], [-1, 0]];
const FARTHER = [0, 16, 36];
const HEIGHT = 15;

// The side of each name, and its width.
const chosen = new Map();
const widths = new Map();
const widthOf = (name) => {
  if (!widths.has(name)) widths.set(name, pen.measureText(name).width);
  return widths.get(name);
};

const meets = (a, b) => a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3];

// What stands in the way of names: balls and marks as circles, and boxes of the canvas's own words.
const inTheWay = () => {
  const { x, y, near, size } = seen;
  const circles = [...motion.round].map((i) => ({ x: x[i], y: y[i], r: size[i] + 2, near: near[i], ball: i }));
  for (const i of [...data.followed, ...data.pinned].slice(0, CROWD))
    if (!roundOnes.has(i)) circles.push({ x: x[i], y: y[i], r: 5, near: near[i], ball: -1 });
  const [w, h] = [stage.width, stage.height];
  const boxes = [[0, h - 46, 190, h], [w - 90, h - 90, w, h]];
  if (data.field) boxes.push([0, 0, BAR.x + BAR.width + 10, BAR.y + BAR.height + 26]);
  return { circles, boxes };
};

// The box of a name on a side of what it names, farther out or not.
const boxOf = (x, y, size, width, [sx, sy], farther) => {
  const out = (size + 6 + farther) * (sx && sy ? Math.SQRT1_2 : 1);
  const [cx, cy] = [x + sx * (out + 0.5 * width), y + sy * (out + 0.5 * HEIGHT)];
  return [cx - 0.5 * width, cy - 0.5 * HEIGHT, cx + 0.5 * width, cy + 0.5 * HEIGHT];
};

const drawNames = () => {
  if (!stage.names || motion.round.length > CROWD) return;
  pen.font = "13px system-ui, sans-serif";
  const { circles, boxes } = inTheWay();
  const covered = (box) =>
    box[0] < 4 || box[2] > stage.width - 4 || box[1] < 2 || box[3] > stage.height - 2 ||
    boxes.some((other) => meets(box, other)) ||
    circles.some(({ x, y, r }) =>
      Math.hypot(x - Math.max(box[0], Math.min(box[2], x)), y - Math.max(box[1], Math.min(box[3], y))) < r);
  for (const particle of [...data.followed, ...data.pinned].slice(0, NAMED)) {
    const [x, y] = [seen.x[particle], seen.y[particle]];
    const size = Math.max(seen.size[particle], 4);
    // What is behind a ball has no name.
    const behind = (circle) => circle.ball >= 0 && circle.ball !== particle &&
      Math.hypot(circle.x - x, circle.y - y) < circle.r && (!spatial || circle.near > seen.near[particle]);
    if (circles.some(behind)) continue;
    const width = widthOf(data.names[particle]);
    const all = roundOnes.has(particle) ? ABOVE : BESIDE;
    const last = chosen.get(particle);
    const tries = last ? [last, ...all.filter((way) => way !== last)] : all;
    const find = () => {
      for (const farther of FARTHER)
        for (const way of tries) {
          const box = boxOf(x, y, size, width, way, farther);
          if (!covered(box)) return { box, way, farther };
        }
    };
    const found = find();
    if (!found) continue;
    const { box, way, farther } = found;
    chosen.set(particle, way);
    boxes.push(box);
    if (farther) {
      const end = [Math.max(box[0], Math.min(box[2], x)), Math.max(box[1] + 2, Math.min(box[3] - 2, y))];
      const whole = Math.hypot(end[0] - x, end[1] - y) || 1;
      pen.beginPath();
      pen.moveTo(x + (size * (end[0] - x)) / whole, y + (size * (end[1] - y)) / whole);
      pen.lineTo(...end);
      pen.strokeStyle = stage.colours.muted;
      pen.lineWidth = 1;
      pen.stroke();
    }
    write(data.names[particle], box[0], box[3] - 3.5, stage.colours.ink);
  }
};
