// @ts-check
/** How the arm and its daemon are: what is wrong and what to do, timing, servos, and who is connected. */

import { clientsPart } from "./clients.js";
import { el } from "./dom.js";
import { faultsPart } from "./health_faults.js";
import { practicePart } from "./health_practice.js";
import { servosPart } from "./health_servos.js";
import { timingPart } from "./health_timing.js";
import "./health.css";

/** @returns {HTMLElement} */
export function healthPanel(app) {
  const parts = [faultsPart, timingPart, servosPart, clientsPart];
  if (app.info?.faults?.length) parts.push(practicePart);
  return el("div", { class: "health" }, ...parts.map((part) => part(app)));
}
