// @ts-check
/** Breaking a simulated arm on purpose, to practise what to do. */

import { practiceOf } from "./advice_practice.js";
import { button, el, field, say, section } from "./dom.js";
import { sentence, words } from "./units.js";

/** @returns {HTMLElement} */
export function practicePart(app) {
  return new Practice(app).element;
}

class Practice {
  /** What this page has broken and not mended, by label. */
  broken = new Map();

  constructor(app) {
    this.app = app;
    const options = (names, title) => names.map((name) => el("option", { value: name, text: title(name) }));
    const named = (name) => sentence(words(name));
    this.fault = el("select", { class: "practice-fault", on: { change: () => this.#told() } }, ...options(app.info.faults, named));
    const joints = app.info.joints.map((joint) => joint.name);
    this.joint = el("select", { class: "practice-joint" }, el("option", { value: "", text: "Every joint" }), ...options(joints, named));
    this.like = el("p", { class: "practice-like" });
    this.mends = el("div", { class: "row practice-mends" });
    this.breaks = button("Break it", () => this.#inject(this.fault.value, this.#chosen(), true), { class: "practice-break" });
    const row = el("div", { class: "row" }, field("Fault", this.fault), field("Of", this.joint), this.breaks);
    const hint = el("p", { class: "soft", text: "This arm is simulated: nobody gets hurt. Real arms refuse." });
    this.element = section("Practise", el("details", { class: "practice" }, el("summary", { text: "Break the simulated arm, and bring it back" }), hint, row, this.like, this.mends));
    app.onRole(() => (this.breaks.disabled = !app.can("inject")));
    this.#told();
  }

  #told() {
    const { whole, like, todo } = practiceOf(this.fault.value);
    this.joint.disabled = whole;
    say(this.like, `“Break it” does this: ${inner(like)} What then helps: ${inner(todo)}`);
  }

  #chosen() {
    return practiceOf(this.fault.value).whole ? "" : this.joint.value;
  }

  async #inject(fault, joint, on) {
    const answer = await this.app.act("inject", joint ? { fault, joint, on } : { fault, on });
    if (answer === undefined) return;
    const label = `${words(fault)}${joint ? ` of ${words(joint)}` : ""}`;
    if (on) this.broken.set(label, { fault, joint });
    else this.broken.delete(label);
    this.#list();
  }

  #list() {
    const mend = ([label, { fault, joint }]) => button(`Mend: ${label}`, () => this.#inject(fault, joint, false), { class: "practice-mend" });
    this.mends.replaceChildren(...[...this.broken].map(mend));
  }
}

/** A sentence that goes on after a colon. */
const inner = (text) => text.charAt(0).toLowerCase() + text.slice(1);

