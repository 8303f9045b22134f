// Sound in the page: the same words and tones as `bentod voice`, and the quiet tone of the selected joint.
import "./sounds.css";
import { button, el, say, section } from "./dom.js";
import { SoundBoard, note } from "./soundboard.js";
import { Cues, glance, rehearse, told } from "./soundcues.js";
import { percent, sentence, words } from "./units.js";

const CHECK_MS = 600; // without a frame, the quiet tone ends after this

export function soundsPanel(app) {
  const voice = app.info.voice ?? {};
  const board = new SoundBoard(app);
  const settings = { on: app.setting("sound.on", false), volume: app.setting("sound.volume", 0.8), cue: app.setting("sound.cue", voice.cue === "tone") };
  const status = el("p", { class: "sounds-status", role: "status" });
  const last = el("p", { class: "sounds-last soft", text: "Nothing has been said yet." });
  const cues = listen(app, board, settings, voice, (events) => say(last, `Last: ${events.map(label).join(", then ")}.`));
  app.sound = (event) => void board.play([event]);
  app.sounds = { board, rehearse, note };
  const refresh = () => say(status, state(board, settings, voice));
  const panel = section("Sounds", status, controls(app, board, settings, voice, () => (refresh(), cues.hum())), last, catalogue(app, board));
  wakeOnGesture(board, settings, voice, refresh);
  refresh();
  return panel;
}

/** "joint.elbow_flexion" → "Joint: elbow flexion". */
const label = (event) => sentence(words(event.replace("emg.", "EMG: ").replace(".", ": ")));

function state(board, settings, voice) {
  if (voice.enabled === false) return "Sound is off in the config of the arm.";
  if (board.on) return "Sound is on.";
  return settings.on.get() ? "Sound is on as soon as you click or press a key." : "Sound is off.";
}

/** Frames and events become sounds; returns what brings the quiet tone up to date. */
function listen(app, board, settings, voice, spoke) {
  const cues = new Cues();
  const seconds = () => performance.now() / 1000;
  const names = [...app.info.joints.map((joint) => joint.name), "together"];
  let timer = 0;
  const tell = () => {
    const events = cues.due(seconds());
    if (!events.length || voice.enabled === false || !board.on) return;
    void board.play(events);
    spoke(events);
  };
  const hum = () => {
    const index = names.indexOf(document.hidden ? "" : cues.selected(seconds()));
    board.hum(index < 0 || !settings.cue.get() ? 0 : note(index), voice.cue_volume ?? 0.03);
  };
  app.onTick((frame) => {
    cues.frame(seconds(), glance(frame));
    tell();
    hum();
    clearTimeout(timer);
    timer = setTimeout(hum, CHECK_MS);
  });
  app.onEvent((event) => {
    cues.event(seconds(), told(event));
    tell();
  });
  app.onLink((link) => {
    if (link.daemon) return;
    cues.lost();
    hum();
  });
  document.addEventListener("visibilitychange", hum);
  return { hum };
}

function controls(app, board, settings, voice, changed) {
  const off = voice.enabled === false;
  const toggle = switchButton("Sound", settings.on, off, (on) => {
    if (on) board.start(settings.volume.get());
    else void board.stop();
    changed();
  });
  const cue = switchButton("Quiet tone of the selected joint", settings.cue, off, changed);
  const shown = el("output", { class: "sounds-volume", text: percent(settings.volume.get()) });
  const slider = el("input", { type: "range", min: 0, max: 1, step: 0.05, value: settings.volume.get(), disabled: off });
  slider.addEventListener("input", () => {
    settings.volume.set(Number(slider.value));
    board.volume(Number(slider.value));
    say(shown, percent(Number(slider.value)));
  });
  return el("div", { class: "sounds-controls" }, toggle, cue, el("label", { class: "field" }, el("span", { text: "Volume" }), slider, shown));
}

function switchButton(name, setting, disabled, changed) {
  const made = button(`${name}: ${setting.get() ? "on" : "off"}`, () => {
    const on = !setting.get();
    setting.set(on);
    made.setAttribute("aria-pressed", String(on));
    say(made, `${name}: ${on ? "on" : "off"}`);
    changed(on);
  }, { "aria-pressed": String(setting.get()), disabled });
  return made;
}

/** A page that was heard before is heard again, but no browser lets it be before it is touched. */
function wakeOnGesture(board, settings, voice, refresh) {
  const wake = () => {
    document.removeEventListener("pointerdown", wake, true);
    document.removeEventListener("keydown", wake, true);
    if (voice.enabled !== false && settings.on.get()) board.start(settings.volume.get());
    refresh();
  };
  document.addEventListener("pointerdown", wake, true);
  document.addEventListener("keydown", wake, true);
}

/** Every sound with a button to try it; fetched when it is first looked at. */
function catalogue(app, board) {
  const list = el("ul", { class: "sounds-list" });
  const details = el("details", {}, el("summary", { text: "Try the sounds" }), list);
  details.addEventListener("toggle", async () => {
    if (!details.open || list.childElementCount) return;
    const names = await board.names().catch((error) => void app.say(error.message, "warning"));
    list.replaceChildren(...Object.keys(names ?? {}).map((event) => entry(app, board, event)));
  });
  return details;
}

function entry(app, board, event) {
  const play = button("Play", () => (board.on ? void board.play([event]) : app.say("Switch sound on first.")), { "aria-label": `Play ${label(event)}` });
  return el("li", { data: { event } }, el("span", { text: label(event) }), play);
}
