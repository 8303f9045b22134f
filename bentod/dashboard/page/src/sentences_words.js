/** Words for joints, for how they turn, and for who turns them: pure. */

import { sentence, words } from "./units.js";

const DEGREE = Math.PI / 180;

/** How a joint turns towards higher and towards lower angles, as bento.urdf draws it. */
const WAYS = {
  shoulder_rotation: ["turning left", "turning right"],
  elbow_flexion: ["moving up", "moving down"],
  wrist_rotation: ["turning clockwise", "turning counter-clockwise"],
  wrist_flexion: ["flexing", "extending"],
  gripper: ["opening", "closing"],
};

const ANY_WAY = ["moving to higher angles", "moving to lower angles"];

const DRIVERS = {
  emg: "driven by the muscles",
  joystick: "driven by the joystick",
  assist: "moved by the assist",
  home: "on its way home",
};

/** An angle as in a sentence, e.g. "+24°". */
export function angleWord(radians) {
  const whole = Math.round(radians / DEGREE);
  return `${whole > 0 ? "+" : whole < 0 ? "−" : ""}${Math.abs(whole)}°`;
}

/** A speed as in a sentence, e.g. "12 °/s"; never 0 for something that moves. */
export function speedWord(radiansPerSecond) {
  return `${Math.max(1, Math.round(Math.abs(radiansPerSecond) / DEGREE))}\u00a0°/s`;
}

/** Which way a joint goes at a velocity (rad/s). */
export function wayWord(name, velocity) {
  return (WAYS[name] ?? ANY_WAY)[velocity > 0 ? 0 : 1];
}

/** Who moves a joint, from a frame's `holder`. */
export function driverWord(holder) {
  if (holder.startsWith("client:")) return `moved by ${holder.slice("client:".length) || "a client"}`;
  return DRIVERS[holder] ?? "coming to rest";
}

/** Several names as in a sentence: "a, b and c". */
export function listed(names) {
  return names.length < 2 ? names.join("") : `${names.slice(0, -1).join(", ")} and ${names.at(-1)}`;
}

/** A joint's name at the beginning of a sentence. */
export function nameWord(name) {
  return sentence(words(name));
}

/** The same with a full stop, if it has none. */
export function ended(text) {
  return /[.!?]$/.test(text) ? text : `${text}.`;
}
