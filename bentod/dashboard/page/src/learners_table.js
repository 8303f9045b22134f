// @ts-check
/** All questions in a table of which only the rows in sight exist: thousands cost no more than some. */

import { el, field, say } from "./dom.js";
import { COLUMNS, arranged, numbersOf, questionWords, textsOf } from "./learners_rows.js";
import { gvfSubject } from "./outcome.js";
import { sideways } from "./sideways.js";
import { atMost } from "./sparing.js";
import "./learners.css";

const ROW = 62; // px, as in learners.css
const SPARE = 4; // rows beyond the edges of what is in sight
const OFTEN = 400; // ms between two changes of numbers: nobody reads faster
const RESORT = 2000; // ms between two changes of the order

export class GvfTable {
  gvfs = [];
  rows = [];
  order = { text: "", key: "", up: true };

  /** `draw(gvf)`: somebody wants to see it drawn. */
  constructor(app, draw) {
    this.app = app;
    this.draw = draw;
    this.filter = el("input", { type: "search", class: "learners-filter", on: { input: () => this.#arrange() } });
    this.count = el("span", { class: "soft", role: "status" });
    this.heads = COLUMNS.map((column) => this.#head(column));
    this.body = el("tbody", {});
    this.table = el("table", { class: "learners-table" }, el("thead", {}, el("tr", {}, ...this.heads)), this.body);
    this.above = el("tr", { class: "learners-space", "aria-hidden": "true" }, el("td", { colspan: COLUMNS.length }));
    this.below = this.above.cloneNode(true);
    this.window = el("div", { class: "learners-window scroll", tabindex: 0, role: "group", "aria-label": "All questions" }, this.table);
    sideways(this.window);
    this.window.addEventListener("scroll", () => this.show());
    const find = field("Find", this.filter);
    const hint = el("p", { class: "soft", text: "Sure: how far a prediction can be trusted. Off by: how wrong it was of late, in the unit of the signal. Unusual: how its newest errors compare with its usual ones; 1 is usual." });
    this.element = el("div", { class: "learners" }, el("h3", { text: "All questions" }), el("div", { class: "row" }, find, this.count), this.window, hint);
    const sort = atMost(RESORT, () => this.order.key && this.order.key !== "name" && this.#arrange());
    app.onFrame(atMost(OFTEN, () => (sort(), this.show())), { element: this.element });
  }

  /** What gvf_list answers. */
  take(gvfs) {
    this.gvfs = gvfs;
    this.#arrange();
  }

  /** Bring the rows in sight up to date. */
  show() {
    const frame = this.app.frame;
    if (!frame) return;
    const height = this.window.clientHeight || 10 * ROW;
    const first = Math.max(0, Math.min(Math.floor(this.window.scrollTop / ROW) - SPARE, this.shown.length - 1));
    const some = this.shown.slice(first, first + Math.ceil(height / ROW) + 2 * SPARE);
    this.#makeRows(some.length);
    some.forEach((gvf, place) => this.rows[place].show(gvf, frame, first + place));
    this.#space(this.above, first);
    this.#space(this.below, this.shown.length - first - some.length);
  }

  shown = [];

  #arrange() {
    const frame = this.app.frame;
    if (!frame) return;
    this.order.text = this.filter.value;
    this.shown = arranged(this.gvfs, (gvf) => numbersOf(gvf, frame), this.order);
    const all = this.gvfs.length;
    say(this.count, this.shown.length === all ? `${all} questions` : `${this.shown.length} of ${all} questions`);
    this.table.setAttribute("aria-rowcount", String(this.shown.length + 1));
    this.show();
  }

  #makeRows(count) {
    if (this.rows.length === count && this.body.children.length === count + 2) return;
    while (this.rows.length > count) this.rows.pop();
    while (this.rows.length < count) this.rows.push(new Row(this.draw));
    this.body.replaceChildren(this.above, ...this.rows.map((row) => row.element), this.below);
  }

  #space(row, count) {
    row.style.setProperty("height", `${count * ROW}px`);
    row.hidden = count === 0;
  }

  #head({ key, title, term }) {
    const press = el("button", { type: "button", class: "plain learners-sort", text: title, title: term, on: { click: () => this.#sort(key) } });
    return el("th", { scope: "col", "aria-sort": "none", data: { key } }, press);
  }

  /** Names begin with A, numbers with the greatest; a second press turns it round. */
  #sort(key) {
    const up = this.order.key === key ? !this.order.up : key === "name";
    this.order = { ...this.order, key, up };
    for (const head of this.heads) head.setAttribute("aria-sort", head.dataset.key === key ? (up ? "ascending" : "descending") : "none");
    this.#arrange();
  }
}

class Row {
  gvf = null;

  constructor(draw) {
    this.button = el("button", { type: "button", class: "plain learners-name", on: { click: () => this.gvf && draw(this.gvf) } });
    this.question = el("span", { class: "learners-question soft" });
    this.fill = el("i", { class: "learners-sure-fill" });
    this.confidence = el("span", {});
    this.cells = Object.fromEntries(["prediction", "error", "surprise"].map((key) => [key, el("td", { class: "number" })]));
    const bar = el("i", { class: "learners-sure-bar", "aria-hidden": "true" }, this.fill);
    const { prediction, error, surprise } = this.cells;
    this.element = el("tr", { class: "learners-row" }, el("th", { scope: "row" }, this.button, this.question), prediction, el("td", {}, el("div", { class: "learners-sure" }, bar, this.confidence)), error, surprise);
  }

  show(gvf, frame, place) {
    if (gvf !== this.gvf) this.#about(gvf, frame);
    const numbers = numbersOf(gvf, frame);
    const texts = textsOf(gvf, numbers);
    for (const [key, cell] of Object.entries(this.cells)) say(cell, texts[key]);
    say(this.confidence, texts.confidence);
    this.fill.style.setProperty("--share", `${100 * Math.min(Math.max(numbers.confidence || 0, 0), 1)}%`);
    this.element.setAttribute("aria-rowindex", String(place + 2));
    this.element.classList.toggle("learners-striped", place % 2 === 1);
  }

  #about(gvf, frame) {
    this.gvf = gvf;
    say(this.button, gvf.name);
    const drawable = gvfSubject(gvf, frame) !== null;
    this.button.disabled = !drawable;
    this.button.title = drawable ? "Draw it against what came" : "Frames do not show what it is about, so it cannot be drawn";
    say(this.question, questionWords(gvf, frame.rate_hz));
    this.question.title = this.question.textContent;
  }
}
