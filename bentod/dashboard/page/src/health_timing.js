// @ts-check
/** How the daemon keeps time: rate, how late ticks begin, and what a tick's time goes to. */

import { adviceFor, complaints } from "./advice.js";
import { growth, SPAN } from "./health_missed.js";
import { el, say, section } from "./dom.js";
import { BINS, Histogram, edgeOf } from "./histogram.js";
import { phasesBar } from "./health_phases.js";
import { atMost } from "./sparing.js";
import { number, seconds } from "./units.js";

const FACTS = ["Rate", "Tick", "Missed", "Left out by learners"];

/** @returns {HTMLElement} */
export function timingPart(app) {
  const histogram = new Histogram(SPAN);
  const facts = factList(FACTS);
  const chart = lateChart();
  const phases = phasesBar(app);
  const missed = growth();
  const element = section("Timing", facts.element, el("h3", { text: "How late ticks begin" }), chart.element, phases.element);
  app.health = { histogram, adviceFor, complaints };
  app.onTick((frame) => {
    histogram.add(frame.lateness, frame.time);
    missed.add(frame.missed, frame.time);
  });
  const show = (frame) => {
    facts.show([number(frame.rate_hz, 0, "Hz"), String(frame.tick), `${frame.missed} ticks, ${missed.recent} of them in the last ${SPAN} s`, `${frame.shed} updates`]);
    chart.show(histogram);
    phases.show();
  };
  app.onFrame(atMost(500, show), { element });
  return element;
}

/** Names with values that change. */
export function factList(names) {
  const values = names.map(() => el("dd", {}));
  const pairs = names.map((name, place) => el("div", {}, el("dt", { text: name }), values[place]));
  const element = el("dl", { class: "health-facts" }, ...pairs);
  return { element, show: (texts) => texts.forEach((text, place) => say(values[place], text)) };
}

/** Two bars for each bin: filled for the last minute, an outline for all. */
function lateChart() {
  const bins = Array.from({ length: BINS }, (_, bin) => el("div", { class: "histogram-bin", title: rangeOf(bin) }, el("i", { class: "histogram-all" }), el("i", { class: "histogram-recent" })));
  const plot = el("div", { class: "histogram-plot", role: "img" }, ...bins);
  const scale = el("div", { class: "histogram-scale", "aria-hidden": "true" }, ...["10 µs", "100 µs", "1 ms", "10 ms", "100 ms"].map((text) => el("span", { text })));
  const inWords = el("p", { class: "health-words" });
  const key = el("p", { class: "soft", text: `Filled: the last ${SPAN} s. Outline: since the page was opened. Height: share of the ticks that the page has seen, on a root scale.` });
  return { element: el("div", { class: "histogram" }, plot, scale, inWords, key), show: (histogram) => draw(histogram, bins, plot, inWords) };
}

function draw(histogram, bins, plot, inWords) {
  const [recent, all] = [shares(histogram.recent()), shares(histogram.all)];
  bins.forEach((bin, place) => {
    bin.style.setProperty("--recent", String(Math.sqrt(recent[place])));
    bin.style.setProperty("--all", String(Math.sqrt(all[place])));
  });
  const text = lateWords(histogram);
  say(inWords, text);
  plot.setAttribute("aria-label", text);
}

function lateWords(histogram) {
  if (!histogram.latest.length) return "No tick has been seen yet.";
  const [half, most] = [histogram.quantile(0.5), histogram.quantile(0.99)];
  const ever = histogram.quantileOfAll(0.99);
  return `Of the last ${SPAN} s, half of the ticks began within ${seconds(half)} of their deadline and 99% within ${seconds(most)}; of all, 99% within ${seconds(ever)}, the latest ${seconds(histogram.worst)} late.`;
}

function shares(counts) {
  const total = counts.reduce((sum, count) => sum + count, 0) || 1;
  return counts.map((count) => count / total);
}

function rangeOf(bin) {
  return bin === BINS - 1 ? `${seconds(edgeOf(bin))} and later` : `${seconds(edgeOf(bin))} to ${seconds(edgeOf(bin + 1))}`;
}

