// @ts-check
/** What is predicted, how surely and how well: a chart of one question, and a table of all. */

import { el, section } from "./dom.js";
import { GvfTable } from "./learners_table.js";
import { OutcomeChart, gvfSubject } from "./outcome.js";
import { asking } from "./sparing.js";

const SECOND = 1000; // ms
const CHEAP = 30; // questions that may be asked for every second; more of them more rarely: it costs the daemon a part of a tick

/** @returns {HTMLElement} */
export function learnersPanel(app) {
  const chart = new OutcomeChart(app);
  const draw = (gvf) => {
    const subject = gvfSubject(gvf, app.frame, app.info?.joints);
    if (subject) chart.show(subject);
    chart.element.scrollIntoView({ block: "nearest" });
  };
  const table = new GvfTable(app, draw);
  const nothing = el("p", { class: "learners-nothing", hidden: true });
  const element = section("Learning", nothing, chart.element, table.element);
  let many = 0;
  const take = (gvfs) => {
    many = gvfs.length;
    table.take(gvfs);
    show("");
  };
  const show = (why) => {
    nothing.textContent = why && `Nothing is learned: ${why}`;
    nothing.hidden = !why;
    chart.element.hidden = table.element.hidden = Boolean(why);
  };
  const period = () => SECOND * Math.max(1, many / CHEAP);
  asking(app, element, period, () => ["gvf_list", {}], take, (error) => many || show(error.message));
  app.learners = { chart, table };
  return element;
}
