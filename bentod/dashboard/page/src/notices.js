// Short sentences at the bottom of the page: what was refused, and why.
import { button, el } from "./dom.js";

const LASTING = { info: 4000, warning: 8000, error: 12000 }; // ms
const MOST = 4;

export function notices() {
  const element = el("div", { class: "notices", role: "log", aria: { live: "polite", label: "Notices" } });
  return {
    element,
    say(text, kind = "info") {
      const last = element.lastElementChild;
      if (last?.dataset.text === text) last.remove();
      const notice = el("div", { class: `notice ${kind}`, data: { text } }, el("span", { text }));
      notice.append(button("×", () => notice.remove(), { class: "plain", "aria-label": "Dismiss" }));
      element.append(notice);
      while (element.children.length > MOST) element.firstElementChild.remove();
      setTimeout(() => notice.remove(), LASTING[kind]);
    },
  };
}
