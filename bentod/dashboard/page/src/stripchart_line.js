// @ts-check
/** A horizontal line that is dragged, or moved with the arrow keys: a slider on the scale of its chart. */

import { el, say } from "./dom.js";
import { rounded } from "./stripchart_scale.js";
import { volts } from "./units.js";

export class ChartLine {
  /**
   * @param {{name: string, label: string, what: string, bounds: () => [number, number], commit: (volts: number) => void}} given
   *   `name`: of the class; `what`: for those who do not see it; `bounds`: V that may be set now
   */
  constructor({ name, label, what, bounds, commit }) {
    this.label = label;
    this.bounds = bounds;
    this.commit = commit;
    this.value = NaN;
    this.dragged = null;
    this.tag = el("span", { class: "stripchart-tag" });
    const attributes = { role: "slider", tabindex: 0, "aria-label": what, "aria-orientation": "vertical" };
    this.element = el("div", { class: `stripchart-line stripchart-${name}`, ...attributes }, el("span", { class: "stripchart-rule" }), this.tag);
    this.#wire();
  }

  /** Show what it is set to. `pending`: the daemon has not confirmed it; `fixed`: it may not be moved. */
  show(value, pending, fixed) {
    this.element.setAttribute("aria-disabled", String(fixed));
    this.element.tabIndex = fixed ? -1 : 0;
    this.fixed = fixed;
    this.element.classList.toggle("pending", pending);
    this.pending = pending;
    if (this.dragged === null) this.#set(value);
  }

  /** Put it where it belongs on `chart`. */
  place(chart) {
    this.chart = chart;
    if (!Number.isFinite(this.value)) return;
    const { left, width } = chart.area;
    const pixel = Math.min(Math.max(chart.toPixel(this.value), chart.area.top), chart.area.top + chart.area.height);
    const { style } = this.element;
    style.setProperty("left", `${left}px`);
    style.setProperty("width", `${width}px`);
    style.setProperty("top", `${pixel}px`);
  }

  #set(value) {
    const changed = value !== this.value;
    this.value = value;
    say(this.tag, `${this.label} ${volts(value)}${this.pending ? " …" : ""}`);
    if (!changed) return;
    const [low, high] = this.bounds();
    const told = { valuemin: low, valuemax: high, valuenow: value, valuetext: volts(value) };
    for (const [key, one] of Object.entries(told)) this.element.setAttribute(`aria-${key}`, String(one));
    if (this.chart) this.place(this.chart);
  }

  /** A value that may be set: within the bounds, to three digits unless that breaks one. */
  #allowed(value) {
    const [low, high] = this.bounds();
    const near = rounded(value);
    return near > low && near < high ? near : Math.min(Math.max(value, low), high);
  }

  #wire() {
    const on = (name, listener) => this.element.addEventListener(name, listener);
    on("pointerdown", (event) => this.#take(event));
    on("pointermove", (event) => this.#move(event));
    on("pointerup", () => this.#let(true));
    on("pointercancel", () => this.#let(false));
    on("lostpointercapture", () => this.#let(false));
    on("keydown", (event) => this.#pressed(event));
  }

  #take(event) {
    if (this.fixed || event.button !== 0 || !this.chart) return;
    event.preventDefault();
    this.element.focus({ preventScroll: true });
    this.element.setPointerCapture(event.pointerId);
    this.dragged = { was: this.value, grip: this.chart.toPixel(this.value) - event.clientY };
    this.element.classList.add("dragged");
  }

  #move(event) {
    if (this.dragged) this.#set(this.#allowed(this.chart.toVolts(event.clientY + this.dragged.grip)));
  }

  #let(meant) {
    if (!this.dragged) return;
    const { was } = this.dragged;
    const wanted = this.value;
    this.dragged = null;
    this.element.classList.remove("dragged");
    if (!meant) this.#set(was);
    else if (wanted !== was) this.commit(wanted);
  }

  /** Arrows by a hundredth of the chart, with Shift and by pages by a tenth. */
  #pressed(event) {
    if (event.key === "Escape") this.#let(false);
    const steps = { ArrowUp: 1, ArrowRight: 1, ArrowDown: -1, ArrowLeft: -1, PageUp: 10, PageDown: -10 }[event.key];
    if (!steps || this.fixed || this.dragged || !this.chart || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    const size = event.shiftKey && Math.abs(steps) === 1 ? 10 * steps : steps;
    const wanted = this.#allowed(this.value + (size * this.chart.range.high) / 100);
    if (wanted === this.value) return;
    this.#set(wanted);
    this.commit(wanted);
  }
}
