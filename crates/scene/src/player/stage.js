// The stage: what there is at one time, drawn on a canvas.
const canvas = document.getElementById("scene");
const pen = canvas.getContext("2d");
const stage = { width: 1, height: 1, middle: 1, colours: {}, paths: "trail", names: data.names.length <= 12 };

const COLOURS = 8;
const colour = (turn) => stage.colours[`s${turn % COLOURS}`];

// Takes over the page's size and colours.
const measure = () => {
  const ratio = window.devicePixelRatio || 1;
  const { width, height } = canvas.getBoundingClientRect();
  stage.width = Math.max(1, width);
  stage.height = Math.max(1, height);
  stage.middle = 0.5 * stage.height + 4;
  canvas.width = Math.round(stage.width * ratio);
  canvas.height = Math.round(stage.height * ratio);
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  const style = getComputedStyle(document.documentElement);
  for (const name of ["paper", "ink", "muted", "faint", "strong", "line", "face", "accent", ...Array(COLOURS).keys()]) {
    const key = typeof name === "number" ? `s${name}` : name;
    stage.colours[key] = style.getPropertyValue(`--${key}`).trim();
  }
};

// Strokes lines between particles; in space the far ones are fainter.
const DEPTHS = 6;
const strokeLines = (ends, keep, style, width) => {
  const { x, y, near } = seen;
  const layers = spatial ? DEPTHS : 1;
  const paths = Array.from({ length: layers }, () => new Path2D());
  for (let k = 0; k < ends.length; k += 2) {
    if (!keep(k / 2)) continue;
    const [a, b] = [ends[k], ends[k + 1]];
    const depth = (0.5 * (near[a] + near[b])) / camera.radius;
    const layer = Math.max(0, Math.min(layers - 1, Math.floor((0.5 + 0.5 * depth) * layers)));
    paths[layer].moveTo(x[a], y[a]);
    paths[layer].lineTo(x[b], y[b]);
  }
  pen.strokeStyle = style;
  pen.lineWidth = width;
  paths.forEach((path, layer) => {
    pen.globalAlpha = layers === 1 ? 1 : 0.4 + (0.6 * (layer + 1)) / layers;
    pen.stroke(path);
  });
  pen.globalAlpha = 1;
};

const hex = (text) => [1, 3, 5].map((i) => parseInt(text.slice(i, i + 2), 16));

// How much light a face of a body in space gets: the sun stands to the upper left of the eye.
const light = (a, b, c) => {
  const p = motion.points;
  const [u, v] = [b, c].map((end) => [0, 1, 2].map((k) => p[3 * end + k] - p[3 * a + k]));
  const normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
  const [right, up, eye] = axes();
  const size = Math.hypot(...normal) || 1;
  const facing = dot(normal, eye) < 0 ? -1 : 1;
  const toSun = [-0.4, 0.65, 0.65];
  const lit = (facing / size) * (dot(normal, right) * toSun[0] + dot(normal, up) * toSun[1] + dot(normal, eye) * toSun[2]);
  return 0.55 + 0.5 * Math.max(0, lit);
};

// The colours of a field, from its least value to its largest: viridis.
const RAMP = ["#440154", "#3b528b", "#21918c", "#5ec962", "#fde725"].map(hex);
const shade = (value) => {
  const { least, largest } = data.field;
  const part = Math.max(0, Math.min(1, (value - least) / (largest - least || 1))) * (RAMP.length - 1);
  const low = Math.min(RAMP.length - 2, Math.floor(part));
  return RAMP[low].map((from, i) => from + (part - low) * (RAMP[low + 1][i] - from));
};

// What the colours mean, at the upper left.
const drawScale = () => {
  const { title, least, largest } = data.field;
  const [x, y, width] = [18, 34, 140];
  for (let k = 0; k < width; k++) {
    pen.fillStyle = `rgb(${shade(least + ((largest - least) * k) / width).map(Math.round)})`;
    pen.fillRect(x + k, y, 1.5, 10);
  }
  write(title, x, y - 8, stage.colours.ink);
  write(shown(least), x, y + 26, stage.colours.muted);
  write(shown(largest), x + width, y + 26, stage.colours.muted, "right");
};

// The canvas a unit of the scene, at a nearness to the eye.
const magnified = (near) => {
  const distance = EYE * camera.radius;
  return camera.fit * camera.zoom * (spatial ? distance / Math.max(distance - near, 0.1 * distance) : 1);
};

// A ball, lit like faces.
const drawBall = (x, y, radius, style) => {
  pen.beginPath();
  pen.arc(x, y, radius, 0, 2 * Math.PI);
  const lit = hex(style).map((own) => Math.min(255, Math.round(1.1 * own)));
  const dark = hex(style).map((own) => Math.round(0.62 * own));
  const shading = pen.createRadialGradient(x - 0.4 * radius, y - 0.5 * radius, 0.1 * radius, x, y, radius);
  shading.addColorStop(0, `rgb(${lit})`);
  shading.addColorStop(1, `rgb(${spatial ? dark : lit})`);
  pen.fillStyle = shading;
  pen.fill();
};

// Faces, edges of bodies and springs, far ones first, so that the near ones cover them.
const drawSolids = () => {
  const { x, y, near } = seen;
  const { faces, edges } = motion;
  const pieces = [];
  for (let k = 0; k < faces.length; k += 4)
    pieces.push({ depth: (near[faces[k]] + near[faces[k + 1]] + near[faces[k + 2]]) / 3, face: k });
  const lift = 0.02 * camera.radius;
  const line = (ends, style, width) => {
    for (let k = 0; k < ends.length; k += 2) {
      const [a, b] = [ends[k], ends[k + 1]];
      pieces.push({ depth: 0.5 * (near[a] + near[b]) + lift, a, b, style, width });
    }
  };
  if (!data.wired) line(edges, stage.colours.ink, 1.4);
  else if (!data.field) line(edges, stage.colours.strong, 0.5);
  line(motion.springs, stage.colours.strong, 1.2);
  const project = projector();
  for (const [centre, radius] of data.balls) {
    const [cx, cy, depth] = project(...centre);
    pieces.push({ depth, ball: [cx, cy, radius * magnified(depth)] });
  }
  if (spatial) pieces.sort((one, other) => one.depth - other.depth);
  const base = hex(stage.colours.face);
  for (const { face, ball, a, b, style, width } of pieces) {
    pen.beginPath();
    if (ball) {
      drawBall(...ball, stage.colours.face);
      continue;
    }
    if (face === undefined) {
      pen.moveTo(x[a], y[a]);
      pen.lineTo(x[b], y[b]);
      [pen.strokeStyle, pen.lineWidth] = [style, width];
      pen.stroke();
      continue;
    }
    const [p, q, r, tint] = faces.subarray(face, face + 4);
    pen.moveTo(x[p], y[p]);
    pen.lineTo(x[q], y[q]);
    pen.lineTo(x[r], y[r]);
    pen.closePath();
    const part = spatial ? light(p, q, r) : 1;
    const own = data.field
      ? shade((motion.values[p] + motion.values[q] + motion.values[r]) / 3)
      : hex(colour(tint)).map((own, i) => 0.35 * own + 0.65 * base[i]);
    const mixed = own.map((light) => Math.min(255, Math.round(part * light)));
    pen.fillStyle = pen.strokeStyle = `rgb(${mixed})`;
    pen.fill();
    // Neighbours would leave a hair between them.
    pen.lineWidth = 0.8;
    pen.stroke();
    if (!data.wired) continue;
    [pen.strokeStyle, pen.lineWidth, pen.globalAlpha] = [stage.colours.ink, 0.7, data.field ? 0.12 : 0.4];
    pen.stroke();
    pen.globalAlpha = 1;
  }
};

// What nothing enters, behind everything else.
const drawWalls = (project) => {
  pen.fillStyle = stage.colours.line;
  pen.strokeStyle = stage.colours.muted;
  pen.lineWidth = 0.8;
  for (const corners of data.walls) {
    pen.beginPath();
    for (const corner of corners) pen.lineTo(...project(...corner).slice(0, 2));
    pen.closePath();
    pen.fill();
    pen.stroke();
  }
};

// A floor below a scene that has a downward direction, with the shadow of its lines.
const drawFloor = (project) => {
  if (!spatial || data.floor === null) return;
  const cell = round(0.5 * camera.radius);
  const reach = Math.ceil((1.3 * camera.radius) / cell) * cell;
  const [mx, my] = [0, 1].map((c) => Math.round(camera.target[c] / cell) * cell);
  const line = (a, b) => {
    const [p, q] = [project(a[0], a[1], data.floor), project(b[0], b[1], data.floor)];
    pen.moveTo(p[0], p[1]);
    pen.lineTo(q[0], q[1]);
  };
  pen.beginPath();
  for (let s = -reach; s <= reach + 0.5 * cell; s += cell) {
    line([mx - reach, my + s], [mx + reach, my + s]);
    line([mx + s, my - reach], [mx + s, my + reach]);
  }
  pen.strokeStyle = stage.colours.line;
  pen.lineWidth = 1;
  pen.stroke();
  const at = (i) => [motion.points[3 * i], motion.points[3 * i + 1]];
  pen.beginPath();
  for (const ends of [motion.springs, motion.edges, motion.rods])
    for (let k = 0; k < ends.length; k += 2) {
      if (ends === motion.rods && now.time >= motion.lasts[k / 2]) continue;
      line(at(ends[k]), at(ends[k + 1]));
    }
  for (let k = 0; data.wired && k < motion.faces.length; k += 4) {
    const corners = motion.faces.subarray(k, k + 3);
    corners.forEach((corner, i) => line(at(corner), at(corners[(i + 1) % 3])));
  }
  pen.strokeStyle = stage.colours.muted;
  pen.globalAlpha = 0.22;
  pen.lineWidth = 1.6;
  pen.stroke();
  pen.globalAlpha = 1;
};

// Paths of the particles that are followed: whole and faint, or up to now.
const MOST = 24000;
const drawPaths = (project) => {
  if (stage.paths === "none") return;
  const { times } = motion;
  const moving = data.followed;
  const stride = Math.max(1, Math.ceil((times.length * moving.length) / MOST));
  const last = before(times, now.time);
  moving.forEach((particle, turnOf) => {
    const point = (sample) => project(...[0, 1, 2].map((axis) => sampled(sample, particle, axis)));
    const trace = (end) => {
      pen.beginPath();
      for (let sample = 0; sample < end; sample += stride) {
        const [x, y] = point(sample);
        if (sample) pen.lineTo(x, y);
        else pen.moveTo(x, y);
      }
    };
    pen.strokeStyle = colour(turnOf);
    pen.lineWidth = 1.3;
    if (stage.paths === "whole") {
      pen.globalAlpha = 0.35;
      trace(times.length);
      pen.lineTo(...point(times.length - 1).slice(0, 2));
      pen.stroke();
    }
    pen.globalAlpha = 0.85;
    trace(last + 1);
    pen.lineTo(seen.x[particle], seen.y[particle]);
    pen.stroke();
    pen.globalAlpha = 1;
  });
};

// Marks of pinned particles and of those that are followed, near ones last.
const drawMarks = () => {
  const { x, y, near } = seen;
  const marks = data.pinned.map((particle) => ({ particle, pin: true }));
  data.followed.forEach((particle, turnOf) => marks.push({ particle, turnOf }));
  if (spatial) marks.sort((one, other) => near[one.particle] - near[other.particle]);
  for (const { particle, pin, turnOf } of marks) {
    const radius = pin || motion.dimension === 1 ? 0 : data.radii[turnOf] * magnified(near[particle]);
    const size = Math.max(radius, radius > 0 ? 2 : data.sizes[turnOf]);
    pen.beginPath();
    if (pin) pen.rect(x[particle] - 4, y[particle] - 4, 8, 8);
    else pen.arc(x[particle], y[particle], size, 0, 2 * Math.PI);
    pen.fillStyle = pin ? stage.colours.ink : colour(turnOf);
    pen.fill();
    pen.strokeStyle = stage.colours.paper;
    pen.lineWidth = 1.4;
    pen.stroke();
  }
};

// Names beside marks, each where it covers no other.
const drawNames = () => {
  if (!stage.names) return;
  pen.font = "13px system-ui, sans-serif";
  const taken = [];
  for (const particle of [...data.followed, ...data.pinned].slice(0, 60)) {
    const [x, y, name] = [seen.x[particle], seen.y[particle], data.names[particle]];
    const width = pen.measureText(name).width;
    const places = [[9, 5], [-9 - width, 5], [-0.5 * width, -11], [-0.5 * width, 21]];
    const boxes = places.map(([dx, dy]) => [x + dx, y + dy - 12, x + dx + width, y + dy + 3]);
    const covers = (a, b) => a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3];
    const box = boxes.find((box) => !taken.some((other) => covers(box, other)));
    if (!box) continue;
    taken.push(box);
    write(name, box[0], box[3] - 3, stage.colours.ink);
  }
};

const write = (text, x, y, style, align = "left") => {
  pen.font = "13px system-ui, sans-serif";
  pen.textAlign = align;
  pen.lineJoin = "round";
  pen.strokeStyle = stage.colours.paper;
  pen.lineWidth = 3.5;
  pen.strokeText(text, x, y);
  pen.fillStyle = style;
  pen.fillText(text, x, y);
  pen.textAlign = "left";
};

// A bar of a round length in the middle's distance, and the axes as they are seen.
const drawMeasure = () => {
  const scale = camera.fit * camera.zoom;
  const length = round(150 / scale);
  const [x, y] = [18, stage.height - 18];
  pen.beginPath();
  pen.moveTo(x, y - 5);
  pen.lineTo(x, y);
  pen.lineTo(x + length * scale, y);
  pen.lineTo(x + length * scale, y - 5);
  pen.strokeStyle = stage.colours.muted;
  pen.lineWidth = 1.4;
  pen.stroke();
  write(`${shown(length)} ${data.units.length}`, x, y - 10, stage.colours.muted);
  const [right, up] = axes();
  const [cx, cy] = [stage.width - 46, stage.height - 42];
  ["x", "y", "z"].slice(0, motion.dimension).forEach((name, c) => {
    if (Math.hypot(right[c], up[c]) < 0.15) return;
    pen.beginPath();
    pen.moveTo(cx, cy);
    pen.lineTo(cx + 24 * right[c], cy - 24 * up[c]);
    pen.strokeStyle = stage.colours.muted;
    pen.lineWidth = 1.4;
    pen.stroke();
    write(name, cx + 33 * right[c], cy - 33 * up[c] + 4, stage.colours.muted, "center");
  });
};

// The scene at the time that is now.
const drawStage = () => {
  pen.clearRect(0, 0, stage.width, stage.height);
  place(now.time);
  if (motion.dimension === 1) return drawGraph();
  const project = look();
  pen.lineJoin = pen.lineCap = "round";
  drawFloor(project);
  drawWalls(project);
  drawPaths(project);
  if (motion.faces.length || data.balls.length) drawSolids();
  else {
    strokeLines(motion.springs, () => true, stage.colours.strong, motion.springs.length > 4000 ? 0.8 : 1.2);
    for (let k = 0; data.field && k < motion.edges.length; k += 2) {
      const ends = motion.edges.subarray(k, k + 2);
      const own = shade(0.5 * (motion.values[ends[0]] + motion.values[ends[1]]));
      strokeLines(ends, () => true, `rgb(${own.map(Math.round)})`, 5);
    }
    if (!data.field) strokeLines(motion.edges, () => true, stage.colours.ink, 1.4);
  }
  strokeLines(motion.rods, (rod) => now.time < motion.lasts[rod], stage.colours.ink, 2.6);
  drawMarks();
  drawNames();
  drawMeasure();
  if (data.field) drawScale();
};
