// @ts-check
/** What helps with each group: whether it does now and why, what it moves, its settings, and teaching it. */

import { AssistMode } from "./assist_mode.js";
import { settingsPart } from "./assist_settings.js";
import { shownMotions, stateWord, toldPairs } from "./assist_words.js";
import { button, el, say, section } from "./dom.js";
import { asking, atMost } from "./sparing.js";
import { degreesPerSecond, sentence, words } from "./units.js";
import "./assist.css";

const OFTEN = 2000; // ms between two questions for what an assist has found out
const CALM = 250; // ms between two changes of words: nobody reads faster

/** @returns {HTMLElement} */
export function assistPanel(app) {
  const element = el("div", { class: "assist" });
  let groups = null;
  const show = (frame) => {
    const told = helped(frame);
    const now = told.map((one) => one.group).join();
    if (now === groups) return;
    groups = now;
    element.replaceChildren(...(now ? told.map((one) => new AssistOf(app, one.group).element) : [nothing(told)]));
  };
  app.onFrame(show, { element });
  return element;
}

const helped = (frame) => [frame.assist, ...(frame.more_assists ?? [])];

function nothing([first]) {
  return section("Assist", el("p", { text: first?.reason || "Nothing helps with this arm." }), el("p", { class: "soft", text: "A table [assist] in the config gives a group an assist: see docs/assist.md." }));
}

/** The assist of one group. */
class AssistOf {
  engaged = false;

  constructor(app, group) {
    this.app = app;
    this.group = group;
    this.state = el("strong", { class: "assist-state", role: "status" });
    this.reason = el("p", { class: "assist-reason" });
    this.motions = el("ul", { class: "assist-motions", "aria-label": "What it moves now" });
    this.together = el("p", { class: "assist-together" });
    this.found = el("dl", { class: "health-facts assist-found" });
    this.mode = new AssistMode(app, group, (changes) => this.change(changes));
    this.settings = settingsPart(app, (changes) => this.change(changes));
    const more = el("details", {}, el("summary", { text: "What it has found out" }), this.found);
    const head = el("div", { class: "assist-head" }, this.mode.onOff, this.state);
    this.element = section(`Assist of ${words(group)}`, head, this.reason, this.motions, this.together, this.#teach(), this.mode.element, this.settings.element, more);
    this.ask = asking(app, this.element, () => OFTEN, () => ["assist_get", { group }], (told) => this.described(told));
    const draw = atMost(CALM, (frame) => this.show(frame));
    app.onFrame((frame) => (this.#of(frame)?.engaged === this.engaged ? draw(frame) : this.show(frame)), { element: this.element });
    app.onEvent((event) => event.kind === "assist" && event.data?.group === group && this.described(event.data));
    app.onRole(() => this.#offer());
  }

  #of(frame) {
    return helped(frame).find((one) => one.group === this.group);
  }

  async change(changes) {
    await this.app.act("assist_set", { ...changes, group: this.group });
    await this.ask();
  }

  described(told) {
    this.mode.show(told);
    this.settings.show(told, this.app.frame);
    const pairs = toldPairs(told.told ?? {});
    this.found.replaceChildren(...pairs.map(([name, value]) => el("div", {}, el("dt", { text: name }), el("dd", { text: value }))));
    this.found.parentElement.hidden = pairs.length === 0;
    this.#offer();
  }

  show(frame) {
    const told = this.#of(frame);
    if (!told) return;
    this.engaged = told.engaged;
    this.element.dataset.state = told.mode === "off" ? "off" : told.engaged ? "helps" : "waits";
    say(this.state, stateWord(told));
    say(this.reason, words(told.reason));
    this.#move(shownMotions(told.moving ?? {}, this.app.info));
    say(this.together, told.offers_together ? "All joints together may be selected now: toggle to it." : "");
  }

  #move(motions) {
    while (this.motions.children.length > motions.length) this.motions.lastChild.remove();
    while (this.motions.children.length < motions.length) this.motions.append(el("li", {}, el("span", {}), el("i", { class: "assist-bar", "aria-hidden": "true" }, el("i", {})), el("strong", {})));
    motions.forEach(({ joint, velocity, share }, place) => {
      const [name, bar, number] = this.motions.children[place].children;
      say(name, sentence(words(joint)));
      say(number, degreesPerSecond(velocity));
      bar.dataset.way = velocity < 0 ? "down" : "up";
      bar.style.setProperty("--share", String(share));
    });
    this.motions.hidden = !motions.length;
  }

  #teach() {
    const told = async (value, word) => {
      const answer = await this.app.act("reward", { value, group: this.group });
      if (answer !== undefined) this.app.say(`Told the arm: ${word}.`);
    };
    this.good = button("+ good", () => told(1, "good"), { class: "assist-good", title: "A reward of +1" });
    this.bad = button("− bad", () => told(-1, "bad"), { class: "assist-bad", title: "A reward of −1" });
    const label = el("span", { text: "How was that?" });
    return el("div", { class: "row", role: "group", "aria-label": "Teach by reward" }, label, this.good, this.bad);
  }

  #offer() {
    for (const one of [this.good, this.bad]) one.disabled = !this.app.can("reward");
    for (const one of this.element.querySelectorAll("input, select, .assist-switch")) one.disabled = !this.app.can("assist_set");
  }
}
