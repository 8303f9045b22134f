// @ts-check
/** Muscles: whether they drive the arm, what every electrode gives, what it is set to, and how that is found. */

import { calibrationPart } from "./calibration.js";
import { button, el, say, section } from "./dom.js";
import { guard } from "./known.js";
import { MuscleCharts } from "./muscles_charts.js";
import { recognitionPart } from "./recognition.js";
import { SiteSettings } from "./sites_settings.js";
import { number, seconds } from "./units.js";
import "./muscles.css";

/** @returns {HTMLElement} */
export function musclesPanel(app) {
  const settings = new SiteSettings(app);
  const charts = new MuscleCharts(app, settings);
  const state = el("p", { class: "muscles-state", role: "status" });
  const problem = el("p", { class: "muscles-problem muscles-fine", role: "alert" });
  const facts = el("p", { class: "muscles-facts" });
  const drive = driveButton(app);
  const recognition = app.can("emg_classes") ? [recognitionPart(app)] : [];
  const panel = section("Muscles", el("div", { class: "muscles-head" }, state, drive.element), problem, facts, calibrationPart(app, settings, charts), ...recognition, charts.element);
  panel.classList.add("muscles");

  function show(frame) {
    const { emg } = frame;
    drive.show(emg.paused);
    say(state, stateWords(emg));
    panel.dataset.state = emg.paused ? "paused" : emg.alive ? "driving" : "lost";
    say(problem, emg.problem);
    problem.classList.toggle("muscles-fine", !emg.problem);
    say(facts, factWords(emg, settings.rate, charts.missing));
  }
  app.onFrame(show, { element: panel });
  return Object.assign(panel, { charts });
}

function stateWords({ paused, alive }) {
  if (paused) return "❚❚ Paused: the muscles move nothing";
  return alive ? "▶ The muscles drive the arm" : "✖ No muscles are heard";
}

function factWords(emg, rate, missing) {
  const told = [`${emg.toggles} toggle${emg.toggles === 1 ? "" : "s"}`, `${emg.dropped} samples lost`];
  if (missing > emg.dropped) told.push(`${missing} not shown`);
  told.push(`newest ${seconds(Math.min(emg.age, 999))} old`, number(rate, 0, "Hz"));
  return told.join(" · ");
}

/** Big, because it is what one looks for when the arm does what was not meant. */
function driveButton(app) {
  let paused = null;
  const turned = guard();
  function press() {
    if (paused && !turned.settled()) return;
    void app.act("emg_pause", { on: !paused });
  }
  const element = button("❚❚ Pause the muscles", press, { class: "muscles-drive", id: "muscles-drive", "aria-keyshortcuts": "m" });
  app.key("m", "Pause the muscles, or let them drive", () => element.disabled || press());
  function show(now) {
    turned.see(now);
    paused = now;
    say(element, paused ? "▶ Let the muscles drive" : "❚❚ Pause the muscles");
    element.title = paused ? "They drive again once they have been at rest (M)" : "They move nothing; everything else goes on (M)";
    element.disabled = !app.can("emg_pause");
  }
  return { element, show };
}
