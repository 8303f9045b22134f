/** What of a frame can be drawn: pure. */

import { attendedJoint, expectations } from "./sentences_expected.js";

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

/** @returns {Picture} */
export function picture(frame) {
  const known = frame.joints.filter((joint) => Number.isFinite(joint.position));
  const angles = Object.fromEntries(known.map((joint) => [joint.name, joint.position]));
  const attended = attendedJoint(frame);
  return { angles, ghost: ghost(frame, angles), attended, way: way(frame, attended) };
}

function way(frame, attended) {
  const velocity = frame.joints.find((joint) => joint.name === attended)?.velocity ?? 0;
  return Math.abs(velocity) < MOVING ? 0 : Math.sign(velocity);
}

/** The arm where its predictions say; as faint as the least sure of those that lie elsewhere. */
function ghost(frame, angles) {
  if (frame.mode !== "active") return null;
  const told = [...expectations(frame)].filter(([name]) => name in angles);
  const elsewhere = told.filter(([name, { position }]) => Math.abs(position - angles[name]) > ELSEWHERE);
  if (!elsewhere.length) return null;
  const expected = Object.fromEntries(told.map(([name, { position }]) => [name, position]));
  return {
    angles: { ...angles, ...expected },
    moved: elsewhere.map(([name]) => name),
    opacity: opacity(elsewhere.map(([, { confidence }]) => confidence)),
  };
}

function opacity(confidences) {
  const least = Math.min(...confidences.map((confidence) => Math.min(Math.max(confidence ?? 0, 0), 1)));
  return FAINTEST + (STRONGEST - FAINTEST) * least;
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
