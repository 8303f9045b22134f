/** What an arm that waits says of itself, what is to be done then, and how it is stopped: pure. */

/**
 * @typedef {object} Around what a frame does not tell
 * @property {string} [lost] why nothing is known of the arm now; empty: it is
 * @property {boolean} [silent] whether that is only because nothing was heard
 * @property {boolean} [operator] whether who reads may release the arm
 * @property {boolean} [muscles] whether the arm listens to any
 * @property {boolean} [touch] whether there are fingers and no keys
 * @property {boolean} [replaying] whether this is a recording and no arm
 */

/** @type {Required<Around>} */
export const USUAL = { lost: "", silent: false, operator: true, muscles: true, touch: false, replaying: false };

/** Headline and what to do next, of an arm that waits; empty where it does not. */
export function waiting(frame, around) {
  if (!(frame.mode in STATES)) return { headline: "", todo: "" };
  const [headline, todo, order] = STATES[frame.mode](drivers(frame, around));
  if (around.replaying) return { headline, todo: "" };
  return { headline, todo: around.operator ? todo : `An operator must ${order}.` };
}

const STATES = {
  fault: () => [
    "The arm is stopped by a fault.",
    "Clear the fault when its cause is gone, then release the arm.",
    "clear the fault",
  ],
  limp: () => [
    "The arm is limp: it has no torque and hangs freely.",
    "Switch the torque on to hold it where it is; then release it to move.",
    "switch the torque on",
  ],
  holding: ({ release }) => ["The arm holds still where it was found.", release, "release it"],
  paused: ({ whatever, release }) => [`The arm is paused: it holds still${whatever}.`, release, "release it"],
};

/** What of the arm's drivers is said while they drive nothing. */
function drivers(frame, { muscles }) {
  const who = [...(muscles ? ["the muscles"] : []), ...(frame.joystick ? ["the joystick"] : [])].join(" or ");
  if (!who) return { whatever: "", release: "Release to let it move." };
  const asks = frame.joystick ? `${who} asks` : `${who} say`;
  return { whatever: `, whatever ${asks}`, release: `Release to let ${who} move it.` };
}

const STILL = {
  fault: "is stopped by a fault",
  limp: "is limp",
  holding: "holds still",
  paused: "is paused",
};

/** Why no assist helps; empty where one may. */
export function noHelp(mode) {
  return mode in STILL ? `Nothing helps while the arm ${STILL[mode]}.` : "";
}

/** How to stop the arm from here. */
export function stopping(mode, { lost, silent, touch, replaying }) {
  if (replaying) return "This is a replay: no arm moves.";
  if (lost) return `STOP ${silent ? "may not" : "cannot"} reach the arm from here: cut its power.`;
  const now = mode === "limp" ? "It cannot move by itself now. " : "";
  return `${now}Press ${touch ? "STOP" : "Escape or STOP"}: all joints stop.`;
}
