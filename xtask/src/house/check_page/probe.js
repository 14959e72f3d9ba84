// What a reader could mind, as the browser has laid it out.
(() => {
  const texts = [];
  const close = (a, b) => a.left < b.right - 1 && b.left < a.right - 1 && a.top < b.bottom - 2 && b.top < a.bottom - 2;
  // Ascent and descent that no letter uses do not count as covered.
  const box = (text) => {
    const r = text.getBoundingClientRect();
    const inset = r.height * 0.15;
    return { left: r.left, right: r.right, top: r.top + inset, bottom: r.bottom - inset };
  };
  for (const chart of document.querySelectorAll("svg.chart")) {
    if (!chart.getClientRects().length) continue;
    const name = chart.closest("article")?.id ?? "chart";
    const scale = chart.getScreenCTM().a;
    const all = [...chart.querySelectorAll("text")].map((text) => ({ text: text.textContent, box: box(text) }));
    const window = chart.getBoundingClientRect();
    for (const piece of chart.querySelectorAll("text, tspan")) {
      const size = parseFloat(getComputedStyle(piece).fontSize) * scale;
      if (size < 10.95) texts.push(`${name}: "${piece.textContent}" is ${size.toFixed(1)} px`);
    }
    all.forEach((a, i) => {
      if (a.box.left < window.left - 1 || a.box.right > window.right + 1 || a.box.bottom > window.bottom + 1)
        texts.push(`${name}: "${a.text}" leaves its chart`);
      for (const b of all.slice(i + 1)) if (close(a.box, b.box)) texts.push(`${name}: "${a.text}" covers "${b.text}"`);
    });
  }
  const root = document.documentElement;
  const elements = document.querySelectorAll("*").length;
  return { width: root.scrollWidth, height: root.scrollHeight, elements, texts };
})()
