// @ts-check
/** What a signal did, and what was predicted of it, each at the time that it is about: pure. */

/** Of one subject, in slots of one tick. Missed ticks leave their slots empty. */
export class Outcome {
  /**
   * @param {number} ticks how far ahead the predictions look
   * @param {number} span slots before now that are kept
   */
  constructor(ticks, span) {
    this.ahead = Math.max(1, Math.round(ticks));
    this.span = span;
    this.clear();
  }

  clear() {
    this.now = NaN;
    /** @type {Map<number, number>} */
    this.values = new Map();
    /** @type {Map<number, {value: number, error: number}>} */
    this.predictions = new Map();
  }

  /**
   * Take in a tick: `slot`, its number on the grid of deadlines; the signal in it, what it predicts, and how
   * wrong it was of late. NaN is not known.
   */
  add(slot, value, prediction, error) {
    if (slot < this.now) this.clear(); // another daemon, or another recording
    this.now = slot;
    if (Number.isFinite(value)) this.values.set(slot, value);
    if (Number.isFinite(prediction)) this.predictions.set(slot + this.ahead, { value: prediction, error });
    forget(this.values, slot - this.span);
    forget(this.predictions, slot - this.span);
  }

  /** Columns for a chart: slots from now (0), signal, prediction, and the band about it; null where there is none. */
  columns() {
    const first = -this.span;
    const slots = Array.from({ length: this.span + this.ahead + 1 }, (_, place) => first + place);
    const of = (read) => slots.map((slot) => read(this.now + slot));
    const predicted = (slot) => this.predictions.get(slot)?.value ?? null;
    const edge = (slot, way) => {
      const found = this.predictions.get(slot);
      return found && Number.isFinite(found.error) ? found.value + way * found.error : null;
    };
    return [slots, of((slot) => this.values.get(slot) ?? null), of(predicted), of((slot) => edge(slot, -1)), of((slot) => edge(slot, 1))];
  }
}

/** Entries are in the order of their slots. */
function forget(map, before) {
  for (const slot of map.keys()) {
    if (slot >= before) return;
    map.delete(slot);
  }
}
