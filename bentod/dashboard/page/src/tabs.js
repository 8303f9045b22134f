// One part of the page at a time: the tabs pattern of WAI-ARIA, remembered from visit to visit.
import { el } from "./dom.js";

/** `parts`: [{id, label, elements}]; `chosen`: a setting. */
export function tabs(parts, chosen) {
  const list = el("div", { class: "tabs", role: "tablist", aria: { label: "Parts of the page" } });
  const pages = el("div", { class: "pages" });
  const all = parts.map(({ id, label, elements }) => {
    const tab = el("button", { type: "button", role: "tab", id: `tab-${id}`, "aria-controls": `page-${id}`, text: label });
    const page = el("div", { role: "tabpanel", id: `page-${id}`, "aria-labelledby": `tab-${id}`, tabindex: 0, class: "page" }, ...elements);
    tab.addEventListener("click", () => choose(id));
    list.append(tab);
    pages.append(page);
    return { id, tab, page };
  });

  function choose(id, focus = false) {
    const found = all.some((one) => one.id === id) ? id : all[0].id;
    for (const one of all) {
      const on = one.id === found;
      one.tab.setAttribute("aria-selected", String(on));
      one.tab.tabIndex = on ? 0 : -1;
      one.page.hidden = !on;
      if (on && focus) one.tab.focus();
    }
    chosen.set(found);
    dispatchEvent(new Event("resize")); // what was hidden had no size
  }

  list.addEventListener("keydown", (event) => {
    const now = all.findIndex((one) => one.tab === document.activeElement);
    const to = { ArrowRight: now + 1, ArrowLeft: now - 1, Home: 0, End: all.length - 1 }[event.key];
    if (now < 0 || to === undefined) return;
    event.preventDefault();
    choose(all[(to + all.length) % all.length].id, true);
  });
  choose(chosen.get());
  return { element: el("div", { class: "tabbed" }, list, pages), choose };
}
