// @ts-check
/** The trial that runs, and the next one. */

import { button, el, field, say, section } from "./dom.js";
import { clockTime } from "./units.js";

/** @returns {HTMLElement} */
export function trialPart(app) {
  return new TrialPart(app).element;
}

class TrialPart {
  trial = null;

  constructor(app) {
    this.app = app;
    this.kept = app.setting("trial", { name: "", condition: "" });
    const { name, condition } = this.kept.get();
    this.state = el("p", { class: "session-state", text: "– No trial runs" });
    this.time = el("p", { class: "session-time", hidden: true });
    this.name = el("input", { type: "text", maxlength: 64, value: name, required: true, placeholder: "circuit" });
    this.condition = el("input", { type: "text", maxlength: 64, value: condition, placeholder: "dpcc" });
    this.start = el("button", { type: "submit", text: "Start trial" });
    this.stop = button("Stop trial", () => app.act("trial_stop"), { class: "session-trial-stop" });
    this.form = el("form", { class: "row session-trial" }, field("Name", this.name), field("Condition", this.condition), this.start);
    this.form.addEventListener("submit", (event) => this.#submit(event));
    this.element = section("Trial", this.state, this.time, this.form, this.stop);
    app.onRole(() => this.#offer());
    app.onFrame((frame) => this.show(frame), { element: this.element });
  }

  #submit(event) {
    event.preventDefault();
    const params = { name: this.name.value.trim(), condition: this.condition.value.trim() };
    this.kept.set(params);
    this.app.act("trial_start", params);
  }

  show(frame) {
    const before = this.trial?.number;
    this.trial = frame.trial ?? null;
    say(this.state, this.trial ? `▶ ${title(this.trial)}` : "– No trial runs");
    this.time.hidden = !this.trial;
    if (this.trial) say(this.time, `running for ${clockTime(frame.time - this.trial.started)}`);
    if (before !== this.trial?.number) this.#offer();
  }

  #offer() {
    const may = this.app.can("trial_start");
    this.form.hidden = this.trial !== null;
    this.stop.hidden = this.trial === null;
    this.stop.disabled = !may;
    for (const field of [this.name, this.condition, this.start]) field.disabled = !may;
  }
}

function title({ number, name, condition }) {
  return `Trial ${number}: ${name}${condition ? `, ${condition}` : ""}`;
}
