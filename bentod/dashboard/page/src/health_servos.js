// @ts-check
/** The bus and what hangs on it: how long a round takes, and how each servo is. */

import { el, say, section } from "./dom.js";
import { factList } from "./health_timing.js";
import { sideways } from "./sideways.js";
import { atMost } from "./sparing.js";
import { number, percent, seconds, sentence, words } from "./units.js";

const COOL = 20; // °C, where the bar of a temperature begins
const BOILING = 80; // °C, where it ends
const MOST_VOLTS = 16; // where the bar of a voltage ends: above what any of the servos takes
const COLUMNS = ["Joint", "Answers, age", "Temperature", "Supply", "Load", "Errors"];
const MARKS = { fresh: "✓ fresh", stale: "△ stale", lost: "✕ lost" };

/** @returns {HTMLElement} */
export function servosPart(app) {
  const facts = factList(["A round on the bus", "Oldest reading"]);
  const head = el("tr", {}, ...COLUMNS.map((title) => el("th", { scope: "col", text: title })));
  const body = el("tbody", {});
  const table = sideways(el("div", { class: "scroll", tabindex: 0, role: "group", "aria-label": "Servos" }, el("table", { class: "health-servos" }, el("thead", {}, head), body)));
  const element = section("Servos", facts.element, table);
  let rows = new Map();
  const show = (frame) => {
    const names = frame.joints.map((joint) => joint.name);
    if (names.join() !== [...rows.keys()].join()) {
      rows = new Map(names.map((name) => [name, new Row(name, app.info?.joints?.find((one) => one.name === name))]));
      body.replaceChildren(...[...rows.values()].map((row) => row.element));
    }
    facts.show([seconds(frame.costs.read), age(Math.max(...frame.joints.map((joint) => joint.age)))]);
    for (const joint of frame.joints) rows.get(joint.name).show(joint);
  };
  app.onFrame(atMost(250, show), { element });
  return element;
}

const age = (value) => (value < 1 ? number(value * 1000, 1, "ms") : Number.isFinite(value) ? seconds(value) : "never read");

class Row {
  constructor(name, spec) {
    this.warm = spec?.warm_c ?? Infinity;
    this.hot = spec?.hot_c ?? Infinity;
    this.answers = el("td", {});
    this.temperature = new Bar(share(this.warm), share(this.hot));
    this.voltage = new Bar();
    this.load = el("td", { class: "number" });
    this.errors = el("td", {});
    const title = el("th", { scope: "row", text: sentence(words(name)) });
    const cells = [this.answers, el("td", {}, this.temperature.element), el("td", {}, this.voltage.element), this.load, this.errors];
    this.element = el("tr", {}, title, ...cells);
  }

  show(joint) {
    say(this.answers, `${MARKS[joint.freshness] ?? joint.freshness}, ${age(joint.age)}`);
    this.answers.dataset.freshness = joint.freshness;
    this.temperature.show(share(joint.temperature), `${number(joint.temperature, 0, "°C")}${this.#heat(joint.temperature)}`);
    this.voltage.show(joint.voltage / MOST_VOLTS, number(joint.voltage, 1, "V"));
    say(this.load, percent(joint.load));
    say(this.errors, joint.errors.join(", ") || "none");
  }

  #heat(temperature) {
    if (temperature >= this.hot) return ", hot";
    return temperature >= this.warm ? ", warm" : "";
  }
}

const share = (temperature) => (temperature - COOL) / (BOILING - COOL);

/** A number as a bar, with marks where it matters. */
class Bar {
  constructor(...marks) {
    this.fill = el("i", { class: "health-bar-fill" });
    const shown = marks.filter((mark) => mark <= 1).map((mark) => placed(el("i", { class: "health-bar-mark" }), mark));
    this.text = el("span", {});
    this.element = el("div", { class: "health-bar" }, el("div", { class: "health-bar-track", "aria-hidden": "true" }, this.fill, ...shown), this.text);
  }

  show(part, text) {
    placed(this.fill, part);
    say(this.text, text);
  }
}

function placed(element, part) {
  element.style.setProperty("--share", `${100 * Math.min(Math.max(part || 0, 0), 1)}%`);
  return element;
}
