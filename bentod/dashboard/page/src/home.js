// Going home: asked for once, leased for as long as the page is seen, with progress and a way to end it.
import { button, say } from "./dom.js";
import { guard, whileKnown } from "./known.js";

const KEY = "home";
const RUNNING = new Set(["accepted", "moving"]);

export function homeButton(app) {
  let before = null; // number of the goal that had ended before this page asked for one
  const asking = () => app.motion.keys.includes(KEY);
  const turned = guard();
  const toggle = () => {
    if (running(app.frame)) return end();
    if (!turned.settled()) return undefined;
    before = app.frame?.goal?.id ?? null;
    return app.hold(KEY, "go_home", { joints: null }, undefined, true);
  };
  const end = () => (asking() ? app.release(KEY) : app.act("go_home_cancel"));
  const element = button("Home", toggle, { id: "home" });
  app.onFrame((frame) => {
    const goal = frame.goal;
    turned.see(running(frame));
    if (asking() && goal && goal.id !== before && !RUNNING.has(goal.status)) over(app, goal);
    say(element, running(frame) ? `Cancel home ${Math.round(goal.progress * 100)} %` : "Home");
    element.title = running(frame) ? "End going home, and hold" : "Send every joint home (for as long as this page is open)";
  });
  whileKnown(app, element, () => app.can("go_home"));
  return element;
}

const running = (frame) => Boolean(frame?.goal && RUNNING.has(frame.goal.status));

function over(app, goal) {
  app.motion.forget(KEY);
  const advice = app.frame.mode === "active" ? " Pause first, and nobody disturbs it." : "";
  if (goal.status === "cancelled") app.say(`Going home was ended: ${goal.reason}.${advice}`, "warning");
}
