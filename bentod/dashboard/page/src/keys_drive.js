// @ts-check
// Two joints driven with the arrow keys while their view has the focus, or with buttons; either both at once, or
// one at a time as a wearer does (thesis 5.4): ← → move the active joint and Space selects the other one.
import { button, el, field } from "./dom.js";
import { percent, words } from "./units.js";
import "./keys_drive.css";

const WAYS = { ArrowLeft: ["x", -1], ArrowRight: ["x", 1], ArrowDown: ["y", -1], ArrowUp: ["y", 1] };
const SHARES = { min: 0.05, max: 1, step: 0.05 };

export class KeysDrive {
  /**
   * @param {any} app
   * @param {HTMLElement} surface listens for keys while it has the focus
   */
  constructor(app, surface) {
    this.app = app;
    this.pair = ["", ""];
    this.group = "";
    this.share = app.setting("task.share", 0.25);
    this.mode = app.setting("task.mode", "both");
    /** @type {Map<string, [string, number]>} keys that are down */
    this.down = new Map();
    this.element = this._controls();
    this.hint = el("p", { class: "drive-hint soft", id: "drive-hint" });
    surface.setAttribute("aria-describedby", "drive-hint");
    surface.addEventListener("keydown", (event) => this._pressed(event));
    surface.addEventListener("keyup", (event) => this._let(event.key));
    surface.addEventListener("blur", () => this.release());
    app.onRole(() => this._explain());
  }

  get single() {
    return this.mode.get() === "one" && this.group !== "";
  }

  /** Drive these joints from now on. `group`: the one that holds both; empty if none does. */
  drive(pair, group) {
    this.release();
    [this.pair, this.group] = [pair, group];
    this._explain();
  }

  /** Whatever is held is let go. */
  release() {
    this.down.clear();
    for (const axis of ["x", "y"]) this.app.release(`drive ${axis}`);
  }

  /** What a push of `way` (−1 or 1) along `axis` asks for: [method, params]. */
  wanted(axis, way) {
    if (this.single) return ["group_command", { group: this.group, effort: way * this.share.get() }];
    const joint = this.pair[axis === "x" ? 0 : 1];
    const top = this.app.info.joints.find((one) => one.name === joint)?.max_velocity_rad_s ?? 0;
    return ["move", { joint, velocity: way * this.share.get() * top }];
  }

  _pressed(event) {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const space = event.key === " " && this.single;
    const way = WAYS[event.key];
    if (!space && !way) return;
    event.preventDefault();
    if (event.repeat) return;
    if (space) this._toggle();
    else this._push(event.key, way);
  }

  _push(key, [axis, way]) {
    this.down.set(key, [this.single ? "x" : axis, way]);
    this._follow(this.single ? "x" : axis);
  }

  _let(key) {
    const held = this.down.get(key);
    if (this.down.delete(key) && held) this._follow(held[0]);
  }

  /** Ask for what the keys of an axis say together; those of opposite ways stand still. */
  _follow(axis) {
    const sum = [...this.down.values()].reduce((all, [of, way]) => all + (of === axis ? way : 0), 0);
    const key = `drive ${axis}`;
    if (sum === 0) return this.app.release(key);
    const [method, params] = this.wanted(axis, Math.sign(sum));
    const began = this.app.hold(key, method, params, () => this._forget(axis));
    if (!began) this._forget(axis);
  }

  /** What was refused begins again only with another press. */
  _forget(axis) {
    for (const [key, [of]] of [...this.down]) if (of === axis) this.down.delete(key);
  }

  _toggle() {
    this.release();
    void this.app.act("group_toggle", { group: this.group, direction: "forward" });
  }

  _controls() {
    const pad = (label, name, axis, way) => {
      const one = button(label, () => {}, { class: `hold drive-${name}`, "aria-label": `Move ${name}: hold` });
      return this.app.holdButton(one, `drive ${axis}`, () => this.wanted(axis, way));
    };
    this.pads = el(
      "div",
      { class: "drive-pad", role: "group", aria: { label: "Move the two joints" } },
      pad("▲", "up", "y", 1), pad("◀", "left", "x", -1), pad("▶", "right", "x", 1), pad("▼", "down", "y", -1),
    );
    this.other = button("Other joint", () => this._toggle(), { class: "drive-other" });
    return el("div", { class: "drive" }, this.pads, this.other, this._modes(), this._speed());
  }

  _modes() {
    this.choice = el(
      "select",
      { on: { change: (event) => this._choose(event.target.value) } },
      el("option", { value: "both", text: "both joints at once" }),
      el("option", { value: "one", text: "one joint at a time" }),
    );
    return field("Keys move", this.choice);
  }

  _speed() {
    const told = el("span", { class: "unit", text: percent(this.share.get()) });
    const input = el("input", { type: "range", ...SHARES, value: this.share.get() });
    input.addEventListener("input", () => {
      this.release();
      this.share.set(Number(input.value));
      told.textContent = percent(Number(input.value));
    });
    return el("label", { class: "field" }, el("span", { text: "Speed" }), input, told);
  }

  _choose(mode) {
    this.release();
    this.mode.set(mode);
    this._explain();
  }

  _explain() {
    const may = this.app.can("move");
    this.choice.value = this.single ? "one" : "both";
    this.choice.disabled = this.group === "";
    this.other.hidden = !this.single;
    for (const one of this.pads.children) one.disabled = !may;
    for (const name of ["up", "down"]) this.pads.querySelector(`.drive-${name}`).hidden = this.single;
    this.other.disabled = !may;
    this.hint.textContent = may ? this._words() : "You may look: only operators move the arm.";
  }

  _words() {
    const [across, up] = this.pair.map(words);
    if (this.single) return "Click the picture, then hold ← or → to move the active joint; Space selects the other one.";
    return `Click the picture, then hold ← → for ${across}, ↑ ↓ for ${up}. Letting go stops.`;
  }
}
