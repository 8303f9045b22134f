// @ts-check
/** What stands in every frame of a session: participant, session, and whatever else belongs there. */

import { button, el, section } from "./dom.js";

const USUAL = ["participant", "session"];

/** @returns {HTMLElement} */
export function metaPart(app) {
  return new MetaPart(app).element;
}

class MetaPart {
  known = ""; // what the daemon has, as it was last shown

  constructor(app) {
    this.app = app;
    this.rows = el("div", { class: "session-meta-rows" });
    this.more = button("Add a line", () => this.#add("", "").firstElementChild?.focus());
    this.set = el("button", { type: "submit", text: "Set" });
    this.hint = el("p", { class: "soft", text: "Stands in every frame, and so in the recording, from then on." });
    this.form = el("form", { class: "session-meta" }, this.rows, el("div", { class: "row" }, this.more, this.set), this.hint);
    this.form.addEventListener("submit", (event) => this.#submit(event));
    this.form.addEventListener("input", () => this.form.classList.add("session-dirty"));
    this.element = section("Notes", this.form);
    this.#fill({});
    app.onRole(() => this.#offer());
    app.onFrame((frame) => this.show(frame.meta), { element: this.element });
  }

  /** Take over what the daemon has, unless somebody is typing something else. */
  show(meta) {
    const told = JSON.stringify(meta ?? null);
    if (told === this.known || this.form.classList.contains("session-dirty")) return;
    this.known = told;
    this.#fill(meta);
  }

  #fill(meta) {
    this.rows.replaceChildren();
    const table = isTable(meta) ? meta : meta ? { note: meta } : {};
    for (const key of new Set([...USUAL, ...Object.keys(table)])) this.#add(key, table[key] ?? "");
    this.#offer();
  }

  #add(key, value) {
    const usual = USUAL.includes(key);
    const name = el("input", { type: "text", value: key, readonly: usual, maxlength: 64, "aria-label": "Name of the note" });
    const shown = typeof value === "string" ? value : JSON.stringify(value);
    const text = el("input", { type: "text", value: shown, maxlength: 1000, "aria-label": `Value of ${key || "the note"}` });
    const row = el("div", { class: "session-meta-row" }, name, text);
    this.rows.append(row);
    return row;
  }

  #table() {
    const rows = [...this.rows.children].map((row) => [...row.querySelectorAll("input")].map((input) => input.value.trim()));
    return Object.fromEntries(rows.filter(([key, value]) => key && value).map(([key, value]) => [key, meant(value)]));
  }

  async #submit(event) {
    event.preventDefault();
    const answer = await this.app.act("set_meta", { meta: this.#table() });
    if (answer === undefined) return;
    this.form.classList.remove("session-dirty");
    this.app.say("Set: it stands in every frame from now on.");
  }

  #offer() {
    const may = this.app.can("set_meta");
    for (const field of this.form.querySelectorAll("input, button")) field.disabled = !may;
  }
}

const isTable = (value) => typeof value === "object" && value !== null && !Array.isArray(value);

/** Text stays text, "007" too; what JSON would write in just this way is what JSON means. */
function meant(text) {
  try {
    const value = JSON.parse(text);
    return JSON.stringify(value) === text ? value : text;
  } catch {
    return text;
  }
}
