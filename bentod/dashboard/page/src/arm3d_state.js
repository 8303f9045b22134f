/** What of a frame can be drawn: pure. */

import { isFresh } from "./sentences_alarms.js";
import { attendedJoint, expectations } from "./sentences_expected.js";
import { sureShare } from "./sentences_sure.js";

/** rad from which on an expectation is worth a ghost. */
const ELSEWHERE = 0.02;

/** rad/s from which on a joint counts as moving. */
const MOVING = 0.02;

const FAINTEST = 0.15;
const STRONGEST = 0.6;

/**
 * @typedef {object} Picture
 * @property {Record<string, number>} angles rad by joint, of those that are known
 * @property {{angles: Record<string, number>, moved: string[], opacity: number} | null} ghost
 *   where the arm is expected, and which joints are expected elsewhere
 * @property {string} attended the joint that the operator attends to, or empty
 * @property {number} way of the attended joint: 1 towards higher angles, −1 towards lower, 0 at rest
 */

/**
 * @param {boolean} [isNow] whether the frame tells how the arm is now
 * @returns {Picture}
 */
export function picture(frame, isNow = true) {
  const known = frame.joints.filter((joint) => Number.isFinite(joint.position));
  const angles = Object.fromEntries(known.map((joint) => [joint.name, joint.position]));
  const attended = attendedJoint(frame);
  if (!isNow) return { angles, ghost: null, attended: "", way: 0 };
  return { angles, ghost: ghost(frame, angles), attended, way: way(frame, attended) };
}

function way(frame, attended) {
  const joint = frame.joints.find((one) => one.name === attended);
  const velocity = joint && isFresh(joint) ? joint.velocity : 0;
  return Math.abs(velocity) < MOVING ? 0 : Math.sign(velocity);
}

/** The arm where predictions say that have come true before; as faint as the least sure of those that lie elsewhere. */
function ghost(frame, angles) {
  const told = [...expectations(frame)].filter(([name, { error }]) => name in angles && error !== null);
  const elsewhere = told.filter(([name, { position }]) => Math.abs(position - angles[name]) > ELSEWHERE);
  if (!elsewhere.length) return null;
  const expected = Object.fromEntries(told.map(([name, { position }]) => [name, position]));
  return {
    angles: { ...angles, ...expected },
    moved: elsewhere.map(([name]) => name),
    opacity: opacity(elsewhere.map(([, expectation]) => sureShare(expectation))),
  };
}

function opacity(shares) {
  return FAINTEST + (STRONGEST - FAINTEST) * Math.min(...shares);
}

/** Whether two pictures would look the same: to a hundredth of a degree and of opacity. */
export function alike(one, other) {
  return one !== null && other !== null && signature(one) === signature(other);
}

function signature({ angles, ghost: expected, attended, way: going }) {
  const shape = expected && [rounded(expected.angles), expected.moved, Math.round(expected.opacity * 100)];
  return JSON.stringify([rounded(angles), shape, attended, going]);
}

function rounded(angles) {
  return Object.entries(angles).map(([name, angle]) => [name, Math.round(angle * 5730)]);
}
