// What every panel gets: the newest frame, what may be asked, and ways to ask.
import { Keyboard } from "./keyboard.js";
import { Link } from "./link.js";
import { Motion, whileHeld } from "./motion.js";
import { notices } from "./notices.js";
import { setting } from "./settings.js";

const SILENCE = 1000; // ms without a frame, after which what is shown is no longer now
const LOOKS = 250; // ms between two looks for that

export class App {
  constructor(token) {
    this.info = null;
    this.role = "observer";
    this.methods = new Set();
    this.methodTable = [];
    this.frame = null;
    this.told = {};
    this.notices = notices();
    this.keyboard = new Keyboard();
    this._listeners = { tick: [], emg: [], event: [], link: [], role: [], draw: [] };
    this._linkState = { page: false, daemon: false, why: "" };
    this._dirty = false;
    this._heard = performance.now();
    this._silentLooks = 0;
    setInterval(() => this._listenFor(), LOOKS);
    this.link = new Link(token, {
      welcome: (told) => this._welcome(told),
      frame: (state, emg, told) => this.feed(state, emg, told),
      event: (event) => this._emit("event", event),
      dropped: (key, why) => this.motion.dropped(key, why),
      link: (state) => this._linked(state),
    });
    this.motion = new Motion(this.link, () => this._linkState.daemon && this.role === "operator" && !this.replaying);
    document.addEventListener("visibilitychange", () => this._schedule());
  }

  /** Resolves when the daemon's description is there. */
  get ready() {
    return (this._ready ??= new Promise((resolve) => (this._isReady = resolve)));
  }

  get linkState() {
    return this._linkState;
  }

  get stats() {
    return { received: this.link.received, skipped: this.link.skipped };
  }

  /** Whether a recording is shown, and no arm. */
  get replaying() {
    return this.methods.has("replay_get");
  }

  can(name) {
    return this.methods.has(name);
  }

  // What happens.

  /** `draw(frame)`: at most once a picture, with the newest frame; not while `element` is out of sight. */
  onFrame(draw, { element = null } = {}) {
    this._listeners.draw.push({ draw, element });
    if (this.frame) this._schedule();
  }

  onTick(listener) {
    this._listeners.tick.push(listener);
  }

  onEmg(listener) {
    this._listeners.emg.push(listener);
  }

  onEvent(listener) {
    this._listeners.event.push(listener);
  }

  onLink(listener) {
    this._listeners.link.push(listener);
    listener(this._linkState);
  }

  onRole(listener) {
    this._listeners.role.push(listener);
    listener(this.role);
  }

  // What may be asked.

  call(method, params = {}) {
    return this.link.call(method, params);
  }

  /** As `call`; a refusal becomes a notice and the answer undefined. */
  async act(method, params = {}) {
    try {
      return await this.call(method, params);
    } catch (error) {
      this.say(error.message, "error");
      return undefined;
    }
  }

  /** Begin a motion that lasts until `release(key)`; false when this page may not move the arm now. */
  hold(key, method, params, onDropped, latched = false) {
    const told = (why) => {
      if (why) this.say(why, "warning");
      onDropped?.(why);
    };
    return this.motion.hold(key, method, params, told, latched);
  }

  release(key) {
    this.motion.release(key);
  }

  /** `wanted()`: [method, params] that the button asks for while it is held. */
  holdButton(button, key, wanted) {
    const wire = whileHeld(
      button,
      () => this.hold(key, ...wanted(), () => wire.clear()),
      () => this.release(key),
    );
    return button;
  }

  /** Have `letter` do something wherever nobody types. */
  key(letter, description, action) {
    this.keyboard.bind(letter, description, action);
  }

  say(text, kind = "info") {
    this.notices.say(text, kind);
  }

  setting(name, fallback) {
    return setting(name, fallback);
  }

  /** Take in a frame, as if it had arrived. */
  feed(frame, emg = [], told = {}) {
    this.frame = frame;
    this.told = told;
    this._heard = performance.now();
    this._silentLooks = 0;
    if (!this._linkState.daemon) this._linked({ page: true, daemon: true, why: "" });
    this._emit("tick", frame);
    for (const [first_index, time, dropped, channels, data] of emg) {
      const samples = new Float32Array(data.slice().buffer);
      this._emit("emg", { first_index, time, dropped, channels, samples });
    }
    this._schedule();
  }

  _welcome({ role, build, info, methods, own }) {
    if (this._build && this._build !== build) location.reload(); // the page is older than its server
    this._build = build;
    const [known, told] = [JSON.stringify(this.info), JSON.stringify(info)];
    if (this.info && info && known !== told) location.reload(); // another arm
    this.role = role;
    this.methodTable = methods;
    const allowed = methods.filter((method) => role === "operator" || method.role === "observer");
    this.methods = new Set([...allowed.map((method) => method.name), ...own]);
    this._emit("role", role);
    if (!info) return;
    this.info = info;
    this._linked({ page: true, daemon: true, why: "" });
    void this.ready;
    this._isReady();
  }

  /** A daemon that is held up says nothing: neither that it is gone. A page that was held up hears late. */
  _listenFor() {
    const silent = performance.now() - this._heard > SILENCE && this.frame && !this.replaying;
    this._silentLooks = silent ? this._silentLooks + 1 : 0;
    if (this._silentLooks === 2 && this._linkState.daemon) this._linked({ page: true, daemon: false, why: "silent" });
  }

  _linked(state) {
    this._linkState = state;
    document.body.dataset.link = state.daemon ? "up" : "lost";
    if (!state.daemon) this.motion?.releaseAll();
    this._emit("link", state);
  }

  _emit(name, value) {
    for (const listener of this._listeners[name]) listener(value);
  }

  _schedule() {
    if (this._dirty || document.hidden || !this.frame) return;
    this._dirty = true;
    requestAnimationFrame(() => {
      this._dirty = false;
      for (const { draw, element } of this._listeners.draw) {
        if (!element || element.offsetParent !== null) draw(this.frame);
      }
    });
  }
}
