// The controls: time, pointer, fingers and keys.
const now = { time: motion.start, playing: false, speed: 1, again: true, drawn: 0 };
const element = (id) => document.getElementById(id);

// Time of the scene in a second of the reader's, at speed 1: a round number, about eight seconds in all.
const pace = round((motion.end - motion.start) / 6 || 1);

const announce = () => {
  const { time, range } = { time: moment(now.time), range: element("time") };
  element("clock").textContent = `t = ${time} ${data.units.time}`;
  range.value = String(Math.round((1000 * (now.time - motion.start)) / (motion.end - motion.start || 1)));
  range.setAttribute("aria-valuetext", `${time} ${data.units.time} of ${moment(motion.end)} ${data.units.time}`);
  element("pace").textContent = `${shown(pace * now.speed)} ${data.units.time} a second`;
};

const draw = () => {
  drawStage();
  drawCharts();
  announce();
};

let asked = false;
const redraw = () => {
  if (asked) return;
  asked = true;
  requestAnimationFrame((instant) => {
    asked = false;
    advance(instant);
    draw();
    if (now.playing) redraw();
  });
};

const advance = (instant) => {
  if (!now.playing) return;
  // A tab that was hidden does not jump.
  const passed = Math.min(0.1, Math.max(0, (instant - now.drawn) / 1000));
  now.drawn = instant;
  now.time += passed * pace * now.speed;
  if (now.time < motion.end) return;
  if (now.again && motion.end > motion.start) now.time = motion.start;
  else [now.time, now.playing] = [motion.end, false];
  showPlaying();
};

const showPlaying = () => (element("play").textContent = now.playing ? "Pause" : "Play");

const play = (playing) => {
  if (playing && now.time >= motion.end) now.time = motion.start;
  [now.playing, now.drawn] = [playing, performance.now()];
  showPlaying();
  redraw();
};

const go = (time) => {
  now.time = Math.max(motion.start, Math.min(motion.end, time));
  redraw();
};

// To the next sample or the one before.
const leap = (samples) => {
  play(false);
  const next = before(motion.times, now.time) + samples;
  go(motion.times[Math.max(0, Math.min(motion.times.length - 1, next))]);
};

element("play").addEventListener("click", () => play(!now.playing));
element("time").addEventListener("input", (event) =>
  go(motion.start + (Number(event.target.value) / 1000) * (motion.end - motion.start)));
element("speed").addEventListener("change", (event) => {
  now.speed = Number(event.target.value);
  redraw();
});
element("paths").value = stage.paths;
element("paths").addEventListener("change", (event) => {
  stage.paths = event.target.value;
  redraw();
});
const toggle = (id, read, set) => {
  const show = () => element(id).setAttribute("aria-pressed", String(read()));
  element(id).addEventListener("click", () => {
    set(!read());
    show();
    redraw();
  });
  show();
};
toggle("names", () => stage.names, (on) => (stage.names = on));
toggle("again", () => now.again, (on) => (now.again = on));
element("reset").addEventListener("click", () => {
  reset();
  redraw();
});

// Names where the pointer is.
const tip = element("tip");
const point = (x, y) => {
  let [best, found] = [14, -1];
  for (let i = 0; i < motion.count; i++) {
    const distance = Math.hypot(seen.x[i] - x, seen.y[i] - y) - seen.size[i];
    if (distance < best) [best, found] = [distance, i];
  }
  tip.hidden = found < 0;
  if (found < 0) return;
  const at = ["x", "y", "z"].slice(0, motion.dimension).map((axis, c) => `${axis} ${shown(motion.points[3 * found + c])}`);
  const value = data.field ? `\n${data.field.title} ${shown(motion.values[found])}` : "";
  tip.textContent = `${data.names[found]}\n${at.join("  ")} ${data.units.length}${value}`;
  tip.style.left = `${Math.max(4, Math.min(x + 14, stage.width - tip.offsetWidth - 4))}px`;
  tip.style.top = `${Math.max(4, y - tip.offsetHeight - 10)}px`;
};

// One finger or the mouse turns, with the shift key or the right button it moves, two fingers zoom and
// move.
const fingers = new Map();
const still = motion.dimension === 1;
canvas.classList.toggle("flat", still);
canvas.addEventListener("pointerdown", (event) => {
  canvas.setPointerCapture(event.pointerId);
  fingers.set(event.pointerId, [event.offsetX, event.offsetY]);
  if (event.pointerType !== "mouse") point(event.offsetX, event.offsetY);
});
canvas.addEventListener("pointermove", (event) => {
  const old = fingers.get(event.pointerId);
  const [x, y] = [event.offsetX, event.offsetY];
  if (!old) return point(x, y);
  tip.hidden = true;
  const [other] = [...fingers].filter(([id]) => id !== event.pointerId).map(([, place]) => place);
  fingers.set(event.pointerId, [x, y]);
  if (still) return redraw();
  if (other) {
    const size = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1]);
    zoom(size([x, y], other) / Math.max(1, size(old, other)), 0.5 * (x + other[0]), 0.5 * (y + other[1]));
    shift(0.5 * (x - old[0]), 0.5 * (y - old[1]));
  } else if (event.shiftKey || event.buttons & 2) shift(x - old[0], y - old[1]);
  else turn(x - old[0], y - old[1]);
  redraw();
});
for (const end of ["pointerup", "pointercancel"])
  canvas.addEventListener(end, (event) => fingers.delete(event.pointerId));
canvas.addEventListener("pointerleave", () => (tip.hidden = true));
canvas.addEventListener("contextmenu", (event) => event.preventDefault());
canvas.addEventListener("wheel", (event) => {
  if (still) return;
  event.preventDefault();
  zoom(Math.exp(-0.0015 * event.deltaY), event.offsetX, event.offsetY);
  redraw();
}, { passive: false });
canvas.addEventListener("dblclick", () => {
  reset();
  redraw();
});

const VIEW_KEYS = {
  ArrowLeft: () => turn(-14, 0),
  ArrowRight: () => turn(14, 0),
  ArrowUp: () => turn(0, -14),
  ArrowDown: () => turn(0, 14),
  "+": () => zoom(1.2),
  "=": () => zoom(1.2),
  "-": () => zoom(1 / 1.2),
  0: reset,
};
const KEYS = {
  " ": () => play(!now.playing),
  k: () => play(!now.playing),
  ",": () => leap(-1),
  ".": () => leap(1),
  Home: () => go(motion.start),
  End: () => go(motion.end),
  n: () => element("names").click(),
  p: () => {
    const choices = [...element("paths").options].map((option) => option.value);
    stage.paths = element("paths").value = choices[(choices.indexOf(stage.paths) + 1) % choices.length];
  },
};
window.addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  const own = document.activeElement;
  if (own === canvas && VIEW_KEYS[event.key] && !still) VIEW_KEYS[event.key]();
  else if (KEYS[event.key] && !["SELECT", "BUTTON", "INPUT"].includes(own?.tagName)) KEYS[event.key]();
  else return;
  event.preventDefault();
  redraw();
});

data.charts.forEach(addChart);
measure();
reset();
new ResizeObserver(() => {
  measure();
  refit();
  redraw();
}).observe(canvas);
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
  measure();
  redraw();
});

// `player.html#t=1.5` shows that moment; without one the motion plays, unless the reader wants none.
const asks = () => {
  const wanted = Number.parseFloat(/^#t=(.+)$/.exec(location.hash)?.[1] ?? "");
  if (Number.isFinite(wanted)) {
    play(false);
    go(wanted);
  }
  return Number.isFinite(wanted);
};
window.addEventListener("hashchange", asks);
if (!asks()) play(!matchMedia("(prefers-reduced-motion: reduce)").matches);
draw();
