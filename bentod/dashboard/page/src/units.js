// Numbers as people read them: angles in degrees, time in s or ms, always with the unit.

const MINUS = "−";
const NOTHING = "–";

function shown(value, digits, unit, signed) {
  if (typeof value !== "number" || !Number.isFinite(value)) return `${NOTHING} ${unit}`.trim();
  const rounded = value.toFixed(digits);
  const plain = Number(rounded) === 0 ? rounded.replace("-", "") : rounded.replace("-", MINUS);
  return `${signed && Number(rounded) > 0 ? "+" : ""}${plain}${unit === "°" || unit === "%" ? unit : ` ${unit}`}`.trim();
}

/** rad as degrees: 0.2 → "+11.5°". */
export const degrees = (rad, digits = 1) => shown((rad * 180) / Math.PI, digits, "°", true);

/** rad/s as degrees a second. */
export const degreesPerSecond = (radPerSecond, digits = 0) => `${shown((radPerSecond * 180) / Math.PI, digits, "", true)} °/s`;

/** 0..1 as percent. */
export const percent = (share, digits = 0) => shown(share * 100, digits, "%", false);

/** s, in the unit that fits. */
export function seconds(value) {
  const size = Math.abs(value);
  if (!(size < 1)) return size < 90 || !Number.isFinite(value) ? shown(value, 1, "s", false) : clockTime(value);
  return size < 1e-3 ? shown(value * 1e6, 0, "µs", false) : shown(value * 1e3, size < 0.01 ? 2 : 0, "ms", false);
}

/** s as minutes and seconds, 75 → "1:15". */
export function clockTime(value) {
  const whole = Math.max(0, Math.floor(value));
  const [hours, minutes] = [Math.floor(whole / 3600), Math.floor(whole / 60) % 60];
  const two = (number) => String(number).padStart(2, "0");
  return hours ? `${hours}:${two(minutes)}:${two(whole % 60)}` : `${minutes}:${two(whole % 60)}`;
}

/** V, in the unit that fits: muscles are microvolts until they are amplified. */
export function volts(value) {
  const size = Math.abs(value);
  if (size < 1e-3) return shown(value * 1e6, 1, "µV", false);
  return size < 1 ? shown(value * 1e3, 1, "mV", false) : shown(value, 2, "V", false);
}

/** bytes, in the unit that fits. */
export function bytes(value) {
  if (value < 1e6) return shown(value / 1e3, 0, "kB", false);
  return value < 1e9 ? shown(value / 1e6, 1, "MB", false) : shown(value / 1e9, 2, "GB", false);
}

/** A plain number with a unit of its own. */
export const number = (value, digits, unit = "") => shown(value, digits, unit, false);

/** "wrist_flexion" → "wrist flexion". */
export const words = (name) => String(name ?? "").replaceAll("_", " ");

/** "wrist flexion" → "Wrist flexion". */
export const sentence = (text) => text.charAt(0).toUpperCase() + text.slice(1);
