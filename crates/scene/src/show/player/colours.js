// Colours: of light on faces, and of a field from its least value to its largest.
const hex = (text) => [1, 3, 5].map((i) => parseInt(text.slice(i, i + 2), 16));
const rgb = (parts) => `rgb(${parts.map((part) => Math.max(0, Math.min(255, Math.round(part))))})`;

// How much light there is without the sun, and how much the sun adds, which stands to the upper left of
// the eye. A field is hardly shaded: its colours are to be read.
const SUN = [-0.4, 0.65, 0.65];
const [AMBIENT, SUNLIGHT] = data.field ? [0.93, 0.09] : [0.55, 0.5];

// The colours of a field: viridis.
const RAMP = ["#440154", "#3b528b", "#21918c", "#5ec962", "#fde725"].map(hex);
const along = (value) => {
  const { least, largest } = data.field;
  return Math.max(0, Math.min(1, (value - least) / (largest - least || 1)));
};
const shade = (value) => {
  const at = along(value) * (RAMP.length - 1);
  const low = Math.min(RAMP.length - 2, Math.floor(at));
  return RAMP[low].map((from, i) => from + (at - low) * (RAMP[low + 1][i] - from));
};

// What the colours mean, at the upper left: a bar with round numbers, the same through the whole run.
const BAR = { x: 18, y: 34, width: 210, height: 12 };
const drawScale = () => {
  const { title, unit, least, largest } = data.field;
  const { x, y, width, height } = BAR;
  const ramp = pen.createLinearGradient(x, 0, x + width, 0);
  RAMP.forEach((own, k) => ramp.addColorStop(k / (RAMP.length - 1), rgb(own)));
  pen.fillStyle = ramp;
  pen.fillRect(x, y, width, height);
  pen.strokeStyle = stage.colours.muted;
  pen.lineWidth = 1;
  pen.strokeRect(x - 0.5, y - 0.5, width + 1, height + 1);
  write(`${title} [${unit}]`, x, y - 9, stage.colours.ink);
  const step = round((largest - least) / 2 || 1);
  const ticks = [];
  for (let k = Math.ceil(least / step - 1e-9); k * step <= largest + 1e-9 * step; k++) ticks.push(k * step);
  // What differs by rounding alone has no round numbers between its ends.
  for (const value of largest - least < 1e-6 * Math.abs(largest) ? [0.5 * (least + largest)] : ticks) {
    const at = x + width * along(value);
    pen.strokeStyle = stage.colours.muted;
    pen.lineWidth = 1;
    pen.beginPath();
    pen.moveTo(at, y + height);
    pen.lineTo(at, y + height + 5);
    pen.stroke();
    write(shown(Number(value.toPrecision(12))), Math.max(x + 4, Math.min(x + width - 4, at)), y + height + 19, stage.colours.muted, "center");
  }
};
