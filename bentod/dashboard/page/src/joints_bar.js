/** A joint between its limits: ● where it is, ○ where it is expected. */

import { el } from "./dom.js";
import "./joints_bar.css";

export class JointBar {
  /** @param {[number, number] | undefined} range rad, lower and upper; without one nothing is shown */
  constructor(range) {
    this.range = range;
    this.expected = el("span", { class: "joints-bar-expected", text: "○" });
    this.now = el("span", { class: "joints-bar-now", text: "●" });
    const given = { class: "joints-bar", "aria-hidden": "true" }; // the same stands beside it in numbers
    this.element = el("div", given, this.expected, this.now);
  }

  /** @param {number} now rad @param {number | undefined} expected rad */
  show(now, expected) {
    this.#place(this.now, now);
    this.#place(this.expected, expected);
  }

  #place(mark, angle) {
    const [lower, upper] = this.range ?? [0, 0];
    mark.hidden = !(upper > lower && Number.isFinite(angle));
    if (mark.hidden) return;
    const share = Math.min(Math.max((angle - lower) / (upper - lower), 0), 1);
    mark.style.setProperty("--share", share.toFixed(4));
  }
}

/** The ranges (rad, [lower, upper]) of the joints by name, from what get_info told. */
export function rangesOf(info) {
  return Object.fromEntries((info?.joints ?? []).map((joint) => [joint.name, [joint.min_rad, joint.max_rad]]));
}
