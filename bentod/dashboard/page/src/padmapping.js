// What the axes and buttons of a gamepad ask for: pure, and by the same rules as the daemon's own joystick.

/** The effort, -1..1, of an axis at `value`: x = (|value| - d) / (1 - d), then ((1 - e) x + e x³) of the share. */
export function shaped(value, axis) {
  if (!Number.isFinite(value)) return 0;
  const level = Math.max(-1, Math.min(1, axis.one_sided ? (value + 1) / 2 : value));
  const beyond = (Math.abs(level) - axis.dead_zone) / (1 - axis.dead_zone);
  if (beyond <= 0) return 0;
  const effort = ((1 - axis.expo) * beyond + axis.expo * beyond ** 3) * axis.max;
  return level > 0 === axis.invert ? -effort : effort;
}

export const atRest = (value, axis) => Number.isFinite(value) && shaped(value, axis) === 0;

// Buttons of the W3C's standard gamepad, by their places.
const BUTTONS = [
  "lower face button", "right face button", "left face button", "upper face button", "left bumper", "right bumper",
  "left trigger", "right trigger", "select button", "start button", "left stick's button", "right stick's button",
  "up on the cross", "down on the cross", "left on the cross", "right on the cross", "middle button",
];

/** A button as people know it, "right bumper (5)"; by its number alone where the pad is not `standard`. */
export const buttonName = (number, standard = true) => (standard && BUTTONS[number] ? `${BUTTONS[number]} (${number})` : `button ${number}`);

/** What a pad in the manner of the Xbox does when nobody says otherwise; numbers as browsers give them. */
export function usual(groups) {
  const stick = { joint: null, dead_zone: 0.15, expo: 0.3, invert: false, one_sided: false, max: 1 };
  const sticks = [0, 2].map((axis, place) => ({ axis, group: groups[place], ...stick }));
  const plain = { group: null, joint: null, on: true, mark: "" };
  const [first, second] = groups;
  const buttons = [
    first && { button: 0, action: "toggle", group: first },
    { button: 1, action: "pause" },
    { button: 2, action: "home" },
    { button: 3, action: "own_pause" },
    second && { button: 4, action: "toggle", group: second },
    { button: 8, action: "stop" },
    { button: 9, action: "release" },
  ];
  return {
    dead_man: 5,
    still_s: 4,
    axes: sticks.filter((axis) => axis.group),
    buttons: buttons.filter(Boolean).map((button) => ({ ...plain, ...button })),
  };
}

/**
 * Which axes may move something. At first, and after `reset`, all must be seen at rest at once with the dead man
 * let go; then an axis moves something while the dead man is held, once it was at rest since that was pressed.
 */
export class Sticks {
  constructor(mapping) {
    this._mapping = mapping;
    this.reset();
  }

  reset() {
    this.waiting = true;
    this._free = new Set();
  }

  /** `axes`: values; `buttons`: whether each is down. What the pad does not have is not at rest. */
  step(axes, buttons) {
    const { axes: mapped, dead_man: deadMan } = this._mapping;
    const values = mapped.map((axis) => axes[axis.axis]);
    const resting = values.map((value, place) => atRest(value, mapped[place]));
    const held = deadMan === false || buttons[deadMan] === true;
    if (resting.every(Boolean) && (deadMan === false || buttons[deadMan] === false)) this.waiting = false;
    values.forEach((value, place) => {
      if (resting[place]) this._free.add(place);
      if (!Number.isFinite(value)) this._free.delete(place);
    });
    if (this.waiting || !held) this._free.clear();
    const efforts = values.map((value, place) => shaped(value, mapped[place]));
    return { held, shaped: efforts, asked: efforts.map((effort, place) => (this._free.has(place) ? effort : 0)) };
  }
}

/** Efforts of groups and joints; axes of one target add up. Targets are called "group:arm", "joint:elbow". */
export function targets(mapping, asked) {
  const found = new Map();
  mapping.axes.forEach((axis, place) => {
    const name = axis.group ? `group:${axis.group}` : `joint:${axis.joint}`;
    found.set(name, Math.max(-1, Math.min(1, (found.get(name) ?? 0) + asked[place])));
  });
  return found;
}

/** Presses of buttons that were seen up before: what is held when the pad is found is no press. */
export class Presses {
  constructor() {
    this._up = new Set();
  }

  reset() {
    this._up.clear();
  }

  /** Numbers of the buttons that went down since the last look. */
  step(buttons) {
    const pressed = [];
    buttons.forEach((down, number) => {
      if (!down) this._up.add(number);
      else if (this._up.delete(number)) pressed.push(number);
    });
    return pressed;
  }
}
