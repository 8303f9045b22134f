/** What somebody must look at, and what stands in the arm's way: sentences, pure, from one frame. */

import { ended, listed, nameWord } from "./sentences_words.js";

/** Limits that a person can do something about. */
const LIMITS = {
  position: "is at the end of its range",
  load: "pushes against more than it may carry",
  warm: "is slowed down, because its servo is warm",
  stale: "is stopped, because its servo does not answer",
};

/** s for which a reading tells how a joint moves. */
const RECENT = 0.2;

/** Whether a joint's reading tells how it moves now. */
export function isFresh(joint) {
  return joint.freshness === "fresh" && joint.age < RECENT;
}

/** What comes before everything else. `muscles`: whether the arm listens to any. */
export function alarms(frame, muscles) {
  const deaf = muscles && frame.emg.problem ? [`The muscles move nothing: ${ended(frame.emg.problem)}`] : [];
  const alone = muscles ? [] : joystickProblem(frame);
  return [...(frame.fault ? [ended(frame.fault)] : []), ...silence(frame.joints), ...deaf, ...alone];
}

/** Who does not answer, and for how long: one sentence, or none. */
export function silence(joints) {
  const silent = joints.filter((joint) => joint.freshness !== "fresh");
  if (!silent.length) return [];
  const age = `${Math.max(...silent.map((joint) => joint.age)).toFixed(1)}\u00a0s`;
  if (silent.length > 1 && silent.length === joints.length) return [`No joint answers (${age}).`];
  if (silent.length === 1) return [`${nameWord(silent[0].name)} has not answered for ${age}.`];
  return [`${nameWord(listed(silent.map((joint) => joint.name)))} have not answered for ${age}.`];
}

/** What slows the arm down. */
export function hindrances(frame, muscles) {
  const limited = frame.joints.filter((joint) => joint.limited in LIMITS && joint.freshness === "fresh");
  const apart = frame.mode === "active" ? frame.joints.filter((joint) => joint.mode !== "active") : [];
  return [
    ...(muscles && frame.emg.paused ? ["The muscles are paused and move nothing."] : []),
    ...(frame.joystick?.paused ? ["The joystick is paused and moves nothing."] : []),
    ...(muscles ? joystickProblem(frame) : []),
    ...limited.map((joint) => `${nameWord(joint.name)} ${LIMITS[joint.limited]}.`),
    ...apart.map((joint) => `${nameWord(joint.name)} is ${joint.mode}.`),
  ];
}

function joystickProblem({ joystick }) {
  if (!joystick?.problem || joystick.paused) return [];
  const told = ended(joystick.problem);
  return [/joystick/i.test(told) ? told : `The joystick moves nothing: ${told}`];
}
