// The bar that is always in sight: what the arm is doing in a word, and how to stop it.
import { button, el, say } from "./dom.js";
import { homeButton } from "./home.js";
import { SURE, guard, twice, whileKnown } from "./known.js";
import "./header.css";

const WORDS = {
  limp: ["Limp", "no torque: gravity has the arm"],
  holding: ["Holding", "pinned where it is"],
  active: ["Active", "the arm obeys"],
  paused: ["Paused", "the arm holds still"],
  fault: ["Fault", "the arm has stopped"],
};
const LOST = {
  page: ["No server", "the page has lost it: nothing is known of the arm"],
  daemon: ["No daemon", "nothing is known of the arm"],
  silent: ["Nothing heard", "for more than a second: what is shown is old"],
};
const REPLAY = ["Replay", "a recording: no arm moves"];
const ANSWER = 500; // ms in which STOP is answered

export function header(app) {
  const word = el("strong", { class: "mode-word" });
  const detail = el("span", { class: "mode-detail" });
  const mode = el("div", { class: "mode", role: "status" }, el("span", { class: "mode-mark", aria: { hidden: "true" } }), word, detail);
  const fault = el("div", { class: "fault", role: "alert", hidden: true });
  const bar = el("header", { class: "bar" }, names(app), mode, el("div", { class: "verbs" }, pauseButton(app), torqueButton(app), homeButton(app)), stopButton(app), fault);

  function show() {
    const { page, daemon, why } = app.linkState;
    const state = daemon ? (app.frame?.mode ?? "lost") : "lost";
    const lost = LOST[!page ? "page" : why === "silent" ? "silent" : "daemon"];
    const [name, meaning] = app.replaying && daemon ? REPLAY : (WORDS[state] ?? lost);
    bar.dataset.mode = app.replaying && daemon ? "replay" : state;
    say(word, name);
    say(detail, meaning);
    say(fault, state === "fault" ? app.frame.fault : "");
    fault.hidden = state !== "fault";
  }
  app.onFrame(show);
  app.onLink(show);
  return bar;
}

function names(app) {
  const role = el("span", { class: "role" });
  app.onRole(() => say(role, app.replaying ? "a recording" : app.role === "operator" ? "operator" : "looking only"));
  return el("div", { class: "names" }, el("h1", { text: app.info?.arm ?? "bentod" }), role);
}

/** Never disabled, never asks back, and needs no role. */
function stopButton(app) {
  const stop = async () => {
    app.motion.releaseAll();
    if (app.replaying) return app.say("This is a recording: no arm moves.", "info");
    const late = setTimeout(() => app.say("STOP has not been answered yet. If the arm moves, cut its power.", "error"), ANSWER);
    try {
      await app.call("stop");
    } catch (error) {
      app.say(`STOP did not reach the arm: ${error.message} Cut its power.`, "error");
    } finally {
      clearTimeout(late);
    }
  };
  app.key("Escape", "Stop the arm at once", stop);
  return button("STOP", stop, { class: "stop", id: "stop", title: "Stop every joint at once and pause (Escape)", "aria-keyshortcuts": "Escape" });
}

function pauseButton(app) {
  const turned = guard();
  const toggle = () => {
    const moving = app.frame?.mode === "active";
    if (moving || turned.settled()) app.act("pause", { on: moving });
  };
  const element = button("Pause", toggle, { id: "pause" });
  app.key("p", "Pause", () => app.act("pause", { on: true }));
  app.onFrame((frame) => {
    const moving = frame.mode === "active";
    turned.see(moving);
    say(element, moving ? "Pause" : "Release");
    element.title = moving ? "Stop and hold, whatever the muscles say (P)" : "Let the arm obey again";
  });
  whileKnown(app, element, () => app.can("pause") && ["active", "paused", "holding"].includes(app.frame?.mode));
  return element;
}

/** An arm that goes limp falls, so that takes two presses. */
function torqueButton(app) {
  let on = true;
  const sure = twice();
  const name = () => say(element, !on ? "Torque on" : sure.armed() ? "It may fall: press again" : "Torque off");
  const press = () => {
    if (!on || sure.press()) app.act("torque", { on: !on });
    else setTimeout(name, SURE);
    name();
  };
  const element = button("Torque off", press, { id: "torque" });
  app.onFrame((frame) => {
    on = frame.joints.some((joint) => joint.torque);
    if (!on) sure.clear();
    name();
    element.title = on ? "Let every joint go limp: gravity takes the arm" : "Pin every joint where it hangs, and pause";
  });
  whileKnown(app, element, () => app.can("torque"));
  return element;
}
