// @ts-check
/** What a calibration found, before and after, and how it is set, undone and kept. */

import { copied } from "./clipboard.js";
import { button, el, say } from "./dom.js";
import { sideways } from "./sideways.js";
import { volts, words } from "./units.js";

export class CalibrationResult {
  constructor(app, settings) {
    this.app = app;
    this.settings = settings;
    this.rows = el("tbody");
    this.remarks = el("ul", { class: "calibration-remarks" });
    this.use = button("Set these values", () => this.#use(), { class: "primary", id: "calibration-use" });
    this.undo = button("Back to what it was", () => this.#undo(), { id: "calibration-undo" });
    this.close = button("Close", () => this.hide(), { id: "calibration-close" });
    this.lines = el("pre", { class: "calibration-lines", tabindex: 0, "aria-label": "Lines for the config file" });
    this.keep = el("div", { class: "calibration-keep" }, keepWords(), this.lines, button("Copy the lines", () => this.#copy()));
    this.done = el("p", { class: "calibration-done", role: "status" });
    const table = sideways(el("div", { class: "scroll" }, el("table", {}, head(), this.rows)));
    this.element = el("div", { class: "calibration-result", hidden: true }, el("h3", { text: "What was found" }), table, this.remarks, el("div", { class: "row" }, this.use, this.undo, this.close), this.done, this.keep);
  }

  hide() {
    this.element.hidden = true;
  }

  /** Show what the server has. */
  async load() {
    const told = await this.app.act("dashboard.calibrate_get");
    if (told?.results.length) this.#show(told);
    else this.hide();
  }

  #show(told) {
    this.told = told;
    const { results } = told;
    this.rows.replaceChildren(...results.map((one) => row(one, told.set.includes(one.site))));
    this.remarks.replaceChildren(...results.flatMap((one) => one.remarks.map((text) => el("li", { text: `⚠ ${text}` }))));
    const good = results.filter((one) => one.separable);
    this.use.disabled = !good.length || told.set.length > 0 || !this.app.can("dashboard.calibrate_use");
    this.undo.disabled = !told.set.length || !this.app.can("emg_set");
    say(this.done, told.set.length ? `✓ Set: ${told.set.map(words).join(", ")}.` : "Nothing is set yet.");
    say(this.lines, good.map((one) => `[[emg.sites]]\n${one.lines}`).join("\n\n"));
    this.keep.hidden = !told.set.length;
    this.element.hidden = false;
  }

  async #use() {
    const told = await this.app.act("dashboard.calibrate_use");
    if (told) this.#show(told);
    void this.settings.refresh();
  }

  async #undo() {
    for (const { site, before } of this.told.results) {
      if (before && this.told.set.includes(site)) await this.app.act("emg_set", { site, ...before });
    }
    await this.settings.refresh();
    this.#show({ ...this.told, set: [] });
    say(this.done, "It is set as it was before.");
  }

  async #copy() {
    const done = await copied(this.lines.textContent);
    this.app.say(done ? "The lines are copied." : "The browser does not let the page copy: select the lines.", done ? "info" : "warning");
  }
}

function head() {
  const titles = ["Site", "Rest", "Contraction", "Threshold", "Maximum", "May be set"];
  return el("thead", {}, el("tr", {}, ...titles.map((text) => el("th", { scope: "col", text }))));
}

function row({ site, rest_v: rest, scatter_v: scatter, contraction_v: held, before, after, separable }, set) {
  const change = (key) => `${before ? volts(before[key]) : "–"} → ${volts(after[key])}`;
  const told = [`${volts(rest)} ± ${volts(scatter)}`, volts(held), change("threshold_v"), change("max_v"), set ? "✓ set" : separable ? "✓ yes" : "✖ no: too near rest"];
  return el("tr", {}, el("th", { scope: "row", text: words(site) }), ...told.map((text) => el("td", { text })));
}

function keepWords() {
  const text = "The daemon never changes its config. To keep this, put these values into the tables of these sites, or run ";
  return el("p", {}, text, el("code", { text: "bentod ctl emg-save FILE" }), ".");
}
