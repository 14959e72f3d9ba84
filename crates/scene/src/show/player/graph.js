// A scene on a line: time runs to the right, every particle leaves its line, and now is a mark on it.
const frame = { left: 64, right: 18, top: 40, bottom: 44 };

// The ends of the line; more than rounding is between them.
const line = motion.dimension === 1 ? extent(everything().map((x) => x[0])) : null;

const drawGraph = () => {
  const { times, count, start, end } = motion;
  const [low, high] = line;
  const margin = Math.max(0.05 * (high - low), 1e-9 * Math.max(Math.abs(low), Math.abs(high))) || 1;
  const [w, h] = [stage.width - frame.left - frame.right, stage.height - frame.top - frame.bottom];
  const across = (t) => frame.left + (w * (t - start)) / (end - start || 1);
  const upward = (x) => frame.top + h * (1 - (x - low + margin) / (high - low + 2 * margin));
  pen.lineJoin = "round";
  drawGrid(across, upward, low - margin, high + margin);
  const stride = Math.max(1, Math.ceil((times.length * count) / MOST));
  const cut = across(now.time);
  for (let particle = 0; particle < count; particle++) {
    const turnOf = data.followed.indexOf(particle);
    pen.strokeStyle = turnOf < 0 ? stage.colours.muted : colour(turnOf);
    pen.beginPath();
    for (let sample = 0; sample < times.length; sample += stride)
      pen.lineTo(across(times[sample]), upward(sampled(sample, particle, 0)));
    pen.lineTo(across(end), upward(sampled(times.length - 1, particle, 0)));
    pen.lineWidth = 1.4;
    pen.globalAlpha = stage.paths === "none" ? 0 : stage.paths === "whole" ? 1 : 0.3;
    pen.stroke();
    if (stage.paths === "trail") {
      pen.save();
      pen.beginPath();
      pen.rect(0, 0, cut, stage.height);
      pen.clip();
      pen.globalAlpha = 1;
      pen.beginPath();
      for (let sample = 0; sample < times.length; sample += stride)
        pen.lineTo(across(times[sample]), upward(sampled(sample, particle, 0)));
      pen.lineTo(across(end), upward(sampled(times.length - 1, particle, 0)));
      pen.stroke();
      pen.restore();
    }
    pen.globalAlpha = 1;
    seen.x[particle] = cut;
    seen.y[particle] = upward(motion.points[3 * particle]);
  }
  pen.beginPath();
  pen.moveTo(cut, frame.top);
  pen.lineTo(cut, stage.height - frame.bottom);
  pen.strokeStyle = stage.colours.accent;
  pen.lineWidth = 1;
  pen.stroke();
  const pairs = (ends, style, width, keep) => strokeLines(ends, keep, style, width);
  pairs(motion.springs, stage.colours.strong, 2, () => true);
  pairs(motion.rods, stage.colours.ink, 3, (rod) => now.time < motion.lasts[rod]);
  drawMarks();
  drawNames();
};

const drawGrid = (across, upward, low, high) => {
  const step = round((high - low) / 4);
  for (let k = Math.ceil(low / step); k * step <= high; k++) {
    pen.strokeStyle = stage.colours.line;
    pen.lineWidth = 1;
    pen.beginPath();
    pen.moveTo(frame.left, upward(k * step));
    pen.lineTo(stage.width - frame.right, upward(k * step));
    pen.stroke();
    write(shown(k * step), frame.left - 8, upward(k * step) + 4, stage.colours.muted, "right");
  }
  write(`x [${data.units.length}]`, 14, 24, stage.colours.muted);
  const ticks = round((motion.end - motion.start) / 4 || 1);
  for (let k = Math.ceil(motion.start / ticks); k * ticks <= motion.end * (1 + 1e-12); k++) {
    const x = across(k * ticks);
    const align = x > stage.width - frame.right - 20 ? "right" : "center";
    write(shown(k * ticks), x, stage.height - frame.bottom + 18, stage.colours.muted, align);
  }
  write(`t [${data.units.time}]`, stage.width - frame.right, stage.height - 8, stage.colours.muted, "right");
};
