// @ts-check
/** The keys of a player, where the page shows a recording and not an arm. */

import { button, el, field, say, section } from "./dom.js";
import { repeatedly } from "./session_pace.js";
import { clockTime } from "./units.js";
import "./replay.css";

/** ms between two questions where it is. */
const EVERY = 250;

const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 5, 10, 100];

const WARNING = "This is a replay. No arm moves, and nothing on this page can move one.";

/** @returns {HTMLElement} */
export function replayPanel(app) {
  return new Player(app).element;
}

class Player {
  told = { position_s: 0, duration_s: 0, speed: 1, paused: false, loop: false };
  dragging = false;
  seeking = false;
  sought = null; // the newest place that was asked for while another was on its way

  constructor(app) {
    this.app = app;
    this.play = button("Pause", () => this.#change("replay_pause", { on: !this.told.paused }), { class: "replay-play" });
    this.place = el("input", { type: "range", min: 0, max: 0, step: 0.1, value: 0, class: "replay-place", "aria-label": "Place in the recording" });
    this.time = el("p", { class: "replay-time", text: "–" });
    this.speed = el("select", { class: "replay-speed", on: { change: () => this.#change("replay_speed", { speed: Number(this.speed.value) }) } });
    this.loop = el("input", { type: "checkbox", on: { change: () => this.#change("replay_loop", { on: this.loop.checked }) } });
    const row = el("div", { class: "row" }, this.play, field("Speed", this.speed), field("Begin again at the end", this.loop));
    const warning = el("p", { class: "replay-warning", role: "note", text: WARNING });
    this.element = section("Replay", warning, this.place, this.time, row);
    this.place.addEventListener("input", () => this.#drag());
    this.place.addEventListener("change", () => (this.dragging = false));
    app.onRole(() => this.#offer());
    repeatedly(this.element, EVERY, () => this.#ask());
  }

  async #ask() {
    try {
      this.show(await this.app.call("replay_get"));
    } catch {
      say(this.time, "The replay has ended, or its server is gone.");
    }
  }

  async #change(method, params) {
    await this.app.act(method, params);
    await this.#ask();
  }

  show(told) {
    this.told = told;
    say(this.play, told.paused ? "Play" : "Pause");
    this.place.max = String(told.duration_s);
    if (!this.dragging) this.place.value = String(told.position_s);
    this.#speeds(told.speed);
    this.loop.checked = told.loop;
    this.#tell(this.dragging ? Number(this.place.value) : told.position_s);
  }

  #tell(position) {
    const where = `${clockTime(position)} of ${clockTime(this.told.duration_s)}`;
    say(this.time, `${where}${this.told.paused ? ", stands still" : ""}`);
    this.place.setAttribute("aria-valuetext", where);
  }

  /** A speed that was set elsewhere is offered, too; none: as fast as it goes. */
  #speeds(now) {
    const known = SPEEDS.includes(now) ? SPEEDS : [...SPEEDS, now ?? Infinity].sort((one, other) => one - other);
    const wanted = known.map(String).join();
    if (this.speed.dataset.known !== wanted) {
      this.speed.replaceChildren(...known.map((speed) => el("option", { value: speed, text: timesReal(speed), disabled: speed === Infinity })));
      this.speed.dataset.known = wanted;
    }
    if (document.activeElement !== this.speed) this.speed.value = String(now ?? Infinity);
  }

  #drag() {
    this.dragging = true;
    this.sought = Math.min(Number(this.place.value), this.told.duration_s);
    this.#tell(this.sought);
    if (!this.seeking) this.#seek();
  }

  /** One place after the other, never those that were dragged past meanwhile. */
  async #seek() {
    this.seeking = true;
    while (this.sought !== null) {
      const position_s = this.sought;
      this.sought = null;
      await this.app.act("replay_seek", { position_s });
    }
    this.seeking = false;
  }

  #offer() {
    const may = this.app.can("replay_seek");
    for (const control of [this.play, this.place, this.speed, this.loop]) control.disabled = !may;
  }
}

function timesReal(speed) {
  return speed === Infinity ? "as fast as it goes" : `${speed} ×`;
}
