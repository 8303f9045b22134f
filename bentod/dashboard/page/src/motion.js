// Motion lasts only while somebody holds a control and sees the arm: each hold is a lease, renewed here.

const EVERY = 50; // ms between renewals; a lease is good for 120 ms

export class Motion {
  /** `link`: sends; `may()`: whether the arm may be moved from this page now. */
  constructor(link, may) {
    this._link = link;
    this._may = may;
    this._held = new Map();
    this._timer = 0;
    addEventListener("blur", () => this.releaseAll({ latched: false })); // key and pointer go elsewhere
    for (const event of ["pagehide", "freeze", "offline"]) addEventListener(event, () => this.releaseAll());
    document.addEventListener("visibilitychange", () => document.hidden && this.releaseAll());
  }

  get keys() {
    return [...this._held.keys()];
  }

  /**
   * Begin, or change what the control asks for. `onDropped`: told why, when the arm refuses. `latched`: goes on
   * without a finger on it, for as long as the page is seen.
   */
  hold(key, method, params, onDropped = () => {}, latched = false) {
    if (document.hidden || !this._may()) return false;
    this._held.set(key, { method, params, onDropped, latched });
    this._link.hold(key, method, params);
    this._timer ||= setInterval(() => this._renew(), EVERY);
    return true;
  }

  release(key) {
    if (this._held.delete(key)) this._link.release(key);
    if (!this._held.size) this._rest();
  }

  /** What was asked for has come to its end by itself. */
  forget(key) {
    this._held.delete(key);
    if (!this._held.size) this._rest();
  }

  releaseAll({ latched = true } = {}) {
    for (const [key, held] of [...this._held]) {
      if (held.latched && !latched) continue;
      held.onDropped("");
      this.release(key);
    }
  }

  /** The server says that a control moves nothing. */
  dropped(key, why) {
    const held = this._held.get(key);
    this._held.delete(key);
    if (!this._held.size) this._rest();
    held?.onDropped(why);
  }

  _renew() {
    if (document.hidden || !this._may()) this.releaseAll();
    for (const [key, { method, params }] of this._held) this._link.hold(key, method, params);
  }

  _rest() {
    clearInterval(this._timer);
    this._timer = 0;
  }
}

/** Wire a button to `hold` and `release`: pointer, touch, Space and Enter; nothing sticks. */
export function whileHeld(button, begin, end) {
  let held = false;
  const start = (event) => {
    if (held || button.disabled || (event.type === "pointerdown" && event.button !== 0)) return;
    event.preventDefault();
    button.focus({ preventScroll: true });
    held = begin() !== false;
    button.classList.toggle("held", held);
  };
  const stop = () => {
    if (!held) return;
    held = false;
    button.classList.remove("held");
    end();
  };
  const isPress = (event) => event.key === " " || event.key === "Enter";
  button.addEventListener("pointerdown", (event) => {
    button.setPointerCapture?.(event.pointerId);
    start(event);
  });
  for (const name of ["pointerup", "pointercancel", "lostpointercapture", "blur"]) button.addEventListener(name, stop);
  button.addEventListener("contextmenu", (event) => event.preventDefault());
  button.addEventListener("keydown", (event) => isPress(event) && (event.repeat ? event.preventDefault() : start(event)));
  button.addEventListener("keyup", (event) => isPress(event) && (event.preventDefault(), stop()));
  return { stop, clear: () => ((held = false), button.classList.remove("held")) };
}
