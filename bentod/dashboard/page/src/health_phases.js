// @ts-check
/** What a tick's time goes to, as parts of its period: the mean of the last second. */

import { el, say } from "./dom.js";
import { percent, seconds } from "./units.js";

const PHASES = {
  read: "reading the servos",
  think: "requests, muscles, learning, assist, limits",
  write: "writing to the servos",
  publish: "telling everybody",
};
const NAMES = Object.keys(PHASES);

/** Its `show` draws what `app` has received in the last second. */
export function phasesBar(app) {
  const recent = [];
  app.onTick((frame) => {
    if (frame.costs) recent.push(frame);
    while (recent.length > Math.max(1, frame.rate_hz)) recent.shift();
  });
  const bar = el("div", { class: "phases-bar", role: "img" }, ...NAMES.map((name) => el("i", { class: `phases-part phases-${name}` })));
  const told = Object.fromEntries(NAMES.map((name) => [name, el("span", { class: "phases-time" })]));
  const rows = NAMES.map((name) => el("li", {}, el("i", { class: `phases-mark phases-${name}`, "aria-hidden": "true" }), el("span", { text: PHASES[name] }), told[name]));
  const total = el("p", { class: "health-words" });
  const element = el("div", { class: "phases" }, el("h3", { text: "What a tick's time goes to" }), bar, total, el("ul", {}, ...rows));
  const show = () => recent.length && draw(recent, bar, told, total);
  return { element, show };
}

function draw(recent, bar, told, total) {
  const period = 1 / recent[recent.length - 1].rate_hz;
  const means = NAMES.map((name) => recent.reduce((sum, frame) => sum + frame.costs[name], 0) / recent.length);
  NAMES.forEach((name, place) => {
    bar.children[place].style.setProperty("--share", `${Math.min(100, (100 * means[place]) / period)}%`);
    say(told[name], seconds(means[place]));
  });
  const sum = means.reduce((all, one) => all + one, 0);
  const text = `${seconds(sum)} of ${seconds(period)}: ${percent(sum / period)} of a tick's period, as the mean of the last second.`;
  say(total, text);
  bar.setAttribute("aria-label", text);
}
