/** What stands below the arm: its legend, which is also where its colours come from, and how it is seen. */

import { button, el } from "./dom.js";

/** Signs, and what they stand for; a sign's colour is that of what it stands for. */
const LEGEND = {
  now: ["■", "now"],
  ghost: ["□", "expected (fainter: less sure)"],
  attended: ["◯", "attended to"],
};

const HINT = "Drag, or arrow keys: turn the view. + and −: zoom. Home, or double click: as at first.";

export class ArmControls {
  constructor(app, view) {
    this.view = view;
    this.lines = app.setting("arm3d.lines", false);
    this.limits = app.setting("arm3d.limits", false);
    this.signs = {};
    this.told = el("p", { class: "arm3d-note", role: "status" });
    this.hint = el("p", { class: "visually-hidden", id: "arm3d-hint", text: HINT });
    this.element = el("div", { class: "arm3d-controls" }, this.told, this.#legend(), this.#bar(), this.hint);
  }

  get wantsLines() {
    return this.lines.get();
  }

  get wantsLimits() {
    return this.limits.get();
  }

  /** Say something about the drawing; empty: nothing to be said. */
  note(text) {
    this.told.textContent = text;
  }

  /** The colours of the theme, as rgb(…), by what they are for. */
  colours() {
    const named = Object.entries(this.signs).map(([name, sign]) => [name, getComputedStyle(sign).color]);
    return { ...Object.fromEntries(named), grid: getComputedStyle(this.view.canvas).color };
  }

  /** Paint anew when the page or the system changes between light and dark. */
  watchTheme() {
    addEventListener("themechange", () => this.view.paint());
  }

  #legend() {
    const entries = Object.entries(LEGEND).map(([name, [sign, meaning]]) => {
      return el("li", {}, this.#sign(name, sign), ` ${meaning}`);
    });
    return el("ul", { class: "arm3d-legend" }, ...entries);
  }

  #bar() {
    return el(
      "div",
      { class: "arm3d-bar-of-buttons" },
      this.#check([this.#sign("range", "◔"), " Ranges"], this.limits, () => this.view.range()),
      this.#check(["As lines"], this.lines, () => this.view.draw()),
      button("Nearer", () => this.view.stage?.orbit.zoom(1 / 1.2)),
      button("Farther", () => this.view.stage?.orbit.zoom(1.2)),
      button("Reset view", () => this.view.stage?.orbit.home()),
    );
  }

  #sign(name, sign) {
    this.signs[name] = el("span", { class: `arm3d-sign-${name}`, text: sign, "aria-hidden": "true" });
    return this.signs[name];
  }

  #check(words, setting, changed) {
    const change = () => (setting.set(box.checked), changed());
    const box = el("input", { type: "checkbox", checked: setting.get(), on: { change } });
    return el("label", { class: "arm3d-check" }, box, ...words);
  }
}
