// @ts-check
/** The charts of all channels: samples in, pictures out, while somebody looks and the picture is not frozen. */

import { button, el, field, say } from "./dom.js";
import { SiteCard } from "./sites.js";
import { Ring } from "./stripchart_ring.js";
import { seconds } from "./units.js";

const LONGEST = 20; // s that can be looked at
const POLL = 100; // ms between two looks at the levels

export class MuscleCharts {
  #asking = false;
  #heard = 0;

  constructor(app, settings) {
    this.app = app;
    this.settings = settings;
    this.cards = [];
    this.ring = null;
    this.frozen = false; // the pictures stand still; samples are taken in all the same
    this.span = app.setting("muscles.span", 5);
    this.whole = app.setting("muscles.whole", false);
    this.list = el("div", { class: "muscles-charts" });
    this.element = el("div", { class: "muscles-signals" }, this.#controls(), this.list);
    settings.listeners.push(() => this.#settled());
    app.onEmg((block) => this.#take(block));
    app.onFrame((frame) => this.draw(frame), { element: this.element });
    setInterval(() => this.#poll(), POLL);
  }

  /** Samples that never came here. */
  get missing() {
    return this.ring?.missing ?? 0;
  }

  /** V after gain of a site as it was told last; NaN if it is not known. */
  level(name) {
    return this.cards.find((card) => card.name === name)?.levels.newest ?? NaN;
  }

  draw(frame) {
    for (const card of this.cards) card.showEffort(frame.emg.effort[card.name]);
    if (!this.ring || !this.settings.rate || this.frozen) return;
    for (const card of this.cards) card.draw(this.ring, this.settings.rate, this.span.get(), this.whole.get());
  }

  #take(block) {
    if (!this.settings.rate) return;
    if (this.ring?.channels.length !== block.channels) this.#begin(block.channels);
    this.ring.take(block);
  }

  #begin(channels) {
    this.ring = new Ring(channels, LONGEST * this.settings.rate);
    this.#build();
  }

  #settled() {
    const names = this.settings.sites.map(({ name, channel }) => `${name} ${channel}`).join();
    if (names !== this.names) this.#build();
    for (const card of this.cards) card.showSettings();
  }

  /** A card for each site, and for each channel that no site is on. */
  #build() {
    this.names = this.settings.sites.map(({ name, channel }) => `${name} ${channel}`).join();
    const used = new Set(this.settings.sites.map(({ channel }) => channel));
    const rest = this.ring ? this.ring.channels.map((_, channel) => ({ name: "", channel })).filter(({ channel }) => !used.has(channel)) : [];
    this.cards = [...this.settings.sites, ...rest].map((site) => new SiteCard(this.app, this.settings, site));
    this.list.replaceChildren(...this.cards.map((card) => card.element));
    for (const card of this.cards) card.showSettings();
  }

  /** Levels are asked for while somebody looks, one request at a time. */
  async #poll() {
    if (this.#asking || document.hidden || this.element.offsetParent === null || !this.app.linkState.daemon) return;
    this.#asking = true;
    try {
      const told = await this.app.call("dashboard.emg_levels");
      for (const card of this.cards) if (card.name) card.hear(told.index - 1, told.levels_v[card.name], told.leads_off[card.name]);
    } catch {
      // Said elsewhere; a level that is not told is not drawn.
    } finally {
      this.#asking = false;
    }
  }

  #controls() {
    const shown = el("output", { class: "muscles-span" });
    const slider = el("input", { type: "range", min: 1, max: LONGEST, step: 1, value: this.span.get(), id: "muscles-span" });
    const tell = () => say(shown, `${slider.value} s`);
    slider.addEventListener("input", () => (this.span.set(Number(slider.value)), tell()));
    tell();
    const scale = el("select", { id: "muscles-scale" }, el("option", { value: "near", text: "threshold and maximum" }), el("option", { value: "whole", text: "the whole signal" }));
    scale.value = this.whole.get() ? "whole" : "near";
    scale.addEventListener("change", () => this.whole.set(scale.value === "whole"));
    const length = el("label", { class: "field" }, el("span", { text: "Shown" }), slider, shown);
    const fit = field("Scale fits", scale);
    return el("div", { class: "muscles-controls" }, this.#freezeButton(), length, fit, key());
  }

  #freezeButton() {
    const told = el("strong", { class: "muscles-frozen", role: "status" });
    const freeze = button("Freeze the charts", () => this.#freeze(freeze, told), { id: "muscles-freeze", "aria-pressed": "false" });
    this.app.onFrame(() => this.frozen && say(told, `Frozen: ${seconds(Math.max(performance.now() - this.#heard, 0) / 1000)} ago`), { element: this.element });
    return el("span", { class: "row" }, freeze, told);
  }

  #freeze(freeze, told) {
    this.frozen = !this.frozen;
    this.#heard = performance.now();
    freeze.setAttribute("aria-pressed", String(this.frozen));
    say(freeze, this.frozen ? "Go on" : "Freeze the charts");
    say(told, "");
    this.element.classList.toggle("frozen", this.frozen);
  }
}

/** What the two curves are, and on which scale they are drawn. */
function key() {
  const thin = el("span", { class: "muscles-thin", "aria-hidden": "true" });
  const thick = el("span", { class: "muscles-thick", "aria-hidden": "true" });
  return el(
    "p",
    { class: "muscles-key" },
    thin,
    "signal times gain (thin; beyond the chart it runs along the edge). ",
    thick,
    "level: what the arm heeds (thick): rectified and averaged, times gain. Threshold and maximum are volts of the level.",
  );
}
