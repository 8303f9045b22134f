// @ts-check
/** What happened, newest first. */

import { button, el, say, section } from "./dom.js";
import { copied } from "./clipboard.js";

/** That are kept. */
const MOST = 500;

const ALL = "everything";

/** @returns {HTMLElement} */
export function eventsPart(app) {
  const list = new EventList(app);
  app.onEvent((event) => list.take(event));
  return list.element;
}

class EventList {
  events = []; // newest first
  kinds = new Set();

  constructor(app) {
    this.app = app;
    this.filter = el("select", { "aria-label": "Kind of events", on: { change: () => this.#redraw() } }, option(ALL));
    const copy = button("Copy", () => this.#copy(), { class: "events-copy" });
    this.count = el("span", { class: "soft", text: "nothing yet" });
    this.list = el("ol", { class: "events-list", tabindex: 0, "aria-label": "Events, newest first" });
    this.element = section("Events", el("div", { class: "row" }, this.filter, copy, this.count), this.list);
  }

  take(event) {
    const entry = { kind: event.kind, text: event.text, wall: this.#wall(event) };
    this.events.unshift(entry);
    this.events.length = Math.min(this.events.length, MOST);
    this.#know(event.kind);
    if (this.#shows(entry)) this.list.prepend(line(entry));
    while (this.list.children.length > MOST) this.list.lastElementChild?.remove();
    this.#tell();
  }

  /** s since the epoch: events carry the arm's own time, and frames both. */
  #wall(event) {
    const { frame } = this.app;
    return frame ? frame.wall + (event.time - frame.time) : Date.now() / 1000;
  }

  #know(kind) {
    if (this.kinds.has(kind)) return;
    this.kinds.add(kind);
    this.filter.append(option(kind));
  }

  #shows(entry) {
    return this.filter.value === ALL || this.filter.value === entry.kind;
  }

  #shown() {
    return this.events.filter((entry) => this.#shows(entry));
  }

  #redraw() {
    this.list.replaceChildren(...this.#shown().map(line));
    this.#tell();
  }

  #tell() {
    const many = this.list.children.length;
    say(this.count, `${many} ${many === 1 ? "event" : "events"}${this.events.length === MOST ? `, the newest of more than ${MOST}` : ""}`);
  }

  async #copy() {
    const shown = this.#shown();
    const text = shown.map(({ wall, kind, text }) => `${new Date(wall * 1000).toISOString()}\t${kind}\t${text}`);
    const done = await copied(`${text.join("\n")}\n`);
    this.app.say(done ? `Copied ${shown.length} events.` : "The browser does not let this page copy.", done ? "info" : "warning");
  }
}

function line({ wall, kind, text }) {
  const when = new Date(wall * 1000);
  const clock = when.toLocaleTimeString([], { hour12: false });
  const time = el("time", { datetime: when.toISOString(), text: clock });
  return el("li", { data: { kind } }, time, el("span", { class: "events-kind", text: kind }), el("span", { class: "events-text", text }));
}

function option(text) {
  return el("option", { value: text, text });
}
