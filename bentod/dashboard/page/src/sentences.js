/** What the arm does, why, what it expects, how sure it is, and how to stop it: pure, from one frame. */

import { attendedJoint, expectations, isNew, sureWord } from "./sentences_expected.js";
import { angleWord, driverWord, listed, speedWord, wayWord } from "./sentences_words.js";
import { sentence, words } from "./units.js";

/**
 * @typedef {object} Story
 * @property {string} headline the state of the arm, or the first thing that it does
 * @property {string} todo what to do next if the arm waits for somebody; else empty
 * @property {string[]} doing what moves, who moves it, and what is wrong
 * @property {string} expects where joints are expected; empty if nothing is
 * @property {{word: string, share: number | null, text: string}} sure share 0..1, null where nobody says
 * @property {string} help what the assist does, and why
 * @property {string} stop how to stop the arm
 */

/** rad/s from which on a joint counts as moving: an MX servo tells 0.012 apart. */
const MOVING = 0.02;

/** rad from which on an expectation is another place. */
const ELSEWHERE = 0.035;

/** rad of usual error that takes the shine off any confidence. */
const FAR_OFF = 0.17;

const STATES = {
  fault: ["The arm is stopped by a fault.", "Clear the fault when its cause is gone, then release the arm."],
  limp: [
    "The arm is limp: it has no torque and hangs freely.",
    "Switch the torque on to hold it where it is; then release it to move.",
  ],
  holding: ["The arm holds still where it was found.", "Release to let the muscles move it."],
  paused: ["The arm is paused: it holds still, whatever the muscles say.", "Release to let the muscles move it."],
};

/** Limits that a person can do something about. */
const LIMITS = {
  position: "is at the end of its range",
  load: "pushes against more than it may carry",
  warm: "is slowed down, because its servo is warm",
  stale: "is stopped, because its servo does not answer",
};

const NOTHING = { word: "nothing expected", share: null, text: "It expects nothing." };

/**
 * The story of one frame.
 * @param {object | null} frame as get_state gives it; null: none has come yet
 * @returns {Story}
 */
export function sentences(frame) {
  if (!frame) return { ...story("Waiting for the arm."), stop: stopping("") };
  const [headline, todo] = STATES[frame.mode] ?? ["", ""];
  const doing = [...alarms(frame), ...motion(frame), ...hindrances(frame)];
  const waits = headline !== "";
  return {
    ...story(headline || doing.shift() || "", todo),
    doing,
    expects: waits ? "" : expecting(frame),
    sure: waits ? NOTHING : sureness(frame),
    help: helping(frame),
    stop: stopping(frame.mode),
  };
}

/** The story in one breath, for those who hear it. */
export function inOneBreath(told) {
  const sure = told.expects ? told.sure.text : "";
  return [told.headline, told.todo, ...told.doing, told.expects, sure].filter(Boolean).join(" ");
}

function story(headline, todo = "") {
  return { headline, todo, doing: [], expects: "", sure: NOTHING, help: "" };
}

/** What somebody must look at: it comes before everything else. */
function alarms(frame) {
  const silent = frame.joints.filter((joint) => joint.freshness !== "fresh");
  return [
    ...(frame.fault ? [ended(frame.fault)] : []),
    ...silent.map((joint) => `${named(joint)} has not answered for ${joint.age.toFixed(1)}\u00a0s.`),
    ...(frame.emg.problem ? [`The muscles move nothing: ${ended(frame.emg.problem)}`] : []),
  ];
}

function hindrances(frame) {
  const limited = frame.joints.filter((joint) => joint.limited in LIMITS && joint.freshness === "fresh");
  const apart = frame.mode === "active" ? frame.joints.filter((joint) => joint.mode !== "active") : [];
  return [
    ...(frame.emg.paused ? ["The muscles are paused and move nothing."] : []),
    ...limited.map((joint) => `${named(joint)} ${LIMITS[joint.limited]}.`),
    ...apart.map((joint) => `${named(joint)} is ${joint.mode}.`),
  ];
}

function motion(frame) {
  const moving = frame.joints.filter((joint) => Math.abs(joint.velocity) >= MOVING);
  moving.sort((one, other) => rank(frame, one) - rank(frame, other));
  const going = goal(frame);
  if (!moving.length) return frame.mode === "active" ? [...going, still(frame)] : going;
  return [...moving.map(moves), ...going];
}

/** The joint that is attended to comes first; the others keep their order, so that lines do not jump. */
function rank(frame, joint) {
  return joint.name === attendedJoint(frame) ? -1 : frame.joints.indexOf(joint);
}

function moves(joint) {
  const by = joint.torque ? driverWord(joint.holder) : "with no torque";
  return `${named(joint)} is ${wayWord(joint.name, joint.velocity)} at ${speedWord(joint.velocity)}, ${by}.`;
}

function goal(frame) {
  if (!frame.goal || !["accepted", "moving"].includes(frame.goal.status)) return [];
  return [`The arm is on its way home: ${Math.round(frame.goal.progress * 100)}% done.`];
}

function still(frame) {
  const group = frame.groups.find((one) => one.operator) ?? frame.groups[0];
  if (!group) return "The arm is still.";
  if (group.together) return `The arm is still. ${sentence(listed(group.joints.map(words)))} are selected together.`;
  return `The arm is still. ${sentence(words(group.active))} is selected.`;
}

/** One sentence: the joint that is attended to, and those of its group that are expected elsewhere. */
function expecting(frame) {
  const expected = expectations(frame);
  const positions = new Map(frame.joints.map((joint) => [joint.name, joint.position]));
  const away = (name) => Math.abs((expected.get(name)?.position ?? NaN) - (positions.get(name) ?? NaN));
  const attended = attendedJoint(frame);
  const others = companions(frame, attended).filter((name) => away(name) > ELSEWHERE);
  const [first, ...rest] = [attended, ...others].filter((name) => expected.has(name));
  if (!first) return "";
  const along = rest.map((name) => `, ${words(name)} to go to ${angleWord(expected.get(name).position)}`);
  return `${expectation(first, away(first), expected.get(first))}${along.join("")}.`;
}

/** The other joints of the group that is attended to: what the same task moves. */
function companions(frame, attended) {
  const group = frame.groups.find((one) => one.joints.includes(attended));
  return group ? group.joints.filter((name) => name !== attended) : [];
}

function expectation(name, away, { position, seconds }) {
  const [deed, span] = away > ELSEWHERE ? ["go to", "within"] : ["stay at about", "for"];
  const subject = `${sentence(words(name))} is expected to ${deed}`;
  return `${subject} ${angleWord(position)} ${span} ${seconds.toFixed(1)}\u00a0s`;
}

function sureness(frame) {
  const expected = expectations(frame).get(attendedJoint(frame));
  if (!expected) return NOTHING;
  if (isNew(frame)) {
    return { word: "not sure", share: 0, text: "It is not sure: it has not learned enough here yet." };
  }
  if (expected.confidence === null) return unsaid(expected.error);
  const share = Math.min(Math.max(expected.confidence, 0), 1);
  const word = sureWord(share);
  return { word, share, text: `It is ${word} (${Math.round(share * 100)}%)${usual(expected.error)}.` };
}

function unsaid(error) {
  if (error === null) return { word: "not sure", share: null, text: "It has not learned enough yet to be sure." };
  return { word: "not measured", share: null, text: `Nobody measures how sure it is${usual(error)}.` };
}

/** How wrong it was so far: confidence is about being consistent, this about coming true. */
function usual(error) {
  if (error === null) return "";
  const size = angleWord(error).replace("+", "");
  return `${error > FAR_OFF ? ", though" : ";"} such predictions were off by about ${size} so far`;
}

function helping(frame) {
  const assists = [frame.assist, ...frame.more_assists].filter((assist) => assist.reason);
  return assists.map((assist) => ended(sentence(plain(assist.reason, frame)))).join(" ");
}

/** A reason with the joints' names as words. */
function plain(text, frame) {
  return frame.joints.reduce((known, joint) => known.replaceAll(joint.name, words(joint.name)), text);
}

function stopping(mode) {
  const now = mode === "limp" ? "It cannot move by itself now. " : "";
  return `${now}Press Escape or STOP: all joints stop.`;
}

function named(joint) {
  return sentence(words(joint.name));
}

/** The same with a full stop, if it has none. */
function ended(text) {
  return /[.!?]$/.test(text) ? text : `${text}.`;
}
