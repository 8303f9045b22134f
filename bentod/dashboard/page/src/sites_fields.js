// @ts-check
/** What one site is set to, as numbers to be typed. */

import { el } from "./dom.js";
import { rounded, unitFor } from "./stripchart_scale.js";

/** By parameter of emg_set: label, and what it does. */
const FIELDS = {
  gain: ["Gain", "amplification"],
  threshold_v: ["Threshold", "effort is 0 up to here; for a toggle site, what counts as a toggle"],
  max_v: ["Maximum", "effort is 100 % from here on"],
  release: ["Release", "share of the threshold below which an effort ends"],
};

export class SiteFields {
  constructor(settings, name) {
    this.settings = settings;
    this.name = name;
    this.inputs = new Map(Object.keys(FIELDS).map((key) => [key, this.#field(key)]));
    this.element = el("div", { class: "sites-fields" }, ...[...this.inputs.values()].map(({ label }) => label));
  }

  /** Show what is set now, but where somebody types. */
  show(fixed) {
    for (const [key, { input, unit }] of this.inputs) {
      const scale = this.#scale(key);
      input.disabled = fixed;
      if (document.activeElement === input) continue;
      unit.textContent = scale.unit;
      const [low, high] = this.#bounds(key);
      input.min = String(rounded(low * scale.factor));
      input.max = String(rounded(high * scale.factor));
      input.value = String(Number((this.settings.values(this.name)[key] * scale.factor).toPrecision(6)));
    }
  }

  #field(key) {
    const [title, what] = FIELDS[key];
    const input = el("input", { type: "number", step: "any", inputmode: "decimal", "aria-label": `${title} of ${this.name}`, data: { key } });
    const unit = el("span", { class: "unit" });
    input.addEventListener("change", () => this.#typed(key, input));
    return { input, unit, label: el("label", { class: "field", title: what }, el("span", { text: title }), input, unit) };
  }

  /** The unit of volts is that which suits the site's maximum. */
  #scale(key) {
    if (key === "gain") return { factor: 1, unit: "×" };
    if (key === "release") return { factor: 100, unit: "%" };
    return unitFor(this.settings.values(this.name).max_v ?? 0);
  }

  /** What goes together with the other values. */
  #bounds(key) {
    const [low, high] = this.settings.bounds(key);
    const now = this.settings.values(this.name);
    if (key === "threshold_v") return [low, Math.min(high, now.max_v)];
    return key === "max_v" ? [Math.max(low, now.threshold_v), high] : [low, high];
  }

  #typed(key, input) {
    if (input.value === "" || !input.checkValidity()) {
      input.reportValidity();
      return;
    }
    this.settings.set(this.name, { [key]: Number((Number(input.value) / this.#scale(key).factor).toPrecision(6)) });
  }
}
