// @ts-check
/** The session: what is recorded, trials, marks, notes in every frame, and what happened. */

import { el } from "./dom.js";
import { eventsPart } from "./events.js";
import { marksPart } from "./session_marks.js";
import { metaPart } from "./session_meta.js";
import { recordingPart } from "./session_recording.js";
import { trialPart } from "./session_trial.js";
import "./session.css";

/** @returns {HTMLElement} */
export function sessionPanel(app) {
  const parts = [recordingPart(app), trialPart(app), marksPart(app), metaPart(app), eventsPart(app)];
  return el("div", { class: "session" }, ...parts);
}
