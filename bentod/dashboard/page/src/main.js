// Builds the page. Read this first: what is where.
import "./style.css";
import { App } from "./app.js";
import { armView } from "./arm3d.js";
import { assistPanel } from "./assist.js";
import { el } from "./dom.js";
import { gamepadPanel } from "./gamepad.js";
import { groupsPanel } from "./groups.js";
import { header } from "./header.js";
import { healthPanel } from "./health.js";
import { keysPanel } from "./help.js";
import { jointsPanel } from "./joints.js";
import { joystickPanel } from "./gamepad_headless.js";
import { learnersPanel } from "./learners.js";
import { musclesPanel } from "./muscles.js";
import { nowPanel } from "./now.js";
import { replayPanel } from "./replay.js";
import { sessionPanel } from "./session.js";
import { signIn, takeToken } from "./signin.js";
import { soundsPanel } from "./sounds.js";
import { tabs } from "./tabs.js";
import { taskPanel } from "./task.js";
import { applyTheme, themeButton } from "./theme.js";

addEventListener("hashchange", () => location.reload()); // another token for the same tab
applyTheme();
const token = takeToken();
if (token) void start(token);
else document.body.replaceChildren(signIn(false));

async function start(token) {
  const app = new App(token);
  window.bentod = app;
  document.body.replaceChildren(el("main", { class: "waiting" }, el("p", { role: "status", text: "Looking for the daemon …" })), app.notices.element);
  app.onLink((state) => state.why === "token" && document.body.replaceChildren(signIn(true)));
  app.onLink(({ why }) => why && !["token", "silent"].includes(why) && app.say(why, "warning"));
  await app.ready;
  document.body.replaceChildren(header(app), el("main", { class: "layout" }, stage(app), side(app)), app.notices.element);
  performance.mark("shown");
}

/** Always in sight: the arm, and what it does in words. */
function stage(app) {
  return el("div", { class: "stage" }, nowPanel(app), armView(app));
}

function side(app) {
  const parts = [
    { id: "arm", label: "Joints", elements: [groupsPanel(app), jointsPanel(app)] },
    { id: "muscles", label: "Muscles", elements: app.info.emg ? [musclesPanel(app)] : [] },
    { id: "assist", label: "Assist", elements: [assistPanel(app)] },
    { id: "learning", label: "Learning", elements: [learnersPanel(app)] },
    { id: "task", label: "Task", elements: [taskPanel(app)] },
    { id: "session", label: "Session", elements: app.replaying ? [replayPanel(app), sessionPanel(app)] : [sessionPanel(app)] },
    { id: "health", label: "Health", elements: [healthPanel(app)] },
    { id: "controls", label: "Controls", elements: [joystickPanel(app), gamepadPanel(app), soundsPanel(app)] },
  ];
  const shown = tabs(parts.filter((part) => part.elements.length), app.setting("tab", "arm"));
  shown.element.querySelector("#page-controls").append(keysPanel(app), themeButton());
  return el("div", { class: "side" }, shown.element);
}
