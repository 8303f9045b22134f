/** Where joints are expected, how soon, and how sure that is: pure, from one frame. */

/** @typedef {{position: number, seconds: number, confidence: number | null, error: number | null}} Expected */

/**
 * Each joint's prediction at its longest timescale, by name; joints without one are absent, and so are all that
 * wait or do not answer: of what is held still, what was learned in motion says nothing.
 * @returns {Map<string, Expected>} position and error in rad; confidence up to 1, null where nobody says
 */
export function expectations(frame) {
  if (frame.mode !== "active") return new Map();
  const able = frame.joints.filter((joint) => joint.mode === "active" && joint.freshness === "fresh");
  const found = able.map((joint) => [joint.name, longest(joint, frame)]);
  return new Map(found.filter(([, expected]) => expected !== null));
}

function longest(joint, frame) {
  const timescales = Object.keys(joint.predictions).sort((one, other) => Number(one) - Number(other));
  const timescale = timescales.at(-1);
  if (timescale === undefined || !Number.isFinite(joint.predictions[timescale])) return null;
  const gvf = `${joint.name}.position@${timescale}`;
  return {
    position: joint.predictions[timescale],
    seconds: Number(timescale) / frame.rate_hz,
    confidence: finite(frame.learn.confidence[gvf]),
    error: finite(frame.learn.error[gvf]),
  };
}

function finite(value) {
  return Number.isFinite(value) ? value : null;
}

/** The name of the joint that the operator attends to: the one that they move, else the one that is selected. */
export function attendedJoint(frame) {
  const driven = frame.groups.find((group) => group.operator) ?? frame.groups[0];
  return frame.assist.attended || driven?.active || "";
}

const FAMILIAR = 0.2;

/** Whether the learners have hardly ever been in a state like this one. */
export function isNew(frame) {
  const known = Object.values(frame.learn.familiarity).filter(Number.isFinite);
  return known.length > 0 && Math.max(...known) < FAMILIAR;
}
