/** What the arm does, why, what it expects, how sure it is, and how to stop it: pure, from one frame. */

import { alarms, hindrances, isFresh } from "./sentences_alarms.js";
import { attendedJoint, expectations } from "./sentences_expected.js";
import { NOTHING, sureness } from "./sentences_sure.js";
import { USUAL, noHelp, stopping, waiting } from "./sentences_waiting.js";
import { angleWord, driverWord, ended, listed, nameWord, speedWord, wayWord } from "./sentences_words.js";
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

/** rad/s from which on nothing is said to stay. */
const LEAVING = (5 * Math.PI) / 180;

const SILENT = { word: "not known", share: null, text: "" };

/**
 * The story of one frame.
 * @param {object | null} frame as get_state gives it; null: none has come yet
 * @param {import("./sentences_waiting.js").Around} [around] what it does not tell
 * @returns {Story}
 */
export function sentences(frame, around = {}) {
  const known = { ...USUAL, ...around };
  const stop = stopping(frame?.mode ?? "", known);
  if (known.lost) return { ...story(known.lost), sure: SILENT, stop };
  if (!frame) return { ...story("Waiting for the arm."), stop };
  return { ...telling(frame, known), stop };
}

function telling(frame, around) {
  const { headline, todo } = waiting(frame, around);
  const doing = [
    ...alarms(frame, around.muscles),
    ...motion(frame),
    ...hindrances(frame, around.muscles),
  ];
  return {
    ...story(headline || doing.shift() || "The arm is active.", todo),
    doing,
    expects: expecting(frame),
    sure: sureness(frame),
    help: noHelp(frame.mode) || helping(frame),
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

function motion(frame) {
  const moving = frame.joints.filter((joint) => isFresh(joint) && Math.abs(joint.velocity) >= MOVING);
  moving.sort((one, other) => rank(frame, one) - rank(frame, other));
  const going = goal(frame);
  if (!moving.length) return isQuiet(frame) ? [...going, still(frame)] : going;
  return [...moving.map(moves), ...going];
}

/** Whether it is known that nothing moves. */
function isQuiet(frame) {
  return frame.mode === "active" && frame.joints.every(isFresh);
}

/** The joint that is attended to comes first; the others keep their order, so that lines do not jump. */
function rank(frame, joint) {
  return joint.name === attendedJoint(frame) ? -1 : frame.joints.indexOf(joint);
}

function moves(joint) {
  const by = joint.torque ? driverWord(joint.holder) : "with no torque";
  return `${nameWord(joint.name)} is ${wayWord(joint.name, joint.velocity)} at ${speedWord(joint.velocity)}, ${by}.`;
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
  const joints = new Map(frame.joints.map((joint) => [joint.name, joint]));
  const away = (name) => Math.abs((expected.get(name)?.position ?? NaN) - (joints.get(name)?.position ?? NaN));
  const attended = attendedJoint(frame);
  const others = companions(frame, attended).filter((name) => away(name) > ELSEWHERE);
  const [first, ...rest] = [attended, ...others].filter((name) => expected.has(name));
  if (!first) return "";
  const along = rest.map((name) => `, ${words(name)} to go to ${angleWord(expected.get(name).position)}`);
  return `${expectation(joints.get(first), away(first), expected.get(first))}${along.join("")}.`;
}

/** The other joints of the group that is attended to: what the same task moves. */
function companions(frame, attended) {
  const group = frame.groups.find((one) => one.joints.includes(attended));
  return group ? group.joints.filter((name) => name !== attended) : [];
}

function expectation({ name, velocity }, away, { position, seconds }) {
  const [deed, span] = deedWords(away, velocity);
  const subject = `${nameWord(name)} is expected to ${deed}`;
  return `${subject} ${angleWord(position)} ${span} ${seconds.toFixed(1)}\u00a0s`;
}

function deedWords(away, velocity) {
  if (away > ELSEWHERE) return ["go to", "within"];
  return Math.abs(velocity) > LEAVING ? ["be at about", "within"] : ["stay at about", "for"];
}

function helping(frame) {
  const assists = [frame.assist, ...frame.more_assists].filter((assist) => assist.reason);
  return assists.map((assist) => ended(sentence(plain(assist.reason, frame)))).join(" ");
}

/** A reason with the joints' names as words. */
function plain(text, frame) {
  return frame.joints.reduce((known, joint) => known.replaceAll(joint.name, words(joint.name)), text);
}
