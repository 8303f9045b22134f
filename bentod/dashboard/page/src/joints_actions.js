/** The buttons of one joint: move it a little, pause it, let it go limp. */

import { button, el, say } from "./dom.js";
import { guard, twice } from "./known.js";
import { words } from "./units.js";

export class JointActions {
  /** @param {() => number} share of the joint's top speed, 0..1 */
  constructor(app, name, spec, share) {
    this.app = app;
    this.name = name;
    this.jogs = [this.#jog("−", -1, spec, share), this.#jog("+", 1, spec, share)];
    this.pause = button("", () => this.#switchPause());
    this.torque = button("", () => this.#switchTorque());
    this.sure = twice();
    this.turned = guard();
    this.held = true;
    this.limp = false;
    const all = [...this.jogs, this.pause, this.torque];
    const label = `What may be done with ${words(name)}`;
    this.element = el("div", { class: "joints-actions", role: "group", "aria-label": label }, ...all);
  }

  /** Take in how the joint is; buttons say what they will do. */
  show(joint) {
    this.held = joint.mode !== "active";
    this.turned.see(this.held);
    this.limp = !joint.torque;
    if (this.limp) this.sure.clear();
    for (const jog of this.jogs) disable(jog, this.held || !this.app.can("move"));
    this.pause.disabled = this.limp || joint.mode === "fault" || !this.app.can("pause");
    this.torque.disabled = joint.mode === "fault" || !this.app.can("torque");
    this.#name(this.pause, this.held ? "Release" : "Pause");
    this.#name(this.torque, this.#torqueWord());
  }

  /** Nothing can be asked of a joint that nobody hears of. */
  forget() {
    for (const jog of this.jogs) disable(jog, true);
    this.pause.disabled = this.torque.disabled = true;
  }

  #torqueWord() {
    if (this.limp) return "Torque on";
    return this.sure.armed() ? "May fall: again" : "Torque off";
  }

  /** Who meant to pause, just as somebody else did, must not release. */
  #switchPause() {
    if (this.held && !this.turned.settled()) return;
    this.#toggle("pause", this.held);
  }

  /** A joint that goes limp may fall, so that takes two presses. */
  #switchTorque() {
    if (this.limp || this.sure.press()) this.#toggle("torque", !this.limp);
    else this.#name(this.torque, this.#torqueWord());
  }

  #toggle(method, isOn) {
    return this.app.act(method, { joints: [this.name], on: !isOn });
  }

  #jog(sign, way, spec, share) {
    const label = `Hold ${sign}: ${words(this.name)} ${way > 0 ? "to higher" : "to lower"} angles`;
    const jog = button(`Hold ${sign}`, () => {}, { class: "joints-jog", "aria-label": label });
    const velocity = () => way * share() * (spec?.max_velocity_rad_s ?? 0);
    this.app.holdButton(jog, `jog ${this.name} ${sign}`, () => ["move", { joint: this.name, velocity: velocity() }]);
    return jog;
  }

  #name(button, text) {
    if (button.textContent === text) return;
    say(button, text);
    button.setAttribute("aria-label", `${text}: ${words(this.name)}`);
  }
}

/** Whoever held a button that can no longer be used lets it go: nothing may go on by itself later. */
function disable(jog, off) {
  if (off && !jog.disabled) jog.dispatchEvent(new Event("blur"));
  jog.disabled = off;
}
