// @ts-check
/** How much later than the quickest frame others arrive: two clocks that do not know each other tell no more. Pure. */

const KEPT = 1800; // frames: a minute at 30 Hz

export class Delay {
  /** @type {number[]} s from one clock's zero to the other's, and the way */
  differences = [];

  /** A frame of `time` came at `arrival`: s, by clocks that need not agree. */
  add(arrival, time) {
    const difference = arrival - time;
    if (!Number.isFinite(difference)) return;
    if (this.differences.length && Math.abs(difference - this.differences[0]) > 5) this.differences = []; // another daemon
    this.differences.push(difference);
    if (this.differences.length > KEPT) this.differences.shift();
  }

  get known() {
    return this.differences.length > 1;
  }

  get median() {
    return this.#beyond(0.5);
  }

  /** Within which 99 % of frames arrived. */
  get most() {
    return this.#beyond(0.99);
  }

  #beyond(share) {
    const sorted = [...this.differences].sort((one, other) => one - other);
    return sorted[Math.min(sorted.length - 1, Math.ceil(share * sorted.length))] - sorted[0];
  }
}
