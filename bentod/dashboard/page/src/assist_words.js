// @ts-check
/** Words for assists: pure. */

import { sentence, words } from "./units.js";

/** The ways in which unattended joints may be moved; one at most is chosen. */
export const FOLLOW = {
  dpcc: "Where they are expected (dpcc)",
  dpcc_confident: "Where they are expected, only if sure (dpcc_confident)",
  effort: "As their user is expected to move them (effort)",
};

/** What may be chosen beside it. */
export const BESIDE = {
  trajectory: "All joints together along the learned path (trajectory)",
  adaptive_switching: "Toggles go to the most needed joint (adaptive_switching)",
};

const OFF = "off";

/** Whether an assist helps now, as a word with a mark. */
export function stateWord({ mode, engaged }) {
  if (mode === OFF) return "○ Off";
  return engaged ? "● Helping" : "◌ Waiting";
}

/** A mode's parts: {follow, beside, others}; others are assists of other packages. */
export function partsOf(mode) {
  const parts = mode === OFF ? [] : mode.split("+");
  return {
    follow: parts.find((part) => part in FOLLOW) ?? "",
    beside: parts.filter((part) => part in BESIDE),
    others: parts.filter((part) => !(part in FOLLOW) && !(part in BESIDE)),
  };
}

/** The mode that has these parts; what moves joints where they are expected comes first. */
export function modeOf({ follow, beside, others }) {
  return [follow, ...beside, ...others].filter(Boolean).join("+") || OFF;
}

/** What an assist moves, the quickest first; `share`: of the joint's top speed, 0..1. */
export function shownMotions(moving, info) {
  const tops = Object.fromEntries((info?.joints ?? []).map((joint) => [joint.name, joint.max_velocity_rad_s]));
  const all = Object.entries(moving).map(([joint, velocity]) => ({ joint, velocity, share: Math.min(1, Math.abs(velocity) / (tops[joint] || Infinity)) }));
  return all.sort((one, other) => other.share - one.share);
}

/** What an assist has found out, as names and texts; tables are flattened. */
export function toldPairs(told, before = "") {
  return Object.entries(told).flatMap(([name, value]) => {
    const title = before ? `${before}, ${words(name)}` : sentence(words(name));
    if (value !== null && typeof value === "object" && !Array.isArray(value)) return toldPairs(value, title);
    return [[title, textOf(value)]];
  });
}

function textOf(value) {
  if (typeof value === "boolean") return value ? "yes" : "no";
  if (typeof value === "number") return String(Number(value.toPrecision(3)));
  return Array.isArray(value) ? value.map(textOf).join(", ") : String(value ?? "–");
}
