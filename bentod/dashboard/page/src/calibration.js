// @ts-check
/** Calibration step by step: rest, a contraction of each site, what was found, and setting it. */

import { CalibrationResult } from "./calibration_result.js";
import { button, el, field, numberField, say } from "./dom.js";
import { seconds, volts, words } from "./units.js";
import "./calibration.css";

const TIMES = { ready: ["To get ready", 3, 0, 30], rest: ["Rest", 5, 1.5, 60], hold: ["Each contraction", 3, 1.5, 30] };
const ALL = "";

/** @returns {HTMLElement} */
export function calibrationPart(app, settings, charts) {
  return new CalibrationPart(app, settings, charts).element;
}

class CalibrationPart {
  constructor(app, settings, charts) {
    this.app = app;
    this.settings = settings;
    this.charts = charts;
    this.times = app.setting("muscles.calibration", {});
    this.run = 0;
    this.result = new CalibrationResult(app, settings);
    this.site = el("select", { id: "calibration-site" });
    this.start = button("Start", () => this.#start(), { class: "primary", id: "calibration-start" });
    this.cancel = button("Cancel", () => app.act("dashboard.calibrate_cancel"), { id: "calibration-cancel" });
    this.over = el("p", { class: "calibration-over", role: "status" });
    this.plan = el("div", { class: "calibration-plan" }, intro(), this.#fields(), this.over);
    this.asked = el("p", { class: "calibration-asked", role: "status" });
    this.left = el("p", { class: "calibration-left" });
    this.bar = el("progress", { max: 1, value: 0, "aria-label": "How much of this step is over" });
    this.bars = el("ul", { class: "calibration-levels" });
    this.doing = el("div", { class: "calibration-doing", hidden: true }, this.asked, this.left, this.bar, this.bars, this.cancel);
    this.element = el("details", { class: "calibration" }, el("summary", { text: "Calibrate: find threshold and maximum" }), this.plan, this.doing, this.result.element);
    settings.listeners.push(() => this.#offer());
    app.onRole(() => this.#offer());
    app.onFrame(() => this.show(app.told.calibration));
  }

  /** Take in how far the server is: the same for every browser. */
  show(told) {
    const asking = told?.phase === "asking";
    this.doing.hidden = !asking;
    this.plan.hidden = asking;
    if (!told) return;
    if (asking) this.#guide(told);
    const state = `${told.run} ${told.phase}`;
    if (state === this.state) return;
    this.state = state;
    if (asking) this.element.setAttribute("open", "");
    this.strongest = new Map();
    say(this.over, told.phase === "over" ? told.why : "");
    if (!asking) void this.result.load();
    else this.result.hide();
  }

  #guide(told) {
    const what = told.site ? `Contract ${words(told.site)} as strongly as is comfortable, and hold` : "Relax every muscle";
    say(this.asked, told.step === undefined ? "The muscles are paused …" : told.ready ? `Get ready. Next: ${what}` : `Now: ${what}!`);
    say(this.left, told.step === undefined ? "" : `${seconds(Math.ceil(told.left * 10) / 10)} · step ${told.step + 1} of ${told.of}`);
    this.bar.value = told.ready || !told.seconds ? 0 : 1 - told.left / told.seconds;
    this.doing.dataset.phase = told.ready ? "ready" : "now";
    this.cancel.disabled = !this.app.can("dashboard.calibrate_cancel");
    this.#levels(told);
  }

  /** How loud each site is now, against its loudest so far. */
  #levels(told) {
    const names = this.settings.sites.map(({ name }) => name);
    if (this.bars.children.length !== names.length) this.bars.replaceChildren(...names.map(levelRow));
    for (const [place, name] of names.entries()) {
      const level = this.charts.level(name);
      const most = Math.max(this.strongest?.get(name) ?? 0, level || 0, this.settings.values(name).max_v ?? 0);
      this.strongest?.set(name, most);
      const row = this.bars.children[place];
      row.classList.toggle("calibration-wanted", name === told.site);
      row.querySelector("span:last-child").textContent = volts(level);
      row.querySelector("meter").value = most ? (level || 0) / most : 0;
    }
  }

  #offer() {
    const may = this.app.can("dashboard.calibrate_start");
    const names = this.settings.sites.map(({ name }) => name);
    const kept = this.site.value;
    this.site.replaceChildren(el("option", { value: ALL, text: "all sites" }), ...names.map((name) => el("option", { value: name, text: words(name) })));
    this.site.value = names.includes(kept) ? kept : ALL;
    this.start.disabled = !may || !names.length;
  }

  #fields() {
    const fields = Object.entries(TIMES).map(([key, [label, usual, min, max]]) => {
      const keep = (value) => this.times.set({ ...this.times.get(), [key]: value });
      const made = numberField(label, "s", { value: this.times.get()[key] ?? usual, min, max, step: "any" }, keep);
      made.input.id = `calibration-${key}`;
      return made;
    });
    const which = field("Which", this.site);
    return el("div", { class: "row" }, which, ...fields, this.start);
  }

  #start() {
    const usual = Object.fromEntries(Object.entries(TIMES).map(([key, [, value]]) => [key, value]));
    const params = { ...usual, ...this.times.get(), sites: this.site.value ? [this.site.value] : [] };
    say(this.over, "");
    // The answer comes at the end; how it goes is told with every frame.
    this.app.call("dashboard.calibrate_start", params).catch((error) => say(this.over, error.message));
  }
}

function intro() {
  return el("p", {
    class: "soft",
    text: "Relax, then contract one muscle after the other as the page says. The muscles move nothing meanwhile and are then put back as they were; nothing is set before you have seen it.",
  });
}

function levelRow(name) {
  return el("li", {}, el("span", { text: words(name) }), el("meter", { min: 0, max: 1, value: 0, "aria-label": `Level of ${words(name)}` }), el("span"));
}
