// A gamepad that drives the arm: looked at once a picture, while somebody sees the page and it has the keyboard.
import { Presses, Sticks, buttonName, targets } from "./padmapping.js";

const RESTRAINT = new Set(["stop", "pause", "own_pause"]); // always heard
const PERMITS = new Set(["release", "torque", "home"]); // may set the arm in motion: the dead man must be held
const BLIND = 150; // ms without a look, after which nothing is asked: pictures have stopped, timers may not
const STEP = 0.005; // of effort, below which a change is not told

export class Drive {
  /** `show(look)`: told how the pad is, at each look. */
  constructor(app, mapping, show) {
    this._app = app;
    this._show = show;
    this._presses = new Presses();
    this._held = new Map(); // effort by target
    this._home = null;
    this.paused = false;
    this.standard = true; // whether the browser knows which button is where
    this.use(mapping);
    setInterval(() => performance.now() - this._looked > BLIND && this._letGo(), 50);
    setInterval(() => this._begin(), 500);
    addEventListener("gamepadconnected", () => this._begin());
    for (const event of ["blur", "pagehide"]) addEventListener(event, () => this._letGo());
    document.addEventListener("visibilitychange", () => this._letGo());
  }

  use(mapping) {
    this.mapping = mapping;
    this._sticks = new Sticks(mapping);
    this._letGo();
  }

  pause(on) {
    this.paused = on;
    this._letGo();
  }

  _begin() {
    if (this._running || document.hidden || !pad()) return;
    this._running = true;
    this._presses.reset();
    this._sticks.reset();
    requestAnimationFrame(() => this._look());
  }

  _look() {
    const found = document.hidden ? null : pad();
    this._running = Boolean(found);
    if (!found) {
      this._letGo();
      this._show(null);
      return;
    }
    const which = `${found.index} ${found.id}`;
    if (which !== this._which) this._changeHands(which);
    this._looked = performance.now();
    this._take(found);
    requestAnimationFrame(() => this._look());
  }

  /** Another pad: whatever it shows now, it must first be seen at rest. */
  _changeHands(which) {
    this._which = which;
    this._letGo();
    this._presses.reset();
    this._sticks.reset();
  }

  _take(found) {
    const buttons = found.buttons.map((button) => button.pressed);
    this.standard = found.mapping === "standard";
    const why = this._obstacle(found, buttons);
    if (why) this._letGo();
    const seen = this._sticks.step(found.axes, buttons);
    for (const number of this._presses.step(buttons)) this._press(number, seen.held && !why && !this._sticks.waiting, Boolean(why));
    const quiet = this.paused || Boolean(why) || this._sticks.waiting;
    this._moveAll(targets(this.mapping, quiet ? seen.asked.map(() => 0) : seen.asked));
    this._keepHome(buttons, seen.held && !quiet);
    this._show({ name: found.id, standard: this.standard, buttons, ...seen, why: why || this._waiting(), paused: this.paused });
  }

  /** Why nothing may move, be it that the stick is pushed. */
  _obstacle(found, buttons) {
    const { axes, dead_man: deadMan, still_s: still } = this.mapping;
    const missing = axes.find((axis) => !(axis.axis in found.axes));
    if (missing) return `This gamepad has no axis ${missing.axis}.`;
    if (deadMan !== false && !(deadMan in buttons)) return `This gamepad has no ${this._name(deadMan)}.`;
    if (!document.hasFocus()) return "Click into the page first.";
    if (this._app.role !== "operator") return "You look only.";
    const now = JSON.stringify([found.axes, buttons]);
    if (now !== this._before) [this._before, this._changed] = [now, performance.now()];
    const stuck = this._held.size && performance.now() - this._changed > 1000 * still;
    return stuck ? `Nothing of the gamepad has changed for ${still} s: let go.` : "";
  }

  _name(number) {
    return buttonName(number, this.standard);
  }

  _waiting() {
    if (!this._sticks.waiting || this.paused) return "";
    const also = this.mapping.dead_man === false ? "" : ` and the ${this._name(this.mapping.dead_man)} was let go`;
    return `It moves nothing until every axis was at rest${also}.`;
  }

  _moveAll(wanted) {
    for (const target of [...this._held.keys()]) if (!wanted.get(target)) this._release(target);
    for (const [target, effort] of wanted) {
      const before = this._held.get(target) ?? 0;
      const told = before && Math.abs(effort - before) <= STEP && Math.sign(effort) === Math.sign(before);
      if (effort && !told && !this._hold(target, effort)) return;
    }
  }

  _hold(target, effort) {
    const [kind, name] = target.split(":");
    const joint = kind === "joint" && this._app.info.joints.find((one) => one.name === name);
    if (kind === "joint" && !joint) return true; // of another arm: nothing to move
    const [method, params] = joint
      ? ["move", { joint: name, velocity: effort * joint.max_velocity_rad_s }]
      : ["group_command", { group: name, effort }];
    this._held.set(target, effort);
    const may = this._app.hold(`gamepad:${target}`, method, params, () => this._letGo());
    if (!may) this._letGo();
    return may;
  }

  _release(target) {
    this._held.delete(target);
    this._app.release(`gamepad:${target}`);
  }

  /** Everything stops, and must be seen at rest before it moves again. */
  _letGo() {
    for (const target of [...this._held.keys()]) this._release(target);
    this._endHome();
    this._sticks.reset();
  }

  _press(number, held, hushed) {
    const button = this.mapping.buttons.find((one) => one.button === number);
    if (!button || ((hushed || this.paused) && !RESTRAINT.has(button.action))) return;
    if (PERMITS.has(button.action) && !held) {
      const how = this._waiting() || `Hold the ${this._name(this.mapping.dead_man)}, then press the ${this._name(number)}.`;
      this._app.say(`Not done: ${button.action}. ${how}`, "warning");
      return;
    }
    this._act(button);
  }

  _act(button) {
    const { action, group, joint, on, mark } = button;
    const joints = group ? this._app.info.groups[group] : (joint ?? null);
    const asks = {
      toggle: () => this._app.act("group_toggle", { group, direction: "forward" }),
      toggle_back: () => this._app.act("group_toggle", { group, direction: "backward" }),
      pause: () => this._app.act("pause", { joints, on: true }),
      release: () => this._app.act("pause", { joints, on: false }),
      torque: () => this._app.act("torque", { joints, on }),
      stop: () => this._app.act("stop"),
      mark: () => this._app.act("mark", { mark }),
      own_pause: () => this.pause(!this.paused),
      home: () => this._goHome(button, joints),
    };
    asks[action]?.();
  }

  _goHome(button, joints) {
    const before = this._app.frame?.goal?.id ?? null;
    if (this._app.hold("gamepad:home", "go_home", { joints }, () => (this._home = null))) this._home = { button, before };
  }

  /** The way home goes on while the dead man is held, or where there is none, its button. */
  _keepHome(buttons, may) {
    if (!this._home) return;
    const goal = this._app.frame?.goal;
    const over = goal && goal.id !== this._home.before && ["done", "cancelled"].includes(goal.status);
    const on = this.mapping.dead_man === false ? buttons[this._home.button.button] : may;
    if (over || !on) this._endHome();
  }

  _endHome() {
    if (this._home) this._app.release("gamepad:home");
    this._home = null;
  }
}

const pad = () => [...(navigator.getGamepads?.() ?? [])].find((one) => one?.connected) ?? null;
