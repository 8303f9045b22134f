/** What the arm does, what it expects, how sure it is, and how to stop it: in sentences, large. */

import { el, say } from "./dom.js";
import { sentences } from "./sentences.js";
import "./now.css";

/** ms between two changes of words while nothing important changes: nobody reads faster. */
const CALM = 250;

/** ms between two things said aloud. */
const BREATH = 2000;

/** @returns {HTMLElement} */
export function nowPanel(app) {
  const panel = new NowPanel();
  app.now = { sentences };
  app.onFrame((frame) => panel.show(frame), { element: panel.element });
  app.onLink((link) => panel.link(link));
  panel.show(app.frame);
  return panel.element;
}

class NowPanel {
  shown = -Infinity;
  spoken = -Infinity;
  key = "";
  severed = "";
  frame = null;

  constructor() {
    this.headline = el("p", { class: "now-headline" });
    this.todo = el("p", { class: "now-todo" });
    this.doing = el("ul", { class: "now-doing" });
    this.expects = el("p", { class: "now-expects" });
    this.meter = new Meter();
    this.help = el("p", { class: "now-help" });
    this.stop = el("p", { class: "now-stop" });
    this.aloud = el("p", { class: "visually-hidden", "aria-live": "polite" });
    const rows = [
      row("Next", this.expects),
      row("How sure", this.meter.element),
      row("Help", this.help),
      row("To stop", this.stop),
    ];
    const given = { class: "panel now", "aria-label": "What the arm is doing" };
    this.element = el("section", given, this.headline, this.todo, this.doing, ...rows, this.aloud);
  }

  /** @param {{page: boolean, daemon: boolean, why: string}} link */
  link({ page, daemon, why }) {
    const lost = page ? "The page has no connection to the daemon" : "The page has lost its server";
    this.severed = page && daemon ? "" : `${lost}: what stands here is old. ${why ?? ""}`.trim();
    this.show(this.frame);
  }

  show(frame) {
    this.frame = frame;
    const told = sentences(frame);
    const key = `${this.severed}|${frame?.mode}|${frame?.fault}|${frame?.joints.map((joint) => joint.holder)}`;
    const now = performance.now();
    if (key === this.key && now - this.shown < CALM) return;
    this.shown = now;
    this.key = key;
    this.#write(told, frame?.mode ?? "");
    if (now - this.spoken >= BREATH) this.#speak(told, now);
  }

  #write(told, mode) {
    this.element.dataset.mode = this.severed ? "severed" : mode;
    write(this.headline, this.severed || told.headline);
    write(this.todo, this.severed ? "" : told.todo);
    list(this.doing, this.severed ? [] : told.doing);
    write(this.expects, told.expects || "Nothing is expected.");
    this.meter.show(told.sure);
    write(this.help, told.help || "Nothing helps.");
    write(this.stop, told.stop);
  }

  /** Only states are said aloud by themselves; what moves is in the label of the picture. */
  #speak({ headline, todo }, now) {
    const state = this.severed || (todo ? `${headline} ${todo}` : "");
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
