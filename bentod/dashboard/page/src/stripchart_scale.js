// @ts-check
/** Volts of a chart: ranges that stay while they fit, round steps, and the unit that suits them. */

const UNITS = [
  { factor: 1e6, unit: "µV", below: 1e-3 },
  { factor: 1e3, unit: "mV", below: 1 },
  { factor: 1, unit: "V", below: Infinity },
];

/** The unit for voltages up to `volts`: {factor, unit}. */
export function unitFor(volts) {
  return UNITS.find(({ below }) => Math.abs(volts) < below) ?? UNITS[2];
}

/** The smallest of 1, 1.5, 2, 3, 5, 7 times a power of ten that is at least `volts`. */
export function roundUp(volts) {
  if (!(volts > 0)) return 1e-6;
  const power = 10 ** Math.floor(Math.log10(volts));
  const step = [1, 1.5, 2, 3, 5, 7, 10].find((one) => one * power >= volts * 0.999999) ?? 10;
  return step * power;
}

/** To three digits, which is more than a muscle repeats. */
export const rounded = (volts) => Number(volts.toPrecision(3));

/** The range that was, if `peak` still fits well; else one that it fits. */
export function rangeFor(peak, was, below = 1) {
  const fits = was && peak <= was.high && peak > 0.35 * was.high && was.below === below;
  if (fits) return was;
  const high = roundUp(1.15 * peak);
  return { high, low: -below * high, below };
}

/** Labels of an axis of volts, in one unit, for uPlot. */
export function voltAxis() {
  return {
    values: (plot, splits) => {
      const { factor, unit } = unitFor(Math.max(Math.abs(plot.scales.y.max), Math.abs(plot.scales.y.min)));
      return splits.map((volts) => `${Number((volts * factor).toPrecision(3))} ${unit}`.replace("-", "−"));
    },
  };
}
