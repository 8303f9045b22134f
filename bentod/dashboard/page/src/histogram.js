// @ts-check
/** How often ticks began how late: logarithmic bins of the last minute, and of all since the page was opened. */

export const LOWEST = 1e-5; // s
export const HIGHEST = 0.1; // s
export const PER_DECADE = 4;
const INNER = Math.round(Math.log10(HIGHEST / LOWEST) * PER_DECADE);

/** Bins in all: one below the lowest edge, those between, one beyond the highest. */
export const BINS = INNER + 2;

const ROUNDING = 1e-9; // an edge belongs to the bin above it, whatever its logarithm rounds to

/** The bin of a value in s; early counts as on time. */
export function binOf(value) {
  if (!(value >= LOWEST)) return 0;
  const place = Math.floor(Math.log10(value / LOWEST) * PER_DECADE + ROUNDING);
  return Math.min(place + 1, BINS - 1);
}

/** The lower edge of a bin (s); the first begins at 0. */
export function edgeOf(bin) {
  return bin === 0 ? 0 : LOWEST * 10 ** ((bin - 1) / PER_DECADE);
}

/** Values (s) with their times (monotonic s). */
export class Histogram {
  constructor(span = 60) {
    this.span = span;
    this.all = new Array(BINS).fill(0);
    this.worst = 0;
    /** @type {{time: number, value: number}[]} */
    this.latest = [];
  }

  add(value, time) {
    if (!Number.isFinite(value)) return;
    if (this.latest.length && time < this.latest[this.latest.length - 1].time) this.latest = []; // another daemon
    this.all[binOf(value)] += 1;
    this.worst = Math.max(this.worst, value);
    this.latest.push({ time, value });
    const first = this.latest.findIndex((one) => one.time > time - this.span);
    if (first > 0) this.latest.splice(0, first);
  }

  /** How many of the last `span` are in each bin. */
  recent() {
    const found = new Array(BINS).fill(0);
    for (const { value } of this.latest) found[binOf(value)] += 1;
    return found;
  }

  /** Below which (s) a share 0..1 of the last `span` was; NaN when there was none. */
  quantile(share) {
    const sorted = this.latest.map(({ value }) => value).sort((one, other) => one - other);
    return sorted.length ? sorted[Math.min(Math.ceil(share * sorted.length), sorted.length) - 1 || 0] : NaN;
  }

  /** As `quantile`, of all: the upper edge of the bin, or the worst of all where that is less. */
  quantileOfAll(share) {
    const total = this.all.reduce((sum, count) => sum + count, 0);
    let seen = 0;
    for (const [bin, count] of this.all.entries()) {
      seen += count;
      if (total && seen >= share * total) return bin === BINS - 1 ? this.worst : Math.min(edgeOf(bin + 1), this.worst);
    }
    return NaN;
  }
}
