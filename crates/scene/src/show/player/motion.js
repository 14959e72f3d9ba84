// The motion as it was sampled: where every particle is at a time, and which rods are left.
const data = JSON.parse(document.getElementById("data").textContent);

const bytes = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)).buffer;
const singles = (text) => new Float32Array(bytes(text));
const doubles = (text) => new Float64Array(bytes(text));
const indices = (text) => new Uint32Array(bytes(text));

// Bodies that are seen by a surface: its points follow the body that turns about its centre.
let counted = data.names.length;
const surfaces = data.surfaces.map(({ centre, points }, i) => {
  const own = { centre, first: counted, number: indices(data.round).length + i, points: singles(points) };
  counted += own.points.length / 3;
  return own;
});

const motion = {
  dimension: data.dimension,
  count: data.names.length,
  // With the points of surfaces.
  total: counted,
  times: doubles(data.times),
  positions: singles(data.positions),
  springs: indices(data.springs),
  rods: indices(data.rods),
  edges: indices(data.edges),
  faces: indices(data.faces),
  // Of each rod the time at which it breaks.
  lasts: new Float64Array(indices(data.rods).length / 2).fill(Infinity),
  points: new Float64Array(3 * counted),
  // A number a particle and a sample, and what it is now.
  field: data.field && singles(data.field.values),
  values: new Float64Array(counted),
  // Particles that have a radius, and how those are turned that are bodies, and then those with a surface:
  // quaternions, scalar first.
  round: indices(data.round),
  radii: singles(data.radii),
  turning: singles(data.turns),
  turns: new Float64Array(4 * (indices(data.round).length + surfaces.length)),
};
for (const [rod, time] of data.broken) motion.lasts[rod] = time;

// Edges that are not sides of faces.
const sides = new Set();
const side = (a, b) => Math.min(a, b) * motion.total + Math.max(a, b);
for (let k = 0; data.wired && k < motion.faces.length; k += 4) {
  const [a, b, c] = motion.faces.subarray(k, k + 3);
  for (const [p, q] of [[a, b], [b, c], [c, a]]) sides.add(side(p, q));
}
motion.looseEdges = motion.edges.filter((_, k) => !sides.has(side(motion.edges[k & ~1], motion.edges[k | 1])));
motion.start = motion.times[0];
motion.end = motion.times[motion.times.length - 1];

// The last of ascending times that is not after t.
const before = (times, t) => {
  let [low, high] = [0, times.length - 1];
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (times[middle] <= t) low = middle;
    else high = middle - 1;
  }
  return low;
};

// The coordinates of a particle at a sample.
const sampled = (sample, particle, axis) =>
  axis < motion.dimension
    ? data.origin[axis] + motion.positions[(sample * motion.count + particle) * motion.dimension + axis]
    : 0;

// Turns round bodies and those with a surface as they are between two samples, the shorter way.
const turnRound = (sample, next, part) => {
  const { turning, turns } = motion;
  const count = turning.length && turns.length / 4;
  for (let i = 0; i < count; i++) {
    if (motion.dimension < 3) {
      const [from, to] = [turning[sample * count + i], turning[next * count + i]];
      const half = 0.5 * (from + part * (to - from));
      turns.set([Math.cos(half), 0, 0, Math.sin(half)], 4 * i);
      continue;
    }
    const [from, to] = [sample, next].map((at) => turning.subarray(4 * (at * count + i), 4 * (at * count + i) + 4));
    const side = from.reduce((sum, x, c) => sum + x * to[c], 0) < 0 ? -1 : 1;
    const between = Array.from(from, (x, c) => (1 - part) * x + part * side * to[c]);
    const size = Math.hypot(...between) || 1;
    turns.set(between.map((x) => x / size), 4 * i);
  }
};

// A vector of a body's axes in the world's.
const turned = (i, [x, y, z]) => {
  const [w, a, b, c] = motion.turns.subarray(4 * i, 4 * i + 4);
  const [p, q, r] = [2 * (b * z - c * y), 2 * (c * x - a * z), 2 * (a * y - b * x)];
  return [x + w * p + b * r - c * q, y + w * q + c * p - a * r, z + w * r + a * q - b * p];
};

// Puts all particles where they are at a time, on straight lines from sample to sample.
const place = (t) => {
  const { count, dimension, times, positions, points } = motion;
  const sample = before(times, t);
  const next = Math.min(sample + 1, times.length - 1);
  const part = next > sample ? Math.min(1, Math.max(0, (t - times[sample]) / (times[next] - times[sample]))) : 0;
  const [a, b] = [sample * count * dimension, next * count * dimension];
  for (let i = 0, k = 0; i < count; i++)
    for (let c = 0; c < dimension; c++, k++)
      points[3 * i + c] = data.origin[c] + (1 - part) * positions[a + k] + part * positions[b + k];
  for (let i = 0; motion.field && i < count; i++)
    motion.values[i] = (1 - part) * motion.field[sample * count + i] + part * motion.field[next * count + i];
  turnRound(sample, next, part);
  for (const { centre, first, number, points: own } of surfaces)
    for (let k = 0; k < own.length; k += 3) {
      const arm = turned(number, own.subarray(k, k + 3));
      for (let c = 0; c < 3; c++) points[3 * first + k + c] = points[3 * centre + c] + arm[c];
    }
};

// A number as a reader wants it.
const shown = (x) => {
  if (x === 0) return "0";
  const size = Math.abs(x);
  return size >= 1e-3 && size < 1e6 ? String(Number(x.toPrecision(4))) : x.toExponential(2).replace("e+", "e");
};

// A length of 1, 2 or 5 times a power of ten, at most as large.
const round = (length) => {
  const power = 10 ** Math.floor(Math.log10(length));
  return [5, 2, 1].map((n) => n * power).find((n) => n <= length) ?? power;
};

const decimals = Math.min(12, Math.max(0, Math.ceil(3 - Math.log10(motion.end - motion.start || 1))));
const moment = (t) => (motion.end < 1e-9 ? shown(t) : t.toFixed(decimals));
