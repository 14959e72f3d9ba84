// Shows what the nearest point, or the cell or bar under the pointer, says.
(() => {
  const tip = document.getElementById("tip");
  const reach = 28;
  const said = new Map();
  let shown = null;
  // The browser's own hint would double ours, so its text moves here.
  for (const title of document.querySelectorAll(".chart title")) {
    said.set(title.parentNode, title.textContent);
    title.remove();
  }
  const points = new Map();
  for (const chart of document.querySelectorAll(".chart")) {
    points.set(chart, [...chart.querySelectorAll(".pt")]);
    chart.addEventListener("pointermove", (event) => show(chart, event));
    chart.addEventListener("pointerdown", (event) => show(chart, event));
    chart.addEventListener("pointerleave", (event) => event.pointerType === "mouse" && hide());
  }
  function hide() {
    shown?.classList.remove("on");
    shown = null;
    tip.hidden = true;
  }
  function nearest(chart, event) {
    const matrix = chart.getScreenCTM();
    let best = null;
    let least = reach;
    for (const point of points.get(chart)) {
      const { e, f } = point.transform.baseVal[0].matrix;
      const x = matrix.a * e + matrix.e - event.clientX;
      const y = matrix.d * f + matrix.f - event.clientY;
      const distance = Math.hypot(x, y);
      if (distance < least) {
        least = distance;
        best = point;
      }
    }
    return best ?? event.target.closest(".cell, .bar");
  }
  function show(chart, event) {
    const mark = nearest(chart, event);
    if (!said.has(mark)) return hide();
    if (mark !== shown) {
      hide();
      shown = mark;
      mark.classList.add("on");
      tip.textContent = said.get(mark);
      tip.hidden = false;
    }
    const { width, height } = tip.getBoundingClientRect();
    const left = Math.min(Math.max(8, event.clientX - width / 2), document.documentElement.clientWidth - width - 8);
    const above = event.clientY - height - 16;
    const top = above > 8 ? above : event.clientY + 20;
    tip.style.transform = `translate(${left}px, ${top}px)`;
  }
  addEventListener("scroll", hide, { passive: true });
  addEventListener("keydown", (event) => event.key === "Escape" && hide());
  addEventListener("pointerdown", (event) => event.target.closest(".chart") || hide());
})();
