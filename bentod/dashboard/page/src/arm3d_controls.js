/** What stands below the arm: its legend, which is also where its colours come from, and how it is seen. */

import { button, el } from "./dom.js";

/** Signs, and what they stand for; a sign's colour is that of what it stands for. */
const LEGEND = {
  now: ["■", "now"],
  ghost: ["□", "expected (fainter: less sure)"],
  attended: ["◯", "attended to"],
};

/** The same where the arm is drawn as lines. */
const FLAT_LEGEND = {
  now: ["━ ●", "now"],
  ghost: ["┅ ○", "expected"],
  attended: ["▸", "attended to"],
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
    this.legend = this.#legend(LEGEND, (name, sign) => this.#sign(name, sign));
    this.flatLegend = this.#legend(FLAT_LEGEND, (name, sign) => signed(name, sign));
    this.bar = this.#bar();
    const legends = [this.legend, this.flatLegend];
    this.element = el("div", { class: "arm3d-controls" }, this.told, ...legends, this.bar, this.hint);
  }

  get wantsLines() {
    return this.lines.get();
  }

  get wantsLimits() {
    return this.limits.get();
  }

  /** Offer what works: `flat` while lines are shown, `solid` where anything else can be. */
  show(flat, solid) {
    this.legend.hidden = flat;
    this.flatLegend.hidden = !flat;
    for (const part of this.solidOnly) part.hidden = flat;
    this.bar.hidden = !solid;
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

  #legend(meanings, drawn) {
    const entries = Object.entries(meanings).map(([name, [sign, meaning]]) => {
      return el("li", {}, drawn(name, sign), ` ${meaning}`);
    });
    return el("ul", { class: "arm3d-legend" }, ...entries);
  }

  #bar() {
    this.solidOnly = [
      this.#check([this.#sign("range", "◔"), " Ranges"], this.limits, () => this.view.range()),
      button("Nearer", () => this.view.stage?.orbit.zoom(1 / 1.2)),
      button("Farther", () => this.view.stage?.orbit.zoom(1.2)),
      button("Reset view", () => this.view.stage?.orbit.home()),
    ];
    const lines = this.#check(["As lines"], this.lines, () => this.view.draw());
    return el("div", { class: "arm3d-bar-of-buttons" }, lines, ...this.solidOnly);
  }

  #sign(name, sign) {
    this.signs[name] = signed(name, sign);
    return this.signs[name];
  }

  #check(words, setting, changed) {
    const change = () => (setting.set(box.checked), changed());
    const box = el("input", { type: "checkbox", checked: setting.get(), on: { change } });
    return el("label", { class: "arm3d-check" }, box, ...words);
  }
}

function signed(name, sign) {
  return el("span", { class: `arm3d-sign-${name}`, text: sign, "aria-hidden": "true" });
}
