/** How sure the arm is, as a word, a share and a sentence: pure, from one frame. */

import { attendedJoint, expectations, isNew } from "./sentences_expected.js";
import { angleWord } from "./sentences_words.js";

/** @typedef {{word: string, share: number | null, text: string}} Sure share 0..1, null where nobody says */

/** @type {Sure} */
export const NOTHING = { word: "nothing expected", share: null, text: "It expects nothing." };

const VERY = 0.85;
const FAIRLY = 0.6; // from here on a cautious assist may help; its own setting may differ

const DEGREE = Math.PI / 180;

/** Usual error (rad), and the share that is left of any confidence: nobody is sure who is often wrong. */
const LEFT = [
  [0, 1],
  [8 * DEGREE, VERY],
  [15 * DEGREE, FAIRLY],
  [45 * DEGREE, 0],
];

/** @returns {Sure} */
export function sureness(frame) {
  const expected = expectations(frame).get(attendedJoint(frame));
  if (!expected) return NOTHING;
  if (expected.error === null) return { word: "still learning", share: null, text: "It is still learning." };
  if (isNew(frame)) {
    return { word: "not sure", share: 0, text: "It is not sure: it has not learned enough here yet." };
  }
  if (expected.confidence === null) return unsaid(expected.error);
  const share = sureShare(expected);
  const word = sureWord(share);
  return { word, share, text: `It is ${word} (${Math.round(share * 100)}%)${usual(expected.error)}.` };
}

/** The lower of what is said and what came true, 0..1; of an expectation whose error is known. */
export function sureShare({ confidence, error }) {
  return Math.min(Math.max(confidence ?? 0, 0), accuracy(error));
}

/** What is left of 1 after a usual error (rad). */
function accuracy(error) {
  const next = LEFT.findIndex(([upTo]) => error < upTo);
  if (next < 1) return next === 0 ? 1 : 0;
  const [[from, high], [upTo, low]] = [LEFT[next - 1], LEFT[next]];
  return high + ((low - high) * (error - from)) / (upTo - from);
}

function sureWord(share) {
  if (share >= VERY) return "very sure";
  return share >= FAIRLY ? "fairly sure" : "not sure";
}

function unsaid(error) {
  return { word: "not measured", share: null, text: `Nobody measures how sure it is${usual(error)}.` };
}

/** How wrong it was so far: confidence is about being consistent, this about coming true. */
function usual(error) {
  return `; such predictions were off by about ${angleWord(error).replace("+", "")} so far`;
}
