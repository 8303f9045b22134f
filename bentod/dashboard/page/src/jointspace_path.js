// @ts-check
// Where the arm has been: the circuit under way and the one before, as many points as fit and no more.

const MOST = 9000; // points of one circuit: 5 minutes of motion at 30 Hz
const LEAST = 0.0007; // rad between two points

export class Path {
  constructor() {
    this.now = new Float32Array(2 * MOST);
    this.before = new Float32Array(2 * MOST);
    this.count = 0;
    this.countBefore = 0;
    /** @type {[number, number][]} rad, where walls were touched */
    this.contacts = [];
  }

  /** @param {number} x rad @param {number} y rad */
  add(x, y) {
    const last = 2 * (this.count - 1);
    if (this.count && Math.hypot(x - this.now[last], y - this.now[last + 1]) < LEAST) return;
    if (this.count === MOST) this.#thin();
    this.now.set([x, y], 2 * this.count);
    this.count += 1;
  }

  /** A wall was touched here (rad). */
  touch(x, y) {
    this.contacts.push([x, y]);
    if (this.contacts.length > 50) this.contacts.shift();
  }

  /** Another circuit begins. */
  turn() {
    [this.now, this.before] = [this.before, this.now];
    [this.count, this.countBefore] = [0, this.count];
    this.contacts = [];
  }

  clear() {
    this.count = this.countBefore = 0;
    this.contacts = [];
  }

  /** Every other point goes: a long way stays whole, and coarser. */
  #thin() {
    for (let i = 0; i < MOST / 2; i++) this.now.set(this.now.subarray(4 * i, 4 * i + 2), 2 * i);
    this.count = MOST / 2;
  }
}
