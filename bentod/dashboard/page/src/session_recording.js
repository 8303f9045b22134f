// @ts-check
/** The recording: its file, how long and how large it is, what is missing, and begin and end. */

import { button, el, say, section } from "./dom.js";
import { askTwice, repeatedly } from "./session_pace.js";
import { bytes, clockTime } from "./units.js";

/** ms between two questions how it goes. */
const EVERY = 2000;

/** @returns {HTMLElement} */
export function recordingPart(app) {
  return new Recording(app).element;
}

class Recording {
  told = null;
  at = 0; // frame time (s) when it was told

  constructor(app) {
    this.app = app;
    this.state = el("p", { class: "session-state", role: "status", text: "–" });
    this.problem = el("p", { class: "session-problem", role: "alert", hidden: true });
    this.facts = new Facts(["File", "Time", "Size", "Missing", "Note"]);
    this.note = el("input", { type: "text", maxlength: 200, placeholder: "what it is of", "aria-label": "Note for the next file" });
    this.start = button("Record", () => this.#begin(), { class: "session-start" });
    this.stop = askTwice("End recording", "End it: again", () => this.#change("recording_stop", {}));
    this.stop.classList.add("session-end");
    const row = el("div", { class: "row" }, this.note, this.start, this.stop);
    this.element = section("Recording", this.state, this.problem, this.facts.element, row);
    app.onRole(() => this.#offer());
    app.onFrame((frame) => this.#time(frame), { element: this.element });
    app.onEvent((event) => event.kind === "recording" && this.#ask());
    repeatedly(this.element, EVERY, () => this.#ask());
  }

  async #ask() {
    try {
      this.show(await this.app.call("get_recording"));
    } catch (error) {
      this.show({ recording: false, problem: "" }, error.message);
    }
  }

  async #change(method, params) {
    const told = await this.app.act(method, params);
    if (told) this.show(told);
    return told;
  }

  async #begin() {
    if (await this.#change("recording_start", { note: this.note.value })) this.note.value = "";
  }

  /** `why`: the answer was a refusal. */
  show(told, why = "") {
    this.told = told;
    this.at = this.app.frame?.time ?? 0;
    const ended = told.file ? "■ Nothing is recorded any more" : "■ Nothing is recorded";
    say(this.state, why ? `■ ${why}` : told.recording ? "● Recording" : ended);
    this.element.classList.toggle("session-records", told.recording === true);
    say(this.problem, told.problem ?? "");
    this.problem.hidden = !told.problem;
    this.#write(told);
    this.#offer();
  }

  #write(told) {
    const name = String(told.file ?? "").split("/").at(-1) ?? "";
    const lost = told.dropped ? `${told.dropped} entries` : told.file ? "nothing" : "";
    this.facts.write("File", name, told.file);
    this.facts.write("Size", told.file ? bytes(told.bytes ?? 0) : "");
    this.facts.write("Missing", lost);
    this.facts.write("Note", told.note ?? "");
    if (this.app.frame) this.#time(this.app.frame);
  }

  #time(frame) {
    if (!this.told) return;
    const since = this.told.recording ? frame.time - this.at : 0;
    this.facts.write("Time", this.told.file ? clockTime((this.told.duration_s ?? 0) + since) : "");
  }

  #offer() {
    const records = this.told?.recording === true;
    say(this.start, records ? "New file" : "Record");
    this.start.disabled = this.note.disabled = !this.app.can("recording_start");
    this.stop.disabled = !records || !this.app.can("recording_stop");
  }
}

/** Words and their values, one a line; a value that is empty hides its line. */
class Facts {
  constructor(names) {
    this.element = el("dl", { class: "session-facts" });
    this.rows = new Map(names.map((name) => [name, this.#row(name)]));
  }

  #row(name) {
    const value = el("dd", {});
    const row = el("div", { hidden: true }, el("dt", { text: name }), value);
    this.element.append(row);
    return { row, value };
  }

  write(name, text, title = "") {
    const { row, value } = this.rows.get(name);
    say(value, text);
    row.hidden = !text;
    if (title) value.title = title;
  }
}
