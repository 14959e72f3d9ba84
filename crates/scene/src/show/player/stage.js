// The stage: what there is at one time, drawn on a canvas, solids between what is behind and before them.
// Three sheets lie on one another: what is behind, solids in WebGL, and what is in front. Without WebGL
// all is drawn on the last.
const [behind, sheet, canvas] = ["behind", "solids", "scene"].map((id) => document.getElementById(id));
const front = canvas.getContext("2d");
let pen = front;
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
  for (const own of surface ? [behind, canvas] : [canvas]) {
    own.width = Math.round(stage.width * ratio);
    own.height = Math.round(stage.height * ratio);
    own.getContext("2d").setTransform(ratio, 0, 0, ratio, 0, 0);
  }
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

// How dark shadows are.
const SHADOW = 0.22;

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
  for (const ends of [motion.springs, motion.looseEdges, motion.rods])
    for (let k = 0; k < ends.length; k += 2) {
      if (ends === motion.rods && now.time >= motion.lasts[k / 2]) continue;
      line(at(ends[k]), at(ends[k + 1]));
    }
  // The surface casts its own.
  for (let k = 0; data.wired && !surface && k < motion.faces.length; k += 4) {
    const corners = motion.faces.subarray(k, k + 3);
    corners.forEach((corner, i) => line(at(corner), at(corners[(i + 1) % 3])));
  }
  pen.strokeStyle = stage.colours.muted;
  pen.globalAlpha = SHADOW;
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

// Marks of pinned particles and of those that are followed and have no radius, near ones last.
const drawMarks = () => {
  const { x, y, near } = seen;
  const marks = data.pinned.map((particle) => ({ particle, pin: true }));
  data.followed.forEach((particle, hue) => {
    if (!roundOnes.has(particle) || motion.dimension === 1) marks.push({ particle, hue });
  });
  if (spatial) marks.sort((one, other) => near[one.particle] - near[other.particle]);
  for (const { particle, pin, hue } of marks) {
    pen.beginPath();
    if (pin) pen.rect(x[particle] - 4, y[particle] - 4, 8, 8);
    else pen.arc(x[particle], y[particle], data.sizes[hue], 0, 2 * Math.PI);
    pen.fillStyle = pin ? stage.colours.ink : colour(hue);
    pen.fill();
    pen.strokeStyle = stage.colours.paper;
    pen.lineWidth = 1.4;
    pen.stroke();
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

// Springs and edges that stand among solids; sides of faces are drawn with those.
const solidLines = () => {
  const [width, style] = data.wired ? [0.6, stage.colours.strong] : [1.4, stage.colours.ink];
  const springs = { ends: motion.springs, style: stage.colours.strong, width: 1.2 };
  return data.field ? [springs] : [{ ends: motion.looseEdges, style, width }, springs];
};

// Lines where there is nothing that could cover them.
const drawLines = () => {
  strokeLines(motion.springs, () => true, stage.colours.strong, motion.springs.length > 4000 ? 0.8 : 1.2);
  for (let k = 0; data.field && k < motion.edges.length; k += 2) {
    const ends = motion.edges.subarray(k, k + 2);
    const own = shade(0.5 * (motion.values[ends[0]] + motion.values[ends[1]]));
    strokeLines(ends, () => true, rgb(own), 5);
  }
  if (!data.field) strokeLines(motion.edges, () => true, stage.colours.ink, 1.4);
};

// A sheet that is wiped and drawn on from here.
const take = (next) => {
  pen = next;
  pen.clearRect(0, 0, stage.width, stage.height);
  pen.lineJoin = pen.lineCap = "round";
};

// The scene at the time that is now.
const drawStage = () => {
  take(surface ? behind.getContext("2d") : front);
  place(now.time);
  if (motion.dimension === 1) return drawGraph();
  const project = look();
  drawFloor(project);
  drawWalls(project);
  drawPaths(project);
  if (surface) {
    drawSurface();
    take(front);
  } else if (SOLID) paintSolids(project);
  if (!SOLID) drawLines();
  strokeLines(motion.rods, (rod) => now.time < motion.lasts[rod], stage.colours.ink, 2.6);
  drawMarks();
  for (const ball of spatial ? [] : balls()) drawBall(ball, project(...ball.at));
  drawNames();
  drawMeasure();
  if (data.field) drawScale();
};
