// @ts-check
/** Marks: what an experimenter sees, at the moment of seeing it. */

import { button, el, section } from "./dom.js";

/** What the analysis knows ("contact" is a reward, too), and one for all else. */
const QUICK = ["contact", "circuit", "note"];

/** @returns {HTMLElement} */
export function marksPart(app) {
  const mark = async (text) => {
    const answer = await app.act("mark", { mark: text });
    if (answer !== undefined) app.say(answer ? `Marked in trial ${answer.trial}: ${text}` : `Marked: ${text}`);
    return answer !== undefined;
  };
  const quick = QUICK.map((text) => button(text, () => mark(text), { class: "session-mark", "aria-label": `Mark ${text}` }));
  const text = el("input", { type: "text", maxlength: 200, required: true, "aria-label": "Mark in your own words", placeholder: "in your own words" });
  const submit = el("button", { type: "submit", text: "Mark" });
  const form = el("form", { class: "row session-mark-form" }, text, submit);
  form.addEventListener("submit", async (event) => {
    event.preventDefault();
    if (await mark(text.value.trim())) text.value = "";
  });
  app.onRole(() => {
    for (const field of [...quick, text, submit]) field.disabled = !app.can("mark");
  });
  return section("Marks", el("div", { class: "row" }, ...quick), form);
}
