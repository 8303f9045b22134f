// The bar that is always in sight: what the arm is doing in a word, and how to stop it.
import { button, el, say } from "./dom.js";
import { homeButton } from "./home.js";
import "./header.css";

const WORDS = {
  limp: ["Limp", "no torque: gravity has the arm"],
  holding: ["Holding", "pinned where it is"],
  active: ["Active", "the arm obeys"],
  paused: ["Paused", "the arm holds still"],
  fault: ["Fault", "the arm has stopped"],
};
const LOST = { page: ["No page", "the page has lost its server"], daemon: ["No daemon", "nothing is known of the arm"] };

export function header(app) {
  const word = el("strong", { class: "mode-word" });
  const detail = el("span", { class: "mode-detail" });
  const mode = el("div", { class: "mode", role: "status" }, el("span", { class: "mode-mark", aria: { hidden: "true" } }), word, detail);
  const fault = el("div", { class: "fault", role: "alert", hidden: true });
  const bar = el("header", { class: "bar" }, names(app), mode, el("div", { class: "verbs" }, pauseButton(app), torqueButton(app), homeButton(app)), stopButton(app), fault);

  function show() {
    const { page, daemon } = app.linkState;
    const state = !page ? "lost" : !daemon ? "lost" : app.frame?.mode ?? "lost";
    const [name, meaning] = WORDS[state] ?? (page ? LOST.daemon : LOST.page);
    bar.dataset.mode = state;
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
  app.onRole(() => say(role, app.role === "operator" ? "operator" : "looking only"));
  return el("div", { class: "names" }, el("h1", { text: app.info?.arm ?? "bentod" }), role);
}

/** Never disabled, never asks back, and needs no role. */
function stopButton(app) {
  const stop = async () => {
    app.motion.releaseAll();
    try {
      await app.call("stop");
    } catch (error) {
      app.say(`STOP did not reach the arm: ${error.message} Cut its power.`, "error");
    }
  };
  app.key("Escape", "Stop the arm at once", stop);
  return button("STOP", stop, { class: "stop", id: "stop", title: "Stop every joint at once and pause (Escape)", "aria-keyshortcuts": "Escape" });
}

function pauseButton(app) {
  const toggle = () => app.act("pause", { on: app.frame?.mode === "active" });
  const element = button("Pause", toggle, { id: "pause" });
  app.key("p", "Pause, or release", toggle);
  app.onFrame((frame) => {
    const moving = frame.mode === "active";
    say(element, moving ? "Pause" : "Release");
    element.title = moving ? "Stop and hold, whatever the muscles say (P)" : "Let the arm obey again (P)";
    element.disabled = !app.can("pause") || !["active", "paused", "holding"].includes(frame.mode);
  });
  return element;
}

function torqueButton(app) {
  const element = button("Torque off", () => app.act("torque", { on: element.dataset.on !== "true" }), { id: "torque" });
  app.onFrame((frame) => {
    const on = frame.joints.some((joint) => joint.torque);
    element.dataset.on = on;
    say(element, on ? "Torque off" : "Torque on");
    element.title = on ? "Let every joint go limp: gravity takes the arm" : "Pin every joint where it hangs, and pause";
    element.disabled = !app.can("torque");
  });
  return element;
}
