// @ts-check
// The circuits of a run: how long each took, leg by leg, and how often a wall was touched.
import { el } from "./dom.js";
import { remarks } from "./task_words.js";
import { degrees, number, seconds } from "./units.js";

const cell = (text) => el("td", { class: "number", text });

/** @param {any} task @param {any[]} laps as the server tells them */
export function lapTable(task, laps) {
  const names = task.order.slice(1).map((index) => task.places[index].name);
  const wide = names.length <= 6;
  const heads = ["Circuit", "Time", ...(wide ? names.map((name) => `to ${name}`) : []), "Contacts", "Way", "Remarks"];
  const head = el("tr", {}, ...heads.map((text) => el("th", { scope: "col", text })));
  const rows = [...laps].reverse().map((lap) => lapRow(lap, wide ? names.length : 0));
  const caption = el("caption", { class: "visually-hidden", text: "Circuits of this run, the newest first" });
  return el("table", { class: "task-laps" }, caption, el("thead", {}, head), el("tbody", {}, ...rows));
}

/** Means over the circuits in words; empty without any. */
export function summary(laps) {
  if (!laps.length) return "";
  const mean = (key) => laps.reduce((all, lap) => all + lap[key], 0) / laps.length;
  const best = Math.min(...laps.map((lap) => lap.time));
  return `${laps.length} ${laps.length === 1 ? "circuit" : "circuits"}: mean ${seconds(mean("time"))}, best ${seconds(best)}, ${number(mean("contacts"), 1)} contacts each.`;
}

function lapRow(lap, legs) {
  const times = Array.from({ length: legs }, (_, leg) => cell(leg in lap.legs ? seconds(lap.legs[leg]) : "–"));
  const first = el("th", { scope: "row", text: String(lap.number) });
  const way = degrees(lap.length, 0).replace("+", "");
  return el("tr", {}, first, cell(seconds(lap.time)), ...times, cell(String(lap.contacts)), cell(way), el("td", { text: remarks(lap) }));
}
