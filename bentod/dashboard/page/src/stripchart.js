// @ts-check
/** One channel as it comes: the signal thin, its level thick, and lines that can be dragged, all on one scale (uPlot). */

import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import { el } from "./dom.js";
import { voltAxis } from "./stripchart_scale.js";
import "./stripchart.css";

const HEIGHT = 190;
const FONT = '18px system-ui, "Noto Sans", "DejaVu Sans", sans-serif';

export class StripChart {
  /** @param {string} label what the picture shows, for those who do not see it */
  constructor(label) {
    this.bins = null;
    this.range = { low: -1, high: 1 }; // V after gain
    this.lines = [];
    this.inView = true;
    this.drawn = el("div", { class: "stripchart-canvas", role: "img", "aria-label": label });
    this.overlay = el("div", { class: "stripchart-overlay" });
    this.element = Object.assign(el("div", { class: "stripchart" }, this.drawn, this.overlay), { chart: this });
    this.#follow();
  }

  /** Where uPlot's plotting area is, in CSS pixels of the element. */
  get area() {
    const { left, top, width, height } = this.plot?.bbox ?? { left: 0, top: 0, width: 1, height: 1 };
    const ratio = devicePixelRatio || 1;
    return { left: left / ratio, top: top / ratio, width: width / ratio, height: height / ratio };
  }

  addLine(line) {
    this.lines.push(line);
    this.overlay.append(line.element);
  }

  /** How many bins fit: one for each pixel. */
  get pixels() {
    return Math.max(Math.round(this.area.width), 50);
  }

  /** Draw `bins` of `span` s between two voltages. */
  draw(bins, span, range) {
    this.bins = bins;
    this.range = range;
    this.span = span;
    if (!this.plot) this.#build();
    if (!this.plot) return;
    this.plot.setData([bins.times, bins.high, bins.level], false);
    this.plot.batch(() => {
      this.plot.setScale("x", { min: -span, max: 0 });
      this.plot.setScale("y", { min: range.low, max: range.high });
    });
    for (const line of this.lines) line.place(this);
  }

  /** CSS pixels from the top of the element to V, and back. */
  toPixel(volts) {
    const { top, height } = this.area;
    return top + ((this.range.high - volts) / (this.range.high - this.range.low)) * height;
  }

  toVolts(pixel) {
    const { top, height } = this.area;
    return this.range.high - ((pixel - top) / height) * (this.range.high - this.range.low);
  }

  #follow() {
    new ResizeObserver(() => this.#resize()).observe(this.drawn);
    new IntersectionObserver((seen) => (this.inView = seen[seen.length - 1].isIntersecting)).observe(this.element);
  }

  #resize() {
    const width = this.drawn.clientWidth;
    if (width && this.plot && width !== this.plot.width) this.plot.setSize({ width, height: HEIGHT });
  }

  #build() {
    const width = this.drawn.clientWidth;
    if (width) this.plot = new uPlot(this.#options(width), [[], [], []], this.drawn);
  }

  #options(width) {
    const axis = { stroke: () => colour("--soft"), font: FONT, grid: { stroke: () => colour("--line"), width: 1 }, ticks: { show: false } };
    return {
      width,
      height: HEIGHT,
      legend: { show: false },
      cursor: { show: false },
      scales: { x: { time: false, auto: false }, y: { auto: false } },
      axes: [{ ...axis, values: (_, splits) => splits.map((time) => (time <= -this.span ? "" : secondsAgo(time))), size: 34, space: 90 }, { ...axis, ...voltAxis(), size: 86, space: 38 }],
      series: [{}, { stroke: () => colour("--series-1"), width: 1, paths: () => this.#signal() }, { stroke: () => colour("--series-2"), width: 3, paths: () => this.#level() }],
    };
  }

  /** Each bin from its lowest to its highest value, joined to the next; nothing where nothing came. */
  #signal() {
    const { low, high, times, count } = this.bins;
    const path = new Path2D();
    let pen = false;
    for (let bin = 0; bin < count; bin++) {
      if (!(high[bin] >= low[bin])) {
        pen = false;
        continue;
      }
      const x = this.#x(times[bin]);
      if (pen) path.lineTo(x, this.#y(low[bin]));
      else path.moveTo(x, this.#y(low[bin]));
      path.lineTo(x, this.#y(high[bin]) - (pen || low[bin] !== high[bin] ? 0 : 1));
      pen = true;
    }
    return { stroke: path };
  }

  #level() {
    const { level, times, count } = this.bins;
    const path = new Path2D();
    let pen = false;
    for (let bin = 0; bin < count; bin++) {
      const known = level[bin] === level[bin];
      if (known && pen) path.lineTo(this.#x(times[bin]), this.#y(level[bin]));
      else if (known) path.moveTo(this.#x(times[bin]), this.#y(level[bin]));
      pen = known;
    }
    return { stroke: path };
  }

  #x(time) {
    const { left, width } = this.plot.bbox;
    return left + Math.max(1 + time / this.span, 0) * width;
  }

  /** What is beyond the chart runs along its edge. */
  #y(volts) {
    const { top, height } = this.plot.bbox;
    const share = (this.range.high - volts) / (this.range.high - this.range.low);
    return top + Math.min(Math.max(share, 0), 1) * height;
  }
}

function colour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

function secondsAgo(time) {
  return time === 0 ? "now" : `−${Number((-time).toFixed(1))} s`;
}
