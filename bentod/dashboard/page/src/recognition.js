// @ts-check
/** Recognition of contractions: what is decided now and how surely, collecting and training, the model in use. */

import { button, el, numberField, say } from "./dom.js";
import { percent, sentence, seconds, words } from "./units.js";
import "./recognition.css";

const TIMES = { hold_s: ["Hold", "s", 3, 0.5, 30], rest_s: ["Rest", "s", 3, 0.5, 30], repetitions: ["Of each class", "times", 1, 1, 50] };
const REST = "rest";

/** @returns {HTMLElement} hidden while the arm recognises nothing */
export function recognitionPart(app) {
  return new RecognitionPart(app).element;
}

class RecognitionPart {
  constructor(app) {
    this.app = app;
    this.rows = new Map();
    this.prompt = null;
    this.plan = app.setting("recognition.plan", {});
    this.decision = el("p", { class: "recognition-decision" });
    this.reason = el("p", { class: "recognition-reason" });
    this.list = el("ul", { class: "recognition-classes" });
    this.asked = el("p", { class: "recognition-asked", role: "status", hidden: true });
    this.model = el("p", { class: "soft" });
    this.came = el("p", { class: "recognition-came", role: "status" });
    this.train = button("Collect & train", () => this.#train(), { class: "primary", id: "recognition-train" });
    this.reset = button("Forget what was adapted", () => app.act("emg_reset"), { id: "recognition-reset" });
    this.collect = el("details", {}, el("summary", { text: "Collect and train" }), this.#fields(), this.came);
    this.element = el("div", { class: "recognition", hidden: true }, el("h3", { text: "Recognition" }), this.decision, this.reason, this.asked, this.list, this.model, this.collect);
    app.onFrame((frame) => this.show(frame.emg.recognition));
    app.onEvent((event) => event.kind === "emg" && this.#heard(event));
    app.onLink(({ daemon }) => daemon && this.#look());
    app.onRole(() => this.#allow());
  }

  show(told) {
    this.element.hidden = !told;
    if (!told) return;
    const surely = told.probabilities[told.label];
    const weight = told.weight > 0 ? `, ${percent(told.weight)} of it from predictions` : "";
    say(this.decision, told.index < 0 ? (this.untrained ? "Train first: collect one contraction after the other" : "Nothing is recognised yet") : `${told.label === REST ? "◦" : "▸"} ${sentence(words(told.label))}${surely === undefined ? "" : `, ${percent(surely)} sure`}${weight}`);
    say(this.reason, told.reason || (told.rejected ? `Not sure enough: most likely ${words(told.likely)}` : ""));
    this.#bars(told);
    this.#prompted(told.prompted);
  }

  #bars(told) {
    const names = Object.keys(told.probabilities);
    if (names.some((name) => !this.rows.has(name)) || names.length !== this.rows.size) this.#build(names);
    for (const [name, { element, meter, word }] of this.rows) {
      const share = told.probabilities[name];
      meter.value = share;
      say(word, percent(share));
      element.classList.toggle("recognition-decided", name === told.label);
    }
  }

  #build(names) {
    this.rows = new Map(names.map((name) => [name, classRow(name, this.moves?.get(name))]));
    this.list.replaceChildren(...[...this.rows.values()].map((row) => row.element));
  }

  /** What a collection asks for, with the time that is left of it. */
  #prompted(label) {
    this.asked.hidden = !label && !this.collecting;
    if (!label) return;
    const { seconds: length, of, repetition, at } = this.prompt?.prompt === label ? this.prompt : {};
    const left = length === undefined ? "" : ` ${seconds(Math.max(Math.ceil(length - (performance.now() - at) / 1000), 0))}`;
    const count = repetition ? `, ${repetition} of ${of}` : "";
    say(this.asked, label === REST ? `◦ Rest${left}` : `▸ Now: ${words(label)}${left}${count}`);
  }

  #heard({ data, text }) {
    if (data.prompt) this.prompt = { ...data, at: performance.now() };
    if (data.collection) {
      this.prompt = null;
      say(this.came, text);
    }
    if (data.collection || data.model) void this.#look();
  }

  async #look() {
    const told = this.app.can("emg_classes") ? await this.app.call("emg_classes").catch(() => null) : null;
    if (!told) return;
    this.moves = new Map(told.classes.map(({ name, moves }) => [name, moves]));
    this.rows.clear();
    const { model, models } = told;
    if (!model && !this.untrained) this.collect.setAttribute("open", "");
    this.untrained = !model;
    say(this.model, model ? `Model in use: ${model.name} (${model.classifier}). There are: ${models.join(", ") || "none"}.` : "");
    this.adapts = told.adaptation !== null;
    this.#allow();
  }

  #allow() {
    this.train.disabled = !this.app.can("emg_retrain") || Boolean(this.collecting);
    this.reset.hidden = !this.adapts;
    this.reset.disabled = !this.app.can("emg_reset");
  }

  #fields() {
    const fields = Object.entries(TIMES).map(([key, [label, unit, usual, min, max]]) => {
      const keep = (value) => this.plan.set({ ...this.plan.get(), [key]: value });
      const field = numberField(label, unit, { value: this.plan.get()[key] ?? usual, min, max, step: key === "repetitions" ? 1 : "any" }, keep);
      field.input.id = `recognition-${key}`;
      return field;
    });
    const told = "The page asks for one contraction after the other; the muscles move nothing meanwhile. STOP or Pause ends it, and so does closing the page.";
    return el("div", {}, el("p", { class: "soft", text: told }), el("div", { class: "row" }, ...fields, this.train, this.reset));
  }

  async #train() {
    const usual = Object.fromEntries(Object.entries(TIMES).map(([key, one]) => [key, one[2]]));
    this.collecting = true;
    this.#allow();
    say(this.came, "");
    const told = await this.app.act("emg_retrain", { ...usual, ...this.plan.get() });
    this.collecting = false;
    if (told) say(this.came, outcome(told));
    void this.#look();
    this.#allow();
  }
}

/** How well classes are told apart, in a sentence or two. */
function outcome({ collected, trained }) {
  const { accuracy } = trained;
  const told = typeof accuracy === "number" ? `✓ Trained and in use; each repetition by the others: ${percent(accuracy, 1)} right.` : "✓ Trained and in use. There is only one repetition: nothing says how well another would be recognised.";
  return [told, ...(collected.warnings ?? []).map((one) => `⚠ ${one}`)].join(" ");
}

function classRow(name, moves) {
  const meter = el("meter", { min: 0, max: 1, value: 0, "aria-label": `Probability of ${words(name)}` });
  const word = el("span", { class: "recognition-share" });
  const told = moves ? Object.entries(moves).map(([joint, share]) => `${words(joint)} ${share > 0 ? "+" : "−"}${percent(Math.abs(share))}`) : [];
  const label = el("span", { class: "recognition-name" }, words(name), el("small", { text: told.length ? ` moves ${told.join(", ")}` : "" }));
  return { meter, word, element: el("li", {}, label, meter, word) };
}
