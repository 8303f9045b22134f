/** A joint in numbers and words, with their units: pure. */

import { isFresh } from "./sentences_alarms.js";
import { degrees, degreesPerSecond, number, percent, seconds } from "./units.js";

/** What a limit did, for who wonders why the joint is slow. */
const LIMITED = {
  velocity: "at its top speed",
  acceleration: "gathering speed",
  position: "at the end of its range",
  "soft zone": "slow: near the end of its range",
  load: "stopped: load too high",
  warm: "slowed: warm",
  stale: "stopped: not answering",
};

const HOLDERS = { emg: "muscles", joystick: "joystick", assist: "assist", home: "going home", "": "nobody" };

/** What stands where nothing is known now. */
export const UNKNOWN = { angle: "–", numbers: "not known now", state: "", warning: "" };

/**
 * @param {boolean} quiet whether it is said elsewhere that no joint answers
 * @returns {{angle: string, numbers: string, state: string, warning: string}}
 */
export function jointWords(joint, expected, spec, quiet = false) {
  return {
    angle: degrees(joint.position),
    numbers: measured(joint).join(" · "),
    state: [...expectation(expected), joint.mode, `moved by ${holder(joint)}`].join(" · "),
    warning: warnings(joint, spec, quiet).join(" · "),
  };
}

/** A reading that is old tells no speed. */
function measured(joint) {
  const { load, temperature } = joint;
  const velocity = isFresh(joint) ? joint.velocity : NaN;
  return [degreesPerSecond(velocity), `load ${percent(load)}`, number(temperature, 0, "°C")];
}

function expectation(expected) {
  return Number.isFinite(expected) ? [`expected ${degrees(expected)}`] : [];
}

function holder({ holder: who, mode }) {
  if (who.startsWith("client:")) return who.slice("client:".length) || "a client";
  return who === mode ? "nobody" : (HOLDERS[who] ?? who);
}

function warnings(joint, spec, quiet) {
  return [
    quiet || joint.freshness === "fresh" ? "" : `⚠ ${joint.freshness}: last read ${seconds(joint.age)} ago`,
    ...joint.errors.map((error) => `⚠ ${error}`),
    heat(joint.temperature, spec),
    joint.mode === "active" ? (LIMITED[joint.limited] ?? joint.limited) : "",
  ].filter(Boolean);
}

/** Only where the daemon says what is warm. */
function heat(temperature, spec) {
  if (temperature >= (spec?.hot_c ?? Infinity)) return `⚠ hot: it lets go at ${spec.hot_c} °C`;
  return temperature >= (spec?.warm_c ?? Infinity) ? `⚠ warm: slower from ${spec.warm_c} °C on` : "";
}
