// @ts-check
/** What a frame shows of the signals that learners predict, and in which unit it is read: pure. */

import { words } from "./units.js";

/** @typedef {{unit: string, per: number, digits: number}} Scale `per`: what 1 of the signal is on the screen */

const DEGREES = 180 / Math.PI;
const SHARE = { unit: "%", per: 100, digits: 0 };

/** Of a joint: by the field of its frame. */
const FIELDS = {
  position: { unit: "°", per: DEGREES, digits: 1 },
  velocity: { unit: "°/s", per: DEGREES, digits: 0 },
  load: SHARE,
  voltage: { unit: "V", per: 1, digits: 1 },
  temperature: { unit: "°C", per: 1, digits: 0 },
};

const PLAIN = { unit: "", per: 1, digits: 3 };

/** How numbers about a signal are read. @returns {Scale} */
export function scaleOf(cumulant) {
  const [, field] = split(cumulant);
  if (FIELDS[field]) return FIELDS[field];
  return /^emg\.|\.effort$|\.active\.|\.together$/.test(plain(cumulant)) ? SHARE : PLAIN;
}

/**
 * What reads a signal from a frame: NaN where it is not known; null for what frames do not show.
 * @returns {((frame: any) => number) | null}
 */
export function readerOf(cumulant, frame) {
  const name = plain(cumulant);
  const [owner, field] = split(name);
  if (FIELDS[field] && frame.joints.some((joint) => joint.name === owner)) return (told) => fresh(told.joints.find((joint) => joint.name === owner), field);
  if (name.startsWith("emg.") && name.slice(4) in (frame.emg?.effort ?? {})) return (told) => number(told.emg.effort[name.slice(4)]);
  const group = (told) => told.groups.find((one) => one.name === owner);
  if (!group(frame)) return null;
  if (field === "effort") return (told) => number(group(told)?.effort);
  if (field === "together") return (told) => Number(group(told)?.together);
  if (field.startsWith("active.")) return (told) => Number(group(told)?.active === field.slice(7));
  return null;
}

/** What was not read in the tick is not what the joint did. */
const fresh = (joint, field) => (joint?.freshness === "fresh" ? number(joint[field]) : NaN);

const number = (value) => (typeof value === "number" ? value : NaN);

/** A name that Python would not take for one is quoted in expressions. */
const plain = (cumulant) => cumulant.replace(/^(['"])(.*)\1$/, "$2");

function split(cumulant) {
  const name = plain(cumulant);
  const dot = name.indexOf(".");
  return dot < 0 ? [name, ""] : [name.slice(0, dot), name.slice(dot + 1)];
}

/** Ticks that a question looks ahead; NaN where that is no single number. */
export function ticksOf(gvf) {
  const gamma = Number(gvf.gamma);
  return gamma >= 0 && gamma < 1 ? 1 / (1 - gamma) : NaN;
}

/** A number about a signal, with its unit. */
export function shownAs(value, { unit, per, digits }) {
  if (typeof value !== "number" || !Number.isFinite(value)) return "–";
  const scaled = value * per;
  const text = unit ? scaled.toFixed(digits) : String(Number(scaled.toPrecision(3)));
  const signed = Number(text) === 0 ? text.replace("-", "") : text.replace("-", "−");
  return `${signed}${unit === "°" || unit === "%" || !unit ? unit : ` ${unit}`}`;
}

/** A signal as people say it: "wrist_flexion.position" → "wrist flexion, position". */
export const signalWords = (cumulant) => words(plain(cumulant)).replace(".", ", ");
