// @ts-check
/** What is wrong, since when, what to do about it, and the way back from a fault in three steps. */

import { complaints } from "./advice.js";
import { growth } from "./health_missed.js";
import { button, el, say, section } from "./dom.js";
import { clockTime, sentence, words } from "./units.js";

/** @returns {HTMLElement} */
export function faultsPart(app) {
  const part = new Faults(app);
  app.onTick((frame) => part.watch(frame));
  app.onFrame((frame) => part.show(frame), { element: part.element });
  app.onLink(({ daemon }) => part.linked(daemon));
  return part.element;
}

class Faults {
  /** When each complaint was first seen here, by what and text: monotonic s, and whether that was its beginning. */
  since = new Map();
  fresh = true; // no frame has been seen yet
  key = "";
  missed = growth();

  constructor(app) {
    this.app = app;
    this.state = el("p", { class: "health-state", role: "status" });
    this.list = el("ul", { class: "health-faults" });
    this.way = wayBack(app);
    this.element = section("What is wrong", this.state, this.list, this.way.element);
  }

  /** Also while out of sight: how long something lasts is only known to who saw it begin. */
  watch(frame) {
    this.missed.add(frame.missed ?? 0, frame.time);
    const found = complaints(frame, this.missed.recent);
    const keys = new Set(found.map(keyOf));
    for (const key of this.since.keys()) if (!keys.has(key)) this.since.delete(key);
    for (const key of keys) if (!this.since.has(key)) this.since.set(key, { time: frame.time, seen: !this.fresh });
    this.fresh = false;
    this.found = found;
  }

  /** Without the daemon, what was so last is not told as if it were so now. */
  linked(daemon) {
    this.list.hidden = this.way.element.hidden = !daemon;
    if (daemon) return;
    this.element.dataset.state = "unknown";
    say(this.state, "? Nothing is known: the daemon is not heard");
  }

  show(frame) {
    if (!this.app.linkState.daemon) return;
    const found = this.found ?? complaints(frame);
    const key = found.map(keyOf).join("\n");
    if (key !== this.key) this.#build(found);
    this.key = key;
    found.forEach((one, place) => this.#tell(this.list.children[place], one, frame));
    const grave = found.some((one) => one.grave);
    this.element.dataset.state = grave ? "bad" : found.length ? "warning" : "good";
    say(this.state, grave ? "⚠ Something is wrong" : found.length ? "△ Something is worth a look" : "✓ Nothing is wrong");
    this.way.show(frame);
  }

  #tell(item, one, frame) {
    say(item.querySelector(".health-since"), this.#since(one, frame));
    say(item.querySelector(".health-text"), one.text);
  }

  #build(found) {
    this.list.replaceChildren(...found.map(entry));
  }

  #since(one, frame) {
    const { time, seen } = this.since.get(keyOf(one)) ?? { time: frame.time, seen: true };
    const lasted = clockTime(frame.time - time);
    return seen ? `for ${lasted}` : `for ${lasted} at least: it was so when the page was opened`;
  }
}

const keyOf = ({ what, text }) => `${what}: ${steady(text)}`;

/** Numbers in a complaint may change while it is the same: "No sample for 0.07 s". */
const steady = (text) => text.replace(/\d+(\.\d+)?/g, "#");

function entry({ what, text, advice, grave }) {
  const steps = el("ol", { class: "health-advice", "aria-label": "What to do" }, ...advice.steps.map((step) => el("li", { text: step })));
  const head = el("h3", {}, `${sentence(words(what))}: ${advice.name.toLowerCase()} `, el("span", { class: "health-since soft" }));
  return el("li", { class: grave ? "health-fault grave" : "health-fault" }, head, el("p", { class: "health-text", text }), steps);
}

/** Clear, torque, release: each by itself, because each lets the arm do more. */
function wayBack(app) {
  const clear = button("1. Clear the fault", () => app.act("clear_fault"), { class: "health-clear" });
  const torque = button("2. Torque on", () => app.act("torque", { on: true }), { class: "health-torque" });
  const release = button("3. Release", () => app.act("pause", { on: false }), { class: "health-release" });
  const hint = el("p", { class: "soft", text: "Once released, the arm obeys again at once: keep clear of it." });
  const element = el("div", { class: "health-way" }, el("h3", { text: "The way back" }), el("div", { class: "row" }, clear, torque, release), hint);
  const show = (frame) => {
    const fault = frame.mode === "fault";
    const limp = frame.joints.some((joint) => !joint.torque);
    element.hidden = frame.mode === "active";
    clear.disabled = !fault || !app.can("clear_fault");
    torque.disabled = fault || !limp || !app.can("torque");
    release.disabled = fault || frame.joints.every((joint) => !joint.torque) || !app.can("pause");
  };
  return { element, show };
}
