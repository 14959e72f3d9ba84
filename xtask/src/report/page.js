(() => {
  const find = (selector) => [...document.querySelectorAll(selector)];
  const tip = document.getElementById("tip");

  // A chart that is alone has a second drawing for narrow windows.
  const narrow = matchMedia("(max-width:766px)");
  function fit() {
    for (const box of find(".chart-box:has(>template)")) {
      const drawn = box.querySelector(":scope>svg");
      if (drawn.classList.contains("narrow") === narrow.matches) continue;
      const { content } = box.querySelector("template");
      const other = content.firstElementChild;
      content.replaceChildren(drawn);
      box.prepend(other);
    }
  }
  narrow.addEventListener("change", fit);
  fit();

  // What the nearest point, or the cell or bar under the pointer, says.
  const reach = 28;
  const known = new WeakMap();
  let shown = null;
  function marks(chart) {
    if (!known.has(chart)) known.set(chart, [...chart.querySelectorAll("[data-says]")]);
    return known.get(chart);
  }
  function hide() {
    shown?.classList.remove("on");
    shown = null;
    tip.hidden = true;
  }
  function say(mark, x, y) {
    if (mark !== shown) {
      hide();
      shown = mark;
      mark.classList.add("on");
      tip.textContent = mark.dataset.says;
      tip.hidden = false;
    }
    const { width, height } = tip.getBoundingClientRect();
    const left = Math.min(Math.max(8, x - width / 2), document.documentElement.clientWidth - width - 8);
    const above = y - height - 16;
    tip.style.transform = `translate(${left}px, ${above > 8 ? above : y + 20}px)`;
  }
  function nearest(chart, event) {
    const matrix = chart.getScreenCTM();
    let best = null;
    let least = reach;
    for (const mark of marks(chart)) {
      if (!mark.classList.contains("pt")) continue;
      const { e, f } = mark.transform.baseVal[0].matrix;
      const x = matrix.a * e + matrix.e - event.clientX;
      const y = matrix.d * f + matrix.f - event.clientY;
      const distance = Math.hypot(x, y);
      if (distance < least) {
        least = distance;
        best = mark;
      }
    }
    return best ?? event.target.closest("[data-says]");
  }
  function point(event) {
    const chart = event.target.closest?.(".chart");
    const mark = chart && nearest(chart, event);
    if (mark) say(mark, event.clientX, event.clientY);
    else if (document.activeElement !== chart || event.type === "pointerdown") hide();
  }
  addEventListener("pointermove", point);
  addEventListener("pointerdown", point);

  // Arrow keys: along a curve or a row, and from one to the next.
  const centre = (mark) => {
    const { x, y, width, height } = mark.getBoundingClientRect();
    return { x: x + width / 2, y: y + height / 2 };
  };
  function along(all, mark, step) {
    const group = all.filter((other) => other.parentNode === mark.parentNode);
    return group[Math.min(Math.max(group.indexOf(mark) + step, 0), group.length - 1)];
  }
  function across(all, mark, step) {
    const groups = [...new Set(all.map((other) => other.parentNode))];
    const to = groups[groups.indexOf(mark.parentNode) + step];
    const from = centre(mark).x;
    const off = (other) => Math.abs(centre(other).x - from);
    const there = all.filter((other) => other.parentNode === to);
    return there.reduce((best, other) => (best && off(best) <= off(other) ? best : other), null) ?? mark;
  }
  const keys = {
    ArrowRight: (all, mark) => along(all, mark, 1),
    ArrowLeft: (all, mark) => along(all, mark, -1),
    ArrowDown: (all, mark) => across(all, mark, 1),
    ArrowUp: (all, mark) => across(all, mark, -1),
    Home: (all) => all[0],
    End: (all) => all.at(-1),
  };
  addEventListener("keydown", (event) => {
    if (event.key === "Escape") hide();
    const chart = event.target.closest?.(".chart");
    const all = chart && marks(chart);
    if (!all?.length || !(event.key in keys)) return;
    event.preventDefault();
    const mark = chart.contains(shown) ? keys[event.key](all, shown) : all[0];
    const { x, y } = centre(mark);
    say(mark, x, y);
  });
  addEventListener("focusout", hide);
  addEventListener("scroll", hide, { passive: true });

  // The filter hides what find still finds, and what a link leads to.
  const filter = document.getElementById("filter");
  const show = (element, is) => (is ? element.removeAttribute("hidden") : element.setAttribute("hidden", "until-found"));
  function choose() {
    const { crate, kind } = Object.fromEntries(new FormData(filter));
    const articles = find("article");
    const is = (article) => (!crate || article.dataset.crate === crate) && (!kind || article.dataset.kind === kind);
    for (const article of articles) {
      show(article, is(article));
      show(document.querySelector(`nav a[href="#${article.id}"]`).parentNode, is(article));
    }
    for (const section of find(".crate")) {
      const any = [...section.querySelectorAll("article")].some(is);
      show(section, any);
      const heading = document.querySelector(`nav a[href="#${section.id}"]`).parentNode;
      show(heading, any);
    }
    filter.querySelector("output").value = crate || kind ? `${articles.filter(is).length} of ${articles.length} studies` : "";
  }
  filter.addEventListener("change", choose);
  addEventListener("beforematch", (event) => event.target.querySelectorAll("[hidden]").forEach((inside) => show(inside, true)));

  // On a desk the contents are open; on a phone a bar, which closes behind a link.
  const contents = document.getElementById("contents");
  const desk = matchMedia("(min-width:1060px)");
  const unfold = () => (contents.open = desk.matches);
  desk.addEventListener("change", unfold);
  unfold();
  contents.addEventListener("click", (event) => event.target.closest("a") && unfold());

  // Which study is read.
  let current = null;
  const reading = new IntersectionObserver((seen) => {
    const first = seen.find((one) => one.isIntersecting);
    if (!first) return;
    current?.removeAttribute("aria-current");
    current = document.querySelector(`nav a[href="#${first.target.id}"]`);
    current.setAttribute("aria-current", "true");
    const side = document.querySelector("nav");
    if (desk.matches) side.scrollTop = current.offsetTop - side.clientHeight / 3;
  }, { rootMargin: "-20% 0px -70% 0px" });
  find("article").forEach((article) => reading.observe(article));
})();
