// @ts-check
/** A stretch of a signal as lowest and highest value of each pixel: no peak is lost, whatever the rate. */

export class Bins {
  /** @param {number} count bins of a chart, about one a pixel */
  constructor(count) {
    this.count = count;
    this.times = new Float64Array(count); // s, the newest sample being at 0
    this.low = new Float32Array(count); // V after gain; NaN where no sample came
    this.high = new Float32Array(count);
    this.level = new Float32Array(count); // V after gain; NaN where it is not known
    this.width = 1;
  }

  /**
   * Take the newest `span` s of a channel. Bins begin at multiples of their width, so that a peak stays the same while it
   * wanders through the chart.
   */
  fill(ring, channel, rate, span, gain) {
    const kept = ring.channels[channel];
    this.width = Math.max(1, Math.ceil((span * rate) / this.count));
    const newest = Math.floor((ring.next - 1) / this.width);
    for (let bin = 0; bin < this.count; bin++) {
      const start = (newest - this.count + 1 + bin) * this.width;
      this.times[bin] = (start + (this.width - 1) / 2 - (ring.next - 1)) / rate;
      this.#one(kept, bin, Math.max(start, ring.oldest), Math.min(start + this.width, ring.next), gain);
    }
  }

  #one(kept, bin, start, end, gain) {
    let [low, high] = [NaN, NaN];
    for (let index = start; index < end; index++) {
      const value = kept[index % kept.length] * gain;
      if (!(value >= low)) low = value === value ? value : low;
      if (!(value <= high)) high = value === value ? value : high;
    }
    this.low[bin] = low;
    this.high[bin] = high;
  }

  /** Put levels beside it: each holds until the next one, but for no longer than `holds` samples. */
  fillLevels(ring, levels, holds) {
    const newest = Math.floor((ring.next - 1) / this.width);
    let at = 0;
    for (let bin = 0; bin < this.count; bin++) {
      const end = (newest - this.count + 2 + bin) * this.width;
      while (at + 1 < levels.count && levels.index(at + 1) <= end) at++;
      const known = at < levels.count && levels.index(at) <= end && end - levels.index(at) <= holds;
      this.level[bin] = known ? levels.value(at) : NaN;
    }
  }
}

/** Levels of one site as they were told, each with the index of its sample. */
export class Levels {
  #indices;
  #values;
  #next = 0;

  constructor(length) {
    this.#indices = new Float64Array(length);
    this.#values = new Float32Array(length);
    this.count = 0;
    this.newest = NaN;
  }

  add(index, value) {
    if (this.count && index <= this.index(this.count - 1)) {
      if (index === this.index(this.count - 1)) return;
      this.count = 0; // the source counts from the start again
    }
    this.newest = typeof value === "number" ? value : NaN;
    this.#indices[this.#next] = index;
    this.#values[this.#next] = this.newest;
    this.#next = (this.#next + 1) % this.#indices.length;
    this.count = Math.min(this.count + 1, this.#indices.length);
  }

  index(place) {
    return this.#indices[this.#at(place)];
  }

  value(place) {
    return this.#values[this.#at(place)];
  }

  #at(place) {
    return (this.#next - this.count + place + this.#indices.length) % this.#indices.length;
  }
}
