// @ts-check
// From the angles of two joints to pixels, the same scale both ways, and where to put marks on the axes.

const STEPS = [0.5, 1, 2, 5, 10, 15, 30, 45, 90]; // degrees between two marks of an axis
const DEGREE = Math.PI / 180;

/** @typedef {[number, number]} Pair */

export class Scale {
  /**
   * @param {[Pair, Pair]} bounds rad, lowest and highest across and up
   * @param {{width: number, height: number}} size CSS pixels
   * @param {{left: number, right: number, top: number, bottom: number}} margin CSS pixels
   */
  constructor(bounds, size, margin) {
    const [[x0, x1], [y0, y1]] = bounds;
    const [width, height] = [size.width - margin.left - margin.right, size.height - margin.top - margin.bottom];
    this.bounds = bounds;
    this.size = size;
    this.perRad = Math.max(1, Math.min(width / (x1 - x0), height / (y1 - y0)));
    this.left = margin.left + (width - this.perRad * (x1 - x0)) / 2;
    this.bottom = margin.top + height - (height - this.perRad * (y1 - y0)) / 2;
  }

  /** Pixels from the left. @param {number} rad */
  x(rad) {
    return this.left + (rad - this.bounds[0][0]) * this.perRad;
  }

  /** Pixels from the top. @param {number} rad */
  y(rad) {
    return this.bottom - (rad - this.bounds[1][0]) * this.perRad;
  }

  /** Angles (rad) of an axis that get a mark, at least `apart` pixels from one another. */
  marks(axis, apart) {
    const [low, high] = this.bounds[axis].map((angle) => angle / DEGREE);
    const step = STEPS.find((one) => one * DEGREE * this.perRad >= apart) ?? 180;
    const found = [];
    for (let k = Math.ceil(low / step); k * step <= high; k++) found.push(k * step * DEGREE);
    return found;
  }
}

/** How high a view of these bounds should be (CSS pixels), that wide. */
export function heightFor(bounds, width) {
  const [[x0, x1], [y0, y1]] = bounds;
  return Math.round(Math.min(Math.max((width * (y1 - y0)) / (x1 - x0), 260), 620, 1.15 * width));
}
