// @ts-check
/** What the table of questions shows of each: pure, from gvf_list and the newest frame. */

import { scaleOf, shownAs, signalWords, ticksOf } from "./outcome_signals.js";
import { number, percent, words } from "./units.js";

/** Columns by key: title, and `term`, what books call it; numbers begin with the greatest when sorted. */
export const COLUMNS = [
  { key: "name", title: "Question", term: "What is predicted (a GVF)" },
  { key: "prediction", title: "Predicted", term: "The newest prediction" },
  { key: "confidence", title: "Sure", term: "Confidence C, from the errors of late" },
  { key: "error", title: "Off by", term: "RMSE of late, against the return" },
  { key: "surprise", title: "Unusual", term: "Surprise: the newest errors against their usual spread" },
];

/** What a frame says of a question; what it does not say is as gvf_list had it. */
export function numbersOf(gvf, frame) {
  const { predictions, confidence, surprise, error } = frame.learn;
  const [joint, timescale] = gvf.name.split(".position@");
  const there = frame.joints.find((one) => one.name === joint)?.predictions[timescale];
  return {
    name: gvf.name,
    prediction: predictions[gvf.name] ?? there ?? gvf.prediction,
    confidence: confidence[gvf.name] ?? gvf.confidence,
    surprise: surprise[gvf.name] ?? gvf.surprise,
    error: error[gvf.name] ?? gvf.error,
  };
}

/** The same as texts. */
export function textsOf(gvf, numbers) {
  const scale = gvf.scaled ? scaleOf(gvf.cumulant) : { unit: "", per: 1, digits: 3 };
  const known = (value, text) => (typeof value === "number" && Number.isFinite(value) ? text(value) : "–");
  return {
    name: gvf.name,
    prediction: shownAs(numbers.prediction, scale),
    confidence: known(numbers.confidence, (value) => percent(value)),
    error: shownAs(numbers.error, { ...scale, digits: scale.digits + 1 }),
    surprise: known(numbers.surprise, (value) => number(value, 2)),
  };
}

/** What is asked, in words. */
export function questionWords(gvf, rate) {
  const ticks = ticksOf(gvf);
  const ahead = Number.isFinite(ticks) ? `${number(ticks / rate, 2, "s")} ahead` : `as far as γ = ${gvf.gamma}`;
  const sum = gvf.scaled ? "" : "sum of ";
  const policy = gvf.policy ? `, if ${gvf.policy}` : "";
  return `${sum}${signalWords(gvf.cumulant)}, ${ahead}${policy}; from ${words(gvf.representation)}, by ${words(gvf.algorithm)}`;
}

/** Those whose name, signal or representation has all words of `text`, in the order asked for; unknown comes last. */
export function arranged(gvfs, numbers, { text, key, up }) {
  const wanted = text.toLowerCase().split(/\s+/).filter(Boolean);
  const named = (gvf) => `${gvf.name} ${words(gvf.name)} ${gvf.cumulant} ${gvf.representation}`.toLowerCase();
  const found = gvfs.filter((gvf) => wanted.every((word) => named(gvf).includes(word)));
  if (!key) return found;
  const way = up ? 1 : -1;
  const valueOf = new Map(found.map((gvf) => [gvf, numbers(gvf)[key]]));
  return found.sort((one, other) => compared(valueOf.get(one), valueOf.get(other), way));
}

function compared(one, other, way) {
  if (typeof one === "string") return way * one.localeCompare(other, undefined, { numeric: true });
  const [left, right] = [known(one), known(other)];
  if (!left || !right) return Number(right) - Number(left);
  return way * (one - other);
}

const known = (value) => typeof value === "number" && Number.isFinite(value);
