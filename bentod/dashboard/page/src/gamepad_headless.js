// @ts-check
// The joystick at the arm's own machine, as its daemon tells it: it drives without any browser.
import { el, say, section } from "./dom.js";

const LIMIT = "The arm's own joystick drives by itself, whether or not a page is open.";

/** @returns {HTMLElement} hidden where the config has no such table */
export function joystickPanel(app) {
  const [there, deadMan, own] = ["Joystick", "Dead man", "Its own pause"].map((title) => ({ title, value: el("dd", {}) }));
  const state = el("p", { class: "joystick-state", role: "status" });
  const facts = [there, deadMan, own].map(({ title, value }) => el("div", {}, el("dt", { text: title }), value));
  const element = section("The arm's own joystick", state, el("dl", { class: "gamepad-facts" }, ...facts), el("p", { class: "soft", text: LIMIT }));
  let button; // of the dead man: a number, false for none, undefined while that is not known
  const show = ({ joystick }) => {
    element.hidden = !joystick;
    if (!joystick) return;
    say(state, stateOf(joystick));
    say(there.value, joystick.connected ? "● plugged in" : "○ not plugged in");
    say(deadMan.value, deadManOf(joystick, button));
    say(own.value, joystick.paused ? "❚❚ paused by its own button" : "▶ not paused");
  };
  element.hidden = true;
  app.onFrame(show);
  if (app.can("joystick_get")) app.call("joystick_get").then((told) => (button = told?.dead_man), () => {});
  return element;
}

/** Why it moves nothing, or that it may. */
export function stateOf({ connected, paused, problem, held }) {
  if (!connected) return `○ ${absent(problem)}`;
  if (paused) return "❚❚ It is paused: it moves nothing.";
  if (problem) return `△ ${problem}`;
  return held ? "● It may drive." : "○ It moves nothing until its dead man is held.";
}

function absent(problem) {
  const [, device] = /^(\S+) cannot be opened: No such file/.exec(problem) ?? [];
  return device ? `No joystick at ${device}` : problem || "It is not plugged in.";
}

function deadManOf({ connected, held }, button) {
  if (!connected) return "–";
  if (button === false) return "not wanted by the config";
  const which = button === undefined ? "" : `: button ${button}`;
  return `${held ? "■ held" : "□ let go"}${which}`;
}
