/** One row for each joint: where it is, what it does, who moves it, and what may be done with it. */

import { el, say, section } from "./dom.js";
import { JointActions } from "./joints_actions.js";
import { JointBar, rangesOf } from "./joints_bar.js";
import { silence } from "./sentences_alarms.js";
import { attendedJoint, expectations } from "./sentences_expected.js";
import { UNKNOWN, jointWords } from "./joints_words.js";
import { degrees, sentence, words } from "./units.js";
import "./joints.css";

/** @returns {HTMLElement} */
export function jointsPanel(app) {
  const panel = new JointsPanel(app);
  app.onFrame((frame) => panel.show(frame), { element: panel.element });
  app.onRole(() => panel.rebuild());
  app.onLink(() => panel.show(app.frame));
  return panel.element;
}

class JointsPanel {
  /** @type {Map<string, Row>} */ rows = new Map();
  info = null;

  constructor(app) {
    this.app = app;
    this.share = app.setting("joints.jog", 25);
    this.notice = el("p", { class: "joints-notice joints-warning", hidden: true });
    this.list = el("ul", { class: "joints-rows" });
    this.element = section("Joints", this.#speed(), this.notice, this.list);
    this.element.classList.add("joints");
  }

  /** Begin anew with the next frame: other joints, other limits, or another role. */
  rebuild() {
    this.rows.clear();
    this.show(this.app.frame);
  }

  show(frame) {
    if (!frame) return;
    const names = frame.joints.map((joint) => joint.name);
    if (this.info !== this.app.info || names.join() !== [...this.rows.keys()].join()) this.#build(names);
    const expected = expectations(frame);
    const attended = attendedJoint(frame);
    const quiet = this.#announce(frame);
    for (const joint of frame.joints) {
      const row = this.rows.get(joint.name);
      if (this.app.linkState.daemon) row.show(joint, expected.get(joint.name)?.position, joint.name === attended, quiet);
      else row.forget();
    }
  }

  /** What is wrong with all joints is told once; returns whether it was. */
  #announce(frame) {
    const all = frame.joints.length > 1 && frame.joints.every((joint) => joint.freshness !== "fresh");
    this.notice.hidden = !all || !this.app.linkState.daemon;
    if (all) say(this.notice, `⚠ ${silence(frame.joints)[0]}`);
    return all;
  }

  #build(names) {
    this.info = this.app.info;
    const ranges = rangesOf(this.info);
    const known = new Map((this.info?.joints ?? []).map((spec) => [spec.name, spec]));
    const share = () => this.share.get() / 100;
    this.rows = new Map(names.map((name) => [name, new Row(this.app, name, known.get(name), ranges[name], share)]));
    this.list.replaceChildren(...[...this.rows.values()].map((row) => row.element));
  }

  #speed() {
    const shown = el("output", { class: "joints-speed-shown" });
    const tell = () => (shown.textContent = `${slider.value}% of each joint's top speed`);
    const input = () => (this.share.set(Number(slider.value)), tell());
    const slider = el("input", { type: "range", min: 5, max: 100, step: 5, value: this.share.get(), on: { input } });
    tell();
    return el("label", { class: "joints-speed" }, "Speed of − and + ", slider, shown);
  }
}

class Row {
  constructor(app, name, spec, range, share) {
    this.spec = spec;
    this.bar = new JointBar(range);
    this.name = el("h3", { class: "joints-name", text: sentence(words(name)) });
    this.angle = el("span", { class: "joints-angle" });
    this.numbers = el("span", { class: "joints-numbers" });
    this.state = el("span", { class: "joints-state" });
    this.warning = el("span", { class: "joints-warning" });
    this.actions = new JointActions(app, name, spec, share);
    const where = el("div", { class: "joints-where" }, this.bar.element, this.#ends(range));
    const told = el("div", { class: "joints-words" }, this.numbers, this.state, this.warning);
    const parts = [this.name, this.angle, where, told, this.actions.element];
    this.element = el("li", { class: "joints-row" }, ...parts);
  }

  show(joint, expected, attended, quiet) {
    this.bar.show(joint.position, expected);
    this.element.classList.toggle("joints-attended", attended);
    this.actions.show(joint);
    this.#tell(jointWords(joint, expected, this.spec, quiet));
  }

  /** What was known is old. */
  forget() {
    this.bar.show(NaN, undefined);
    this.element.classList.remove("joints-attended");
    this.actions.forget();
    this.#tell(UNKNOWN);
  }

  #tell(told) {
    this.element.classList.toggle("joints-unknown", told === UNKNOWN);
    say(this.angle, told.angle);
    say(this.numbers, told.numbers);
    say(this.state, told.state);
    say(this.warning, told.warning);
  }

  #ends(range) {
    const ends = (range ?? []).map((end) => el("span", { text: degrees(end, 0) }));
    return el("div", { class: "joints-ends" }, ...ends);
  }
}

