// @ts-check
/** One EMG site: its chart, how far it is from threshold and maximum, and what it is set to. */

import { el, say } from "./dom.js";
import { StripChart } from "./stripchart.js";
import { Bins, Levels } from "./stripchart_bins.js";
import { ChartLine } from "./stripchart_line.js";
import { rangeFor } from "./stripchart_scale.js";
import { SiteFields } from "./sites_fields.js";
import { SiteGauge } from "./sites_gauge.js";
import { sentence, words } from "./units.js";
import "./sites.css";

const LEVELS_KEPT = 400; // of ten a second
const LEVEL_HOLDS = 0.5; // s for which a level stands without another

/** Half of the smallest step between threshold and maximum. */
const APART = 1.001;

export class SiteCard {
  /** @param {{name: string, channel: number}} site; without a name it is a channel that no site is on */
  constructor(app, settings, { name, channel }) {
    this.app = app;
    this.settings = settings;
    this.name = name;
    this.channel = channel;
    this.levels = new Levels(LEVELS_KEPT);
    this.range = null;
    const title = name ? sentence(words(name)) : `Channel ${channel}`;
    this.chart = new StripChart(`EMG of ${title}, V after gain, newest on the right`);
    this.state = el("span", { class: "sites-state" });
    const where = name ? `channel ${channel}` : "no site is on it";
    const head = el("div", { class: "sites-head" }, el("h3", { text: title }), el("span", { class: "soft", text: where }), this.state);
    this.element = el("article", { class: "sites-card", data: { site: name ?? `channel ${channel}` }, "aria-label": title }, head, this.chart.element);
    if (name) this.#steer();
  }

  /** Take in the newest level (V after gain) at the index of a sample, and why its lead is off. */
  hear(index, level, off) {
    this.levels.add(index, level);
    this.off = off ?? "";
  }

  /** Draw what is newest. `span`: s; `whole`: everything rather than what is near the maximum. */
  draw(ring, rate, span, whole) {
    if (!this.chart.inView || ring.next < 0) return;
    const bins = this.#bins();
    const gain = this.name ? this.settings.values(this.name).gain ?? 1 : 1;
    bins.fill(ring, this.channel, rate, span, gain);
    bins.fillLevels(ring, this.levels, LEVEL_HOLDS * rate);
    if (!this.lines?.some((line) => line.dragged)) this.range = this.#range(bins, whole || !this.name);
    this.chart.draw(bins, span, this.range);
  }

  /** Show effort (0..1) and level as numbers. */
  showEffort(effort) {
    if (!this.name) return;
    const off = this.off ? `✖ lead off: ${this.off}` : "";
    say(this.state, off || (this.settings.pending(this.name) ? "… setting" : ""));
    this.element.classList.toggle("sites-off", Boolean(this.off));
    this.gauge.show(effort, this.levels.newest, this.settings.values(this.name));
  }

  /** Show what it is set to. */
  showSettings() {
    if (!this.name) return;
    const { threshold_v: threshold, max_v: maximum } = this.settings.values(this.name);
    const [pending, fixed] = [this.settings.pending(this.name), !this.app.can("emg_set")];
    this.lines[0].show(threshold, pending, fixed);
    this.lines[1].show(maximum, pending, fixed);
    this.fields.show(fixed);
  }

  #bins() {
    const pixels = this.chart.pixels;
    if (this.kept?.count !== pixels) this.kept = new Bins(pixels);
    return this.kept;
  }

  /** From a little below 0 to above the maximum; or as far as the signal goes, both ways. */
  #range(bins, whole) {
    let peak = 0;
    for (let bin = 0; whole && bin < bins.count; bin++) peak = Math.max(peak, bins.high[bin] || 0, -bins.low[bin] || 0);
    const { threshold_v: threshold, max_v: maximum } = this.settings.values(this.name);
    if (this.name) peak = Math.max(peak, maximum ?? 0, threshold ?? 0);
    return rangeFor(1.3 * peak, this.range, whole ? 1 : 0.4);
  }

  #steer() {
    const set = (key) => (value) => this.settings.set(this.name, { [key]: value });
    const now = () => this.settings.values(this.name);
    const title = words(this.name);
    const threshold = new ChartLine({
      name: "threshold",
      label: "threshold",
      what: `Threshold of ${title}: effort is 0 up to here`,
      bounds: () => [this.settings.bounds("threshold_v")[0], now().max_v / APART],
      commit: set("threshold_v"),
    });
    const maximum = new ChartLine({
      name: "maximum",
      label: "maximum",
      what: `Maximum of ${title}: effort is 100 % from here on`,
      bounds: () => [Math.max(this.settings.bounds("max_v")[0], now().threshold_v * APART), this.settings.bounds("max_v")[1]],
      commit: set("max_v"),
    });
    this.lines = [threshold, maximum];
    for (const line of this.lines) this.chart.addLine(line);
    this.gauge = new SiteGauge(title);
    this.fields = new SiteFields(this.settings, this.name);
    this.element.append(this.gauge.element, this.fields.element);
  }
}
