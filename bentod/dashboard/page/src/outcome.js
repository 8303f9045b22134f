// @ts-check
/** Predictions against what came: one signal, and what was predicted of it, drawn when it was about. */

import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import { el, field, say } from "./dom.js";
import { Outcome } from "./outcome_series.js";
import { readerOf, scaleOf, signalWords, ticksOf } from "./outcome_signals.js";
import { atMost } from "./sparing.js";
import { number, sentence, words } from "./units.js";
import "./outcome.css";

const SPAN = 20; // s before now
const OFTEN = 100; // ms between two drawings
const HEIGHT = 260; // px
const BRIDGED = 4; // slots

/** @typedef {{name: string, label: string, ticks: number, scale: any, value: Function, prediction: Function, range?: number[]}} Subject `range`: of the chart, on the screen */

/** Where a joint will be, as the frames tell it: in rad already. `specs`: get_info's joints. @returns {Subject} */
export function jointSubject(joint, timescale, specs = []) {
  const name = `${joint}.position@${timescale}`;
  const of = (frame) => frame.joints.find((one) => one.name === joint);
  return {
    name,
    label: `${words(joint)}, position`,
    ticks: Number(timescale),
    scale: scaleOf(`${joint}.position`),
    range: rangeOf(specs.find((one) => one.name === joint)),
    value: (frame) => (of(frame)?.freshness === "fresh" ? of(frame).position : NaN),
    prediction: (frame) => (isOld(frame, name) ? NaN : of(frame)?.predictions[timescale] ?? NaN),
  };
}

/** The limits of a joint in degrees, and a little more: a chart that keeps its scale is calmer. */
function rangeOf(spec) {
  if (!spec) return undefined;
  const [low, high] = [spec.min_rad, spec.max_rad].map((rad) => (rad * 180) / Math.PI);
  return [low - 0.1 * (high - low), high + 0.1 * (high - low)];
}

/** Of another question, as gvf_list describes it; null when frames do not show what it is about. @returns {Subject | null} */
export function gvfSubject(gvf, frame, specs = []) {
  const ticks = ticksOf(gvf);
  const value = gvf.scaled ? readerOf(gvf.cumulant, frame) : null;
  if (!value || !Number.isFinite(ticks)) return null;
  const [joint, timescale] = gvf.name.split(".position@");
  if (frame.joints.some((one) => one.name === joint && timescale in one.predictions)) return jointSubject(joint, timescale, specs);
  const prediction = (told) => (isOld(told, gvf.name) ? NaN : told.learn.predictions?.[gvf.name] ?? NaN);
  return { name: gvf.name, label: signalWords(gvf.cumulant), ticks, scale: scaleOf(gvf.cumulant), value, prediction };
}

/** A prediction that was not made in this tick has been drawn already. */
const isOld = (frame, name) => name in (frame.learn.older ?? {});

/** The chart, and the choice of what it draws. */
export class OutcomeChart {
  /** @type {Subject | null} */ subject = null;
  /** @type {Outcome | null} */ series = null;
  /** @type {uPlot | null} */ plot = null;
  rate = 30;

  constructor(app) {
    this.app = app;
    this.joint = el("select", { class: "outcome-joint", on: { change: () => this.#chosen() } });
    this.timescale = el("select", { class: "outcome-timescale", on: { change: () => this.#chosen() } });
    const band = "The band: ± the RMSE of late against the return, a weighted mean of what came";
    this.words = el("p", { class: "outcome-words", title: band });
    this.errors = el("p", { class: "outcome-now" });
    this.chart = el("div", { class: "outcome-chart", role: "img" });
    const row = el("div", { class: "row" }, field("Joint", this.joint), field("Ahead", this.timescale));
    this.element = el("div", { class: "outcome" }, el("h3", { text: "Predicted, and what came" }), row, this.words, this.chart, this.errors);
    app.onTick((frame) => this.take(frame));
    app.onFrame(atMost(OFTEN, () => this.draw()), { element: this.element });
    addEventListener("resize", () => this.#fit());
    addEventListener("themechange", () => this.#forget());
  }

  /** Draw this from now on. */
  show(subject) {
    this.subject = subject;
    this.series = new Outcome(subject.ticks, Math.round(SPAN * this.rate));
    const [joint, timescale] = subject.name.split(".position@");
    this.joint.value = joint;
    this.timescale.value = timescale ?? "";
    this.#explain();
    this.#forget();
    if (this.app.frame) this.take(this.app.frame);
  }

  /** Also while out of sight, so that there is something to see at once. */
  take(frame) {
    this.rate = frame.rate_hz;
    this.#offer(frame);
    if (!this.subject || !this.series) return;
    const slot = Math.round(frame.time * frame.rate_hz); // deadlines are a tick apart, missed ones too
    if (!Number.isFinite(slot)) return;
    const error = frame.learn.error[this.subject.name] ?? NaN;
    this.error = error;
    this.series.add(slot, this.subject.value(frame), this.subject.prediction(frame), error);
  }

  /** What is drawn, on the screen's scale: slots from now, signal, prediction, band. */
  columns() {
    if (!this.series || !this.subject) return [];
    const { per } = this.subject.scale;
    const [slots, ...rest] = this.series.columns();
    return [slots.map((slot) => slot / this.rate), ...rest.map((column) => column.map((value) => (value === null ? null : value * per)))];
  }

  draw() {
    if (!this.series || !this.chart.clientWidth) return;
    const data = this.columns();
    if (this.plot) this.plot.setData(data);
    else this.plot = new uPlot(options(this.subject, this.chart.clientWidth), data, this.chart);
    say(this.errors, this.#inNumbers(data));
  }

  #inNumbers(data) {
    const { unit, digits, per } = this.subject.scale;
    const value = (column, place) => number(data[column][place] ?? NaN, digits, unit);
    const now = data[0].findIndex((seconds) => seconds >= 0);
    const last = data[0].length - 1;
    const off = Number.isFinite(this.error) ? `, give or take ${number(this.error * per, digits, unit)}` : "";
    return `Now ${value(1, now)}; it was predicted as ${value(2, now)}. Predicted next: ${value(2, last)}${off}.`;
  }

  #explain() {
    const { label, ticks } = this.subject;
    const ahead = `${number(ticks / this.rate, 2, "s")} (${number(ticks, 0, "ticks")})`;
    const text = `${sentence(label)}: the solid line is what it did, the dashed one what had been predicted ${ahead} earlier, the band how wrong that was of late. Right of now is still to come.`;
    say(this.words, text);
    this.chart.setAttribute("aria-label", text);
  }

  #offer(frame) {
    const joints = frame.joints.filter((joint) => Object.keys(joint.predictions).length);
    const names = joints.map((joint) => joint.name);
    const timescales = [...new Set(joints.flatMap((joint) => Object.keys(joint.predictions)))].sort((one, other) => Number(one) - Number(other));
    const changed = fill(this.joint, names, (name) => sentence(words(name)));
    const seconds = (ticks) => `${number(Number(ticks) / frame.rate_hz, 2, "s")} (${ticks} ticks)`;
    if (!fill(this.timescale, timescales, seconds) && !changed) return;
    if (!this.subject && names.length) {
      const active = frame.groups.map((group) => group.active).find((name) => names.includes(name));
      this.show(jointSubject(active ?? names[0], timescales[timescales.length - 1], this.app.info?.joints));
    }
  }

  #chosen() {
    const { value } = this.timescale;
    this.show(jointSubject(this.joint.value, value || this.timescale.options[0].value, this.app.info?.joints));
  }

  #fit() {
    if (this.plot && this.chart.clientWidth) this.plot.setSize({ width: this.chart.clientWidth, height: HEIGHT });
  }

  /** Colours are those of the moment in which a chart is made. */
  #forget() {
    this.plot?.destroy();
    this.plot = null;
  }
}

/** Whether the options have changed. */
function fill(select, values, textOf) {
  const known = [...select.options].map((option) => option.value);
  if (known.join() === values.join()) return false;
  const before = select.value;
  select.replaceChildren(...values.map((value) => el("option", { value, text: textOf(value) })));
  if (values.includes(before)) select.value = before;
  return true;
}

function options(subject, width) {
  const style = getComputedStyle(document.documentElement);
  const colour = (name) => style.getPropertyValue(`--${name}`).trim();
  const axis = { stroke: colour("text"), font: "18px system-ui, sans-serif", grid: { stroke: colour("line"), width: 1 }, ticks: { stroke: colour("line") } };
  const text = ({ unit, digits }) => (_, values) => values.map((value) => `${Number(value.toFixed(Math.max(digits, 2)))}${unit === "°" ? "°" : ` ${unit}`}`.replace("-", "−"));
  return {
    width,
    height: HEIGHT,
    legend: { show: false },
    cursor: { show: false },
    scales: { x: { time: false, range: (_, low, high) => [low, high] }, ...(subject.range ? { y: { range: subject.range } } : {}) },
    axes: [{ ...axis, size: 34, space: 90, values: (_, values) => values.map((value) => (value === 0 ? "now" : `${value} s`.replace("-", "−"))) }, { ...axis, size: 84, values: text(subject.scale) }],
    series: [
      {},
      { stroke: colour("now"), width: 3, gaps: longGaps },
      { stroke: colour("expected"), width: 3, dash: [8, 5], gaps: longGaps },
      { width: 0, gaps: longGaps },
      { width: 0, gaps: longGaps },
    ],
    bands: [{ series: [4, 3], fill: `${colour("expected")}40` }],
    hooks: { draw: [(plot) => nowLine(plot, colour("soft"))] },
  };
}

/** Frames that a page leaves out now and then are no gaps: lines break only where more than BRIDGED are missing. */
function longGaps(plot, series, first, last, gaps) {
  const [one, two] = plot.data[0];
  const slot = plot.valToPos(two, "x", true) - plot.valToPos(one, "x", true);
  return gaps.filter(([from, to]) => to - from > (BRIDGED + 1.5) * slot);
}

function nowLine(plot, colour) {
  const { ctx, bbox } = plot;
  const x = plot.valToPos(0, "x", true);
  ctx.save();
  ctx.strokeStyle = colour;
  ctx.lineWidth = 2;
  ctx.beginPath();
  ctx.moveTo(x, bbox.top);
  ctx.lineTo(x, bbox.top + bbox.height);
  ctx.stroke();
  ctx.restore();
}
