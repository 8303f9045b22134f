// @ts-check
/** Effort of one site as a bar with a mark at its threshold, and in numbers. */

import { el, say } from "./dom.js";
import { percent, volts } from "./units.js";

export class SiteGauge {
  constructor(title) {
    this.fill = el("span", { class: "sites-fill" });
    this.mark = el("span", { class: "sites-mark", title: "threshold" });
    this.word = el("span", { class: "sites-effort" });
    this.level = el("span", { class: "sites-level" });
    const meter = { role: "meter", "aria-label": `Effort of ${title}`, "aria-valuemin": 0, "aria-valuemax": 100, "aria-valuenow": 0 };
    this.bar = el("div", { class: "sites-bar", ...meter }, this.fill, this.mark);
    this.element = el("div", { class: "sites-gauge" }, this.word, this.bar, this.level);
  }

  /** @param {number} effort 0..1 @param {number} level V after gain, of which the bar shows the share of the maximum */
  show(effort, level, { threshold_v: threshold, max_v: maximum }) {
    const share = Math.min(Math.max(level / maximum, 0), 1) || 0;
    const shown = Math.round(100 * (effort ?? 0));
    this.fill.style.setProperty("width", `${Math.round(100 * share)}%`);
    this.mark.style.setProperty("left", `${Math.round((100 * threshold) / maximum)}%`);
    this.bar.setAttribute("aria-valuenow", String(shown));
    this.fill.classList.toggle("sites-above", effort > 0);
    say(this.word, `effort ${percent(effort ?? 0)}`);
    say(this.level, Number.isFinite(level) ? `level ${volts(level)}` : "level not known");
  }
}
