/** What the arm does, what it expects, how sure it is, and how to stop it: in sentences, large. */

import { el, say } from "./dom.js";
import { sentences } from "./sentences.js";
import { around } from "./sentences_around.js";
import "./now.css";

/** ms between two changes of words while nothing important changes: nobody reads faster. */
const CALM = 250;

/** ms between two things said aloud. */
const BREATH = 2000;

/** @returns {HTMLElement} */
export function nowPanel(app) {
  const panel = new NowPanel(app);
  app.now = { sentences };
  app.onFrame(() => panel.show(), { element: panel.headline });
  app.onLink(() => panel.show());
  app.onRole(() => panel.show());
  return panel.element;
}

class NowPanel {
  shown = -Infinity;
  spoken = -Infinity;
  key = "";

  constructor(app) {
    this.app = app;
    this.headline = el("p", { class: "now-headline" });
    this.todo = el("p", { class: "now-todo" });
    this.doing = el("ul", { class: "now-doing" });
    this.expects = el("p", { class: "now-expects" });
    this.meter = new Meter();
    this.help = el("p", { class: "now-help" });
    this.stop = el("p", { class: "now-stop" });
    this.aloud = el("p", { class: "visually-hidden", "aria-live": "polite" });
    this.rows = [row("Next", this.expects), row("How sure", this.meter.element), row("Help", this.help)];
    const stop = row("To stop", this.stop);
    stop.classList.add("now-to-stop");
    const given = { class: "panel now", "aria-label": "What the arm is doing" };
    const first = el("div", { class: "now-first" }, this.headline, this.todo, this.doing);
    this.element = el("section", given, first, el("div", { class: "now-rest" }, ...this.rows, stop), this.aloud);
  }

  show() {
    const { frame } = this.app;
    const known = around(this.app);
    const told = sentences(frame, known);
    const holders = frame?.joints.map((joint) => joint.holder);
    const key = JSON.stringify([known, frame?.mode, frame?.fault, holders]);
    const now = performance.now();
    if (key === this.key && now - this.shown < CALM) return;
    this.shown = now;
    this.key = key;
    this.#write(told, known.lost ? "severed" : (frame?.mode ?? ""));
    if (now - this.spoken >= BREATH) this.#speak(known.lost || (told.todo ? `${told.headline} ${told.todo}` : ""), now);
  }

  #write(told, mode) {
    this.element.dataset.mode = mode;
    for (const row of this.rows) row.hidden = mode === "severed";
    say(this.headline, told.headline);
    write(this.todo, told.todo);
    list(this.doing, told.doing);
    write(this.expects, told.expects || "Nothing is expected.");
    this.meter.show(told.sure);
    write(this.help, told.help || "Nothing helps.");
    write(this.stop, told.stop);
  }

  /** Only states are said aloud by themselves; what moves is in the label of the picture. */
  #speak(state, now) {
    if (state !== this.aloud.textContent) this.spoken = now;
    write(this.aloud, state);
  }
}

const METER = {
  class: "now-meter",
  role: "meter",
  "aria-label": "How sure the arm is",
  "aria-valuemin": 0,
  "aria-valuemax": 100,
};

/** A share as a bar, a word and a number. */
class Meter {
  constructor() {
    this.fill = el("div", { class: "now-meter-fill" });
    this.bar = el("div", METER, this.fill);
    this.text = el("p", { class: "now-sure" });
    this.element = el("div", {}, this.bar, this.text);
  }

  show({ word, share, text }) {
    write(this.text, text);
    this.bar.hidden = share === null;
    if (share === null) return;
    const percent = Math.round(share * 100);
    this.fill.style.setProperty("--share", `${percent}%`);
    this.bar.setAttribute("aria-valuenow", String(percent));
    this.bar.setAttribute("aria-valuetext", `${word}, ${percent}%`);
  }
}

function row(title, content) {
  return el("div", { class: "now-row" }, el("h3", { class: "now-title", text: title }), content);
}

function list(node, lines) {
  while (node.children.length > lines.length) node.lastChild.remove();
  while (node.children.length < lines.length) node.append(el("li", {}));
  lines.forEach((line, index) => write(node.children[index], line));
  node.hidden = lines.length === 0;
}

function write(node, text) {
  say(node, text);
  if (node.tagName === "P") node.hidden = text === "";
}
