// The gamepad at this browser, live: what each axis and button is for, and whether it counts.
import "./gamepad.css";
import { button, el, say, section } from "./dom.js";
import { Drive } from "./gamepad_drive.js";
import { buttonName, usual } from "./padmapping.js";
import { percent, sentence, words } from "./units.js";

const MEANINGS = {
  toggle: "next joint of",
  toggle_back: "previous joint of",
  pause: "pause",
  release: "release",
  torque: "torque",
  home: "go home, held",
  stop: "stop",
  own_pause: "pause or release this gamepad",
  mark: "mark",
};

/** @param {any} app */
export function gamepadPanel(app) {
  const status = el("p", { class: "gamepad-status", role: "status", text: "No gamepad yet. Press any of its buttons." });
  const deadMan = el("p", { class: "gamepad-deadman" });
  const own = button("Pause the gamepad", () => drive.pause(!drive.paused), { class: "gamepad-own", "aria-pressed": "false" });
  const rows = el("div", { class: "gamepad-rows" });
  const choice = el("div", { class: "row" });
  const panel = section("Gamepad", status, deadMan, el("div", { class: "row" }, own, choice), rows);
  let view = null;
  let look = null;

  const drive = new Drive(app, usual(Object.keys(app.info.groups)), (seen) => {
    look = seen;
    if (panel.offsetParent !== null) draw();
  });
  const use = (mapping) => {
    drive.use(mapping);
    view = mappingView(mapping);
    rows.replaceChildren(view.element);
    draw();
  };
  const draw = () => {
    say(status, statusOf(look));
    say(deadMan, deadManOf(drive.mapping.dead_man, look));
    deadMan.classList.toggle("gamepad-held", Boolean(look?.held));
    say(own, drive.paused ? "Release the gamepad" : "Pause the gamepad");
    own.setAttribute("aria-pressed", String(drive.paused));
    view.show(look);
  };

  use(drive.mapping);
  offerTheConfigs(app, choice, use);
  if (app.frame?.joystick?.connected) drive.pause(true); // else one pad might drive twice
  draw();
  return Object.assign(panel, { drive });
}

/** The mapping of the daemon's own joystick serves here, too, where its config has one. */
async function offerTheConfigs(app, place, use) {
  const told = app.can("joystick_get") ? await app.call("joystick_get").catch(() => null) : null;
  if (!told) return;
  const chosen = app.setting("gamepad.mapping", "config");
  const select = el("select", { id: "gamepad-mapping" });
  for (const [value, text] of [["config", "as in the arm's config"], ["usual", "usual for a gamepad"]]) {
    select.append(el("option", { value, text }));
  }
  const apply = () => {
    chosen.set(select.value);
    use(select.value === "config" ? told : usual(Object.keys(app.info.groups)));
  };
  select.value = chosen.get();
  select.addEventListener("change", apply);
  place.append(el("label", { class: "field", for: "gamepad-mapping" }, el("span", { text: "Mapping" }), select));
  place.append(el("p", { class: "soft", text: "Browsers and Linux may number the same pad differently: try before you trust." }));
  apply();
}

function mappingView(mapping) {
  const axes = mapping.axes.map(axisRow);
  const buttons = mapping.buttons.map(buttonRow);
  const element = el(
    "div",
    { class: "gamepad-tables" },
    el("ul", { class: "gamepad-list", aria: { label: "Axes" } }, ...axes.map((row) => row.element)),
    el("ul", { class: "gamepad-list", aria: { label: "Buttons" } }, ...buttons.map((row) => row.element)),
  );
  const show = (look) => {
    axes.forEach((row, place) => row.show(look?.shaped[place] ?? 0, look?.asked[place] ?? 0));
    buttons.forEach((row) => row.show(look?.buttons[row.number] ?? false, look?.standard));
  };
  return { element, show };
}

function axisRow(axis) {
  const mark = el("span", { class: "gamepad-mark" });
  const value = el("span", { class: "gamepad-value", text: percent(0) });
  const counts = el("span", { class: "gamepad-counts soft", text: "" });
  const name = `Axis ${axis.axis}: ${words(axis.group ? `group ${axis.group}` : axis.joint)}`;
  const bar = el("span", { class: "gamepad-bar", aria: { hidden: "true" } }, mark);
  const element = el("li", { class: "gamepad-row" }, el("span", { class: "gamepad-name", text: name }), bar, value, counts);
  const show = (shaped, asked) => {
    mark.style.setProperty("--gamepad-at", String(shaped));
    say(value, percent(shaped));
    say(counts, asked ? "moves" : shaped ? "asks in vain" : "at rest");
  };
  return { element, show };
}

function buttonRow(mapped) {
  const state = el("span", { class: "gamepad-value", text: "○ up" });
  const about = [MEANINGS[mapped.action], mapped.group ?? mapped.joint, mapped.mark && `“${mapped.mark}”`];
  if (mapped.action === "torque") about.push(mapped.on ? "on" : "off");
  const meaning = words(about.filter(Boolean).join(" "));
  const name = el("span", { class: "gamepad-name" });
  const element = el("li", { class: "gamepad-row" }, name, state);
  const show = (down, standard) => {
    say(name, `${sentence(buttonName(mapped.button, standard))}: ${meaning}`);
    say(state, down ? "● down" : "○ up");
  };
  return { element, number: mapped.button, show };
}

function statusOf(look) {
  if (!look) return "No gamepad yet. Press any of its buttons.";
  if (look.paused) return `${look.name} is paused: it moves nothing; stop and pause work.`;
  return look.why || `${look.name} may drive.`;
}

function deadManOf(number, look) {
  if (number === false) return "No dead man's button: axes move the arm at once.";
  const name = buttonName(number, look?.standard);
  if (!look?.held) return `□ Hold the ${name} to move anything.`;
  const counts = !look.why && !look.paused;
  return counts ? `■ The ${name} is held: axes move the arm.` : `■ The ${name} is held, but nothing moves.`;
}
