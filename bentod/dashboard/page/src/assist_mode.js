// @ts-check
/** Which assist helps: on or off in one place, and what it is made of. */

import { BESIDE, FOLLOW, modeOf, partsOf } from "./assist_words.js";
import { button, el, say } from "./dom.js";

const OFF = "off";

export class AssistMode {
  told = { mode: OFF, options: {} };

  /** `change`: asks the daemon for other settings. */
  constructor(app, group, change) {
    // The daemon forgets a mode's options when another is chosen, so they are kept here.
    this.kept = app.setting(`assist.${app.info?.arm}.${group}`, { last: "dpcc", options: {} });
    this.change = change;
    this.onOff = button("", () => this.#choose(this.told.mode === OFF ? this.kept.get().last : OFF), { class: "assist-switch", role: "switch" });
    const ways = [["", "Not at all"], ...Object.entries(FOLLOW)];
    this.follow = el("select", { class: "assist-follow", on: { change: () => this.#compose() } }, ...ways.map(([value, text]) => el("option", { value, text })));
    this.beside = Object.entries(BESIDE).map(([name, text]) => tick(name, text, () => this.#compose()));
    this.mode = el("p", { class: "soft" });
    this.element = el("fieldset", { class: "assist-mode" }, el("legend", { text: "How it helps" }), el("label", { class: "assist-field" }, el("span", { text: "Other joints move" }), this.follow), ...this.beside.map((one) => one.element), this.mode);
  }

  /** Take over what the daemon has. */
  show(told) {
    this.told = told;
    if (told.mode !== OFF) this.kept.set({ last: told.mode, options: { ...this.kept.get().options, [told.mode]: told.options ?? {} } });
    const on = told.mode !== OFF;
    say(this.onOff, on ? "Assist is on" : "Assist is off");
    this.onOff.setAttribute("aria-checked", String(on));
    const parts = partsOf(told.mode);
    this.follow.value = parts.follow;
    for (const { input } of this.beside) input.checked = parts.beside.includes(input.value);
    say(this.mode, on ? `Mode: ${told.mode}` : `Mode: off. On means ${this.kept.get().last}.`);
  }

  #compose() {
    const { others } = partsOf(this.told.mode);
    const beside = this.beside.map(({ input }) => input).filter((input) => input.checked);
    this.#choose(modeOf({ follow: this.follow.value, beside: beside.map((input) => input.value), others }));
  }

  async #choose(mode) {
    const options = this.kept.get().options[mode];
    await this.change(options && Object.keys(options).length ? { mode, options } : { mode });
  }
}

function tick(name, text, onChange) {
  const input = el("input", { type: "checkbox", value: name, on: { change: onChange } });
  return { input, element: el("label", { class: "assist-field assist-check" }, input, el("span", { text })) };
}
