// Keys that work wherever nobody types; Escape works everywhere.

const TYPING = "input, textarea, select, [contenteditable]";

export class Keyboard {
  constructor() {
    this.bindings = new Map();
    addEventListener("keydown", (event) => this._pressed(event), { capture: true });
  }

  bind(letter, description, action) {
    this.bindings.set(letter, { description, action });
  }

  _pressed(event) {
    const bound = this.bindings.get(event.key);
    const urgent = event.key === "Escape"; // whatever else is pressed
    if (!bound || (!urgent && (event.ctrlKey || event.altKey || event.metaKey || event.isComposing))) return;
    if (!urgent && (event.repeat || event.defaultPrevented || event.target.closest?.(TYPING))) return;
    if (!urgent) event.preventDefault();
    bound.action(event);
  }
}
