// @ts-check
/** The settings of an assist: a slider and a number each, in the units of the screen, within the daemon's bounds. */

import { el } from "./dom.js";

const DEGREES = 180 / Math.PI;
const STEPS = 1000; // of a slider

/** `per`: what one unit of the daemon's is on the screen; `log`: the slider's ends lie decades apart; `about`: what it is. */
const DIALS = [
  { name: "k", label: "How briskly help goes there", unit: "", per: 1, log: true, about: "k, the share of the way to the expected angle that help goes in one tick" },
  { name: "velocity_limit_rad_s", label: "Top speed of help", unit: "°/s", per: DEGREES, log: true, about: "Help moves no joint faster; each joint's own top speed holds besides" },
  { name: "manual_after_toggle_s", label: "Without help after a toggle", unit: "s", per: 1, log: false, about: "After the operator has chosen another joint, nothing helps for so long" },
];

/** `change`: asks the daemon for other settings. */
export function settingsPart(app, change) {
  const table = app.methodTable.find((method) => method.name === "assist_set");
  const boundsOf = (name) => table?.parameters.find((one) => one.name === name) ?? {};
  const fastest = Math.max(...app.info.joints.map((joint) => joint.max_velocity_rad_s));
  const enough = { velocity_limit_rad_s: 2 * fastest }; // where a slider ends: beyond it nothing changes
  const dials = DIALS.map((given) => new Dial({ ...given, enough: enough[given.name] }, boundsOf(given.name), (value) => change({ [given.name]: value })));
  const timescale = new Timescale((value) => change({ timescale: value }));
  const by = new Choice("How another timescale is found", boundsOf("timescale_by").choices ?? [], (value) => change({ timescale_by: value }));
  const element = el("fieldset", { class: "assist-settings" }, el("legend", { text: "Settings" }), timescale.element, ...dials.map((dial) => dial.element), by.element);
  const show = (told, frame) => {
    for (const dial of dials) dial.show(told[dial.name]);
    timescale.show(told.timescale, frame);
    by.show(told.timescale_by);
  };
  return { element, show };
}

class Dial {
  /** `bounds`: the daemon's description of the parameter; `change` gets a number in its unit. */
  constructor({ name, label, unit, per, log, about, enough = Infinity }, bounds, change) {
    Object.assign(this, { name, per, log, unit });
    this.low = (bounds.minimum ?? 0) * per;
    this.high = (bounds.maximum ?? 1) * per;
    this.top = Math.min(this.high, enough * per);
    const within = `from ${short(this.low)} to ${short(this.high)}${unit && ` ${unit}`}`;
    this.slider = el("input", { type: "range", min: 0, max: STEPS, class: `assist-${name}-slider`, "aria-label": `${label}, ${within}` });
    // No min, max and step: rounded for the screen, they would refuse values that the daemon takes.
    this.number = el("input", { type: "number", step: "any", class: `assist-${name}`, "aria-label": `${label}, ${unit || "a share"}`, title: within });
    this.editing = false; // what somebody is typing is not overwritten
    this.slider.addEventListener("input", () => this.#dragged());
    this.number.addEventListener("input", () => (this.editing = true));
    this.number.addEventListener("blur", () => (this.editing = false));
    this.slider.addEventListener("change", () => this.#done(change));
    this.number.addEventListener("change", () => this.#typed(change, within));
    const head = el("span", { class: "assist-dial-name", text: label, title: about });
    this.element = el("div", { class: "assist-dial" }, head, this.slider, this.number, el("span", { class: "unit", text: unit }));
  }

  /** `value` in the daemon's unit. */
  show(value) {
    if (typeof value !== "number" || this.editing) return;
    this.#put(value * this.per);
  }

  #put(shown) {
    this.number.value = short(shown);
    this.slider.value = String(Math.round(STEPS * this.#place(shown)));
    this.slider.setAttribute("aria-valuetext", `${short(shown)} ${this.unit}`.trim());
  }

  #dragged() {
    this.editing = true;
    const shown = this.#at(Number(this.slider.value) / STEPS);
    this.number.value = short(shown);
    this.slider.setAttribute("aria-valuetext", `${short(shown)} ${this.unit}`.trim());
  }

  #typed(change, within) {
    const value = Number(this.number.value);
    const wrong = this.number.value === "" || value < this.low || value > this.high;
    this.number.setCustomValidity(wrong ? `It must be ${within}.` : "");
    if (this.number.reportValidity()) this.#done(change);
  }

  #done(change) {
    this.editing = false;
    change(this.#meant());
  }

  /** What the field says, in the daemon's unit and within its bounds whatever was rounded. */
  #meant() {
    const shown = Math.min(Math.max(Number(this.number.value), this.low), this.high);
    return shown / this.per;
  }

  #place(shown) {
    const value = Math.min(Math.max(shown, this.low), this.top);
    return this.log ? Math.log(value / this.low) / Math.log(this.top / this.low) : (value - this.low) / (this.top - this.low);
  }

  #at(place) {
    return this.log ? this.low * (this.top / this.low) ** place : this.low + place * (this.top - this.low);
  }
}

/** Three significant figures. */
const short = (value) => String(Number(value.toPrecision(3)));

class Choice {
  constructor(label, values, change, textOf = String) {
    this.textOf = textOf;
    this.select = el("select", { "aria-label": label, on: { change: () => change(this.select.value) } });
    this.element = el("label", { class: "assist-field" }, el("span", { text: label }), this.select);
    this.offer(values);
  }

  offer(values) {
    const now = [...this.select.options].map((option) => option.value);
    if (now.join() === values.join()) return;
    this.select.replaceChildren(...values.map((value) => el("option", { value, text: this.textOf(value) })));
  }

  show(value) {
    this.select.value = String(value ?? "");
  }
}

/** Only what is predicted can be followed. */
class Timescale {
  constructor(change) {
    this.rate = 30;
    const text = (ticks) => `${ticks} ticks (${short(Number(ticks) / this.rate)} s)`;
    this.choice = new Choice("How far ahead it looks", [], (value) => change(Number(value)), text);
    this.choice.select.classList.add("assist-timescale");
    this.element = this.choice.element;
  }

  show(value, frame) {
    if (frame) this.rate = frame.rate_hz;
    const known = new Set((frame?.joints ?? []).flatMap((joint) => Object.keys(joint.predictions)));
    if (value !== undefined) known.add(String(value));
    this.choice.offer([...known].sort((one, other) => Number(one) - Number(other)));
    this.choice.show(value);
  }
}
