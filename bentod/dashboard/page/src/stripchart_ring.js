// @ts-check
/** The newest samples of every channel, at their index; what never came is NaN. Memory is taken once. */

/** Samples of one channel that are kept at most: 20 s at 20 kHz. */
const MOST = 400_000;

export class Ring {
  /** @param {number} channels @param {number} length samples that are kept of each */
  constructor(channels, length) {
    this.length = Math.min(Math.max(Math.round(length), 1), MOST);
    this.channels = Array.from({ length: channels }, () => new Float32Array(this.length).fill(NaN));
    this.next = -1; // index after the newest sample; -1: there was none
    this.missing = 0; // samples that never came
  }

  /** Take in a block: samples of all channels, one moment after the other. */
  take({ first_index: first, samples }) {
    const width = this.channels.length;
    const count = Math.floor(samples.length / width);
    if (first < this.next) this.#forget(); // the source counts from the start again
    if (this.next >= 0 && first > this.next) this.#skip(first);
    for (let channel = 0; channel < width; channel++) {
      const kept = this.channels[channel];
      for (let row = 0; row < count; row++) kept[(first + row) % this.length] = samples[row * width + channel];
    }
    this.next = first + count;
  }

  /** Index of the oldest sample that is still there. */
  get oldest() {
    return Math.max(this.next - this.length, 0);
  }

  #skip(first) {
    this.missing += first - this.next;
    const from = Math.max(this.next, first - this.length);
    for (const kept of this.channels) for (let index = from; index < first; index++) kept[index % this.length] = NaN;
  }

  #forget() {
    for (const kept of this.channels) kept.fill(NaN);
    this.next = -1;
  }
}
