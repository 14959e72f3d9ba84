// Small charts of the energy and the observables, with a mark at the time that is now.
const chartTimes = doubles(data.chartTimes);
const charts = [];

// The unit with its exponents raised.
const raised = (unit) => unit.replace(/\^2/g, "\u00b2").replace(/\^3/g, "\u00b3");

// What a chart plots: values, or where those hardly move, their changes. An axis is never less than
// `least` up and down: what is nothing but rounding does not fill it.
const prepare = ({ title, unit, least, whole, lines }) => {
  const changes = lines.map((line) => singles(line.changes));
  const moved = Math.max(...changes.map((values) => values.reduce((most, x) => Math.max(most, Math.abs(x)), 0)));
  const starts = lines.map((line) => line.start);
  const level = Math.max(...starts.map(Math.abs));
  const change = !whole && moved < 1e-4 * level;
  const values = changes.map((own, k) => (change ? own : Float64Array.from(own, (x) => x + starts[k])));
  const [low, high] = extent(values.map(extent).flat());
  const rounded = high - low < 2 * least;
  const middle = Math.abs(low + high) < 2 * least ? 0 : 0.5 * (low + high);
  const [bottom, top] = rounded ? [Math.min(low, middle - least), Math.max(high, middle + least)] : [low, high];
  const words = lines.map((line) => line.word);
  return { title, unit: raised(unit), least, moved, rounded, change, starts, values, words, low: bottom, high: top };
};

// What is said of a chart whose values move by no more than rounding.
const rounding = ({ moved }) =>
  moved ? `only rounding, ${shown(moved)}; axis at its least` : "constant";

const addChart = (declared) => {
  const chart = prepare(declared);
  const figure = document.createElement("figure");
  const caption = document.createElement("figcaption");
  const title = document.createElement("b");
  title.textContent = `${chart.change ? "change of " : ""}${chart.title}`;
  const unit = document.createElement("span");
  unit.className = "soft";
  unit.textContent = chart.unit ? ` [${chart.unit}]` : "";
  const values = document.createElement("div");
  values.className = "values";
  chart.outputs = chart.words.map((word, k) => {
    const output = document.createElement("span");
    output.style.color = `var(--s${k % COLOURS})`;
    values.append(output);
    return output;
  });
  const own = document.createElement("canvas");
  own.setAttribute("role", "img");
  const range = chart.rounded ? rounding(chart) : `from ${shown(chart.low)} to ${shown(chart.high)}`;
  own.setAttribute("aria-label", `${title.textContent} over time, ${range}`);
  if (chart.rounded) {
    const note = document.createElement("span");
    note.className = "soft";
    note.textContent = rounding(chart);
    values.append(note);
  }
  caption.append(title, unit, values);
  figure.append(caption, own);
  document.getElementById("charts").append(figure);
  const seek = (event) => {
    const box = own.getBoundingClientRect();
    const part = (event.clientX - box.left - 4) / (box.width - 8);
    go(motion.start + Math.max(0, Math.min(1, part)) * (motion.end - motion.start));
  };
  own.addEventListener("pointerdown", (event) => {
    own.setPointerCapture(event.pointerId);
    seek(event);
  });
  own.addEventListener("pointermove", (event) => event.buttons && seek(event));
  charts.push({ ...chart, own, pen: own.getContext("2d") });
};

const drawChart = (chart) => {
  const ratio = window.devicePixelRatio || 1;
  const box = chart.own.getBoundingClientRect();
  if (!box.width) return;
  const [wide, tall] = [Math.round(box.width * ratio), Math.round(box.height * ratio)];
  if (chart.own.width !== wide || chart.own.height !== tall) [chart.own.width, chart.own.height] = [wide, tall];
  const pen = chart.pen;
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, box.width, box.height);
  const [least, most] = chart.high > chart.low ? [chart.low, chart.high] : [chart.low - 1, chart.high + 1];
  const across = (t) => 4 + ((box.width - 8) * (t - motion.start)) / (motion.end - motion.start || 1);
  const upward = (x) => 16 + (box.height - 32) * (1 - (x - least) / (most - least || 1));
  pen.lineWidth = 1;
  pen.strokeStyle = stage.colours.line;
  for (const x of [least, most, ...(least < 0 && most > 0 ? [0] : [])]) {
    pen.beginPath();
    pen.moveTo(4, upward(x));
    pen.lineTo(box.width - 4, upward(x));
    pen.stroke();
  }
  pen.lineJoin = "round";
  pen.lineWidth = 1.3;
  chart.values.forEach((values, k) => {
    pen.strokeStyle = colour(k);
    pen.beginPath();
    values.forEach((x, i) => pen.lineTo(across(chartTimes[i]), upward(x)));
    pen.stroke();
  });
  pen.font = "12px system-ui, sans-serif";
  pen.fillStyle = stage.colours.muted;
  pen.fillText(shown(most), 5, 12);
  pen.fillText(shown(least), 5, box.height - 4);
  const x = across(now.time);
  pen.strokeStyle = stage.colours.accent;
  pen.beginPath();
  pen.moveTo(x, 14);
  pen.lineTo(x, box.height - 14);
  pen.stroke();
  const sample = before(chartTimes, now.time);
  chart.values.forEach((values, k) => {
    const next = Math.min(sample + 1, values.length - 1);
    const gap = chartTimes[next] - chartTimes[sample];
    const part = gap > 0 ? (now.time - chartTimes[sample]) / gap : 0;
    const value = (1 - part) * values[sample] + part * values[next];
    pen.fillStyle = colour(k);
    pen.beginPath();
    pen.arc(x, upward(value), 3, 0, 2 * Math.PI);
    pen.fill();
    const word = chart.words[k] ? `${chart.words[k]} ` : "";
    const start = chart.change ? `${shown(chart.starts[k])} ${value < 0 ? "\u2212" : "+"} ` : "";
    const nothing = !chart.change && !chart.rounded && Math.abs(value) < chart.least;
    chart.outputs[k].textContent = `${word}${start}${nothing ? 0 : shown(chart.change ? Math.abs(value) : value)}`;
  });
};

const drawCharts = () => charts.forEach(drawChart);
