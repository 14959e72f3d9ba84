// The camera: a scene in space is seen from a point that goes round it, a plane from straight above.
const camera = { yaw: 0, pitch: 0, zoom: 1, pan: [0, 0], target: [0, 0, 0], fit: 1, radius: 1 };
const numbers = () => new Float64Array(motion.total);
// Where particles are on the canvas, how near to the eye, and how large, where they have a radius.
const seen = { x: numbers(), y: numbers(), near: numbers(), size: numbers() };
const spatial = motion.dimension === 3;

// Directions to the right, upward and to the eye.
const axes = () => {
  if (!spatial) return [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
  const [cy, sy, cp, sp] = [Math.cos(camera.yaw), Math.sin(camera.yaw), Math.cos(camera.pitch), Math.sin(camera.pitch)];
  return [[-sy, cy, 0], [-sp * cy, -sp * sy, cp], [cp * cy, cp * sy, sp]];
};

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

// The eye's distance from the middle, in radii of the scene: far enough for a mild perspective.
const EYE = 5;

// A function from space to the canvas and the nearness to the eye.
const projector = () => {
  const [[rx, ry, rz], [ux, uy, uz], [ex, ey, ez]] = axes();
  const scale = camera.fit * camera.zoom;
  const distance = EYE * camera.radius;
  const [cx, cy] = [0.5 * stage.width + camera.pan[0], stage.middle + camera.pan[1]];
  const [tx, ty, tz] = camera.target;
  return (x, y, z) => {
    const [dx, dy, dz] = [x - tx, y - ty, z - tz];
    const near = ex * dx + ey * dy + ez * dz;
    const s = spatial ? (scale * distance) / Math.max(distance - near, 0.1 * distance) : scale;
    return [cx + s * (rx * dx + ry * dy + rz * dz), cy - s * (ux * dx + uy * dy + uz * dz), near];
  };
};

// Particles at moments spread over the motion, as many as say how large it is.
const everything = () => {
  const { count, times } = motion;
  const stride = Math.max(1, Math.ceil((count * times.length) / 30000));
  const found = data.walls.flat();
  for (const [at, radius] of data.balls) for (const way of [-radius, radius]) found.push(at.map((x) => x + way));
  for (let k = 0; k < count * times.length; k += stride) {
    const [sample, particle] = [Math.floor(k / count), k % count];
    found.push([0, 1, 2].map((axis) => sampled(sample, particle, axis)));
  }
  for (const sample of [0, times.length - 1])
    for (let i = 0; i < count; i += Math.ceil(count / 2000))
      found.push([0, 1, 2].map((axis) => sampled(sample, i, axis)));
  return found.filter((x) => x.every(Number.isFinite));
};

const extent = (values) => values.reduce(([low, high], x) => [Math.min(low, x), Math.max(high, x)], [Infinity, -Infinity]);

// The view of the whole motion, as the scene asks for it.
const reset = () => {
  const [x, y, z] = data.view;
  camera.yaw = Math.abs(z) > 0.999 ? -Math.PI / 2 : Math.atan2(y, x);
  camera.pitch = Math.asin(Math.max(-1, Math.min(1, z)));
  camera.zoom = 1;
  camera.pan = [0, 0];
  const all = everything();
  const boxes = axes().map((axis) => extent(all.map((x) => dot(axis, x))));
  const middles = boxes.map(([low, high]) => 0.5 * (low + high));
  camera.target = [0, 1, 2].map((c) => axes().reduce((sum, axis, k) => sum + axis[c] * middles[k], 0));
  const reaches = surfaces.map(({ points }) => points.reduce((most, x) => Math.max(most, Math.abs(x)), 0));
  const room = 2 * [...motion.radii, ...reaches].reduce((most, reach) => Math.max(most, reach), 0);
  const sizes = boxes.map(([low, high]) => high - low + room);
  const far = Math.max(...boxes.flat().map(Math.abs));
  // What stays where it is but for rounding is seen from as far as what stays.
  camera.radius = Math.hypot(...sizes) > 1e-9 * far ? 0.5 * Math.hypot(...sizes) : 1;
  camera.sizes = sizes;
  refit();
};

// The scale at which the whole motion fits into the canvas.
const refit = () => {
  const [width, height] = camera.sizes;
  const [w, h] = [stage.width - 90, stage.height - 130];
  const least = 0.02 * camera.radius;
  camera.fit = Math.max(1, Math.min(w, 1e6)) / Math.max(width, least);
  camera.fit = Math.min(camera.fit, h / Math.max(height, least));
  if (spatial) camera.fit *= (EYE - 0.6) / EYE;
};

// Puts every particle on the canvas.
const look = () => {
  const project = projector();
  const { total, points } = motion;
  for (let i = 0; i < total; i++)
    [seen.x[i], seen.y[i], seen.near[i]] = project(points[3 * i], points[3 * i + 1], points[3 * i + 2]);
  motion.round.forEach((particle, i) => {
    seen.size[particle] = Math.max(2, motion.radii[i] * magnified(seen.near[particle]));
  });
  return project;
};

const turn = (dx, dy) => {
  if (!spatial) return shift(dx, dy);
  camera.yaw -= 0.008 * dx;
  camera.pitch = Math.max(-1.55, Math.min(1.55, camera.pitch + 0.008 * dy));
};

const shift = (dx, dy) => {
  camera.pan[0] += dx;
  camera.pan[1] += dy;
};

// Zooms so that what is under the pointer stays there.
const zoom = (factor, x = 0.5 * stage.width, y = stage.middle) => {
  const after = Math.max(0.05, Math.min(500, camera.zoom * factor));
  const ratio = after / camera.zoom;
  camera.zoom = after;
  const [cx, cy] = [x - 0.5 * stage.width, y - stage.middle];
  camera.pan = [cx - ratio * (cx - camera.pan[0]), cy - ratio * (cy - camera.pan[1])];
};
