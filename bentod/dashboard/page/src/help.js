// Which keys do what.
import { el, section } from "./dom.js";

export function keysPanel(app) {
  const rows = [...app.keyboard.bindings].map(([letter, { description }]) =>
    el("div", { class: "key-row" }, el("dt", {}, el("kbd", { text: letter === " " ? "Space" : letter.toUpperCase() })), el("dd", { text: description })),
  );
  return section("Keys", el("dl", { class: "keys" }, ...rows));
}
