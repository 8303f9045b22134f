// @ts-check
/** What to do about a complaint: pure, from the words in which the daemon, its drivers and its servos complain. */

/** @typedef {{name: string, steps: string[]}} Advice */

const AGAIN = "Then clear the fault, switch torque on where joints are limp, and release the arm.";
const ITSELF = "It goes on by itself once that is mended.";
const TRACE = "If it comes again, keep the daemon's log (journalctl -u bentod) and report it.";

/** The first whose words are found counts, so the particular stand before the general. */
const TABLE = [
  {
    words: /cable is pulled|port .*(no such port|no device|hung up|was closed|another program|access is denied)|unplugged/i,
    name: "Cable",
    steps: ["Look at the USB cable and its adapter: plug in both ends. The daemon connects again by itself.", AGAIN],
  },
  {
    words: /takes no frames|CAN bus .*cannot be read|no controller was heard/i,
    name: "CAN bus",
    steps: ["Look at the CAN cable, its termination and the controllers' supply.", AGAIN],
  },
  {
    words: /no servo answers any more|check the power of the arm/i,
    name: "Power",
    steps: [
      "Is the arm's supply on, its plug in, its fuse whole, its emergency stop released?",
      "If it has power, look at the cable from the adapter to the first servo. An adapter that answers 16 ms late does the same: set its latency timer to 1 ms.",
      AGAIN,
    ],
  },
  {
    words: /overload error|motor stall|current limit/i,
    name: "Overload",
    steps: ["Take the load off the joint: what blocks it, what the hand holds. Let the servo cool for a minute.", `${AGAIN} Support the arm: the joint is limp.`],
  },
  {
    words: /overheating error|too hot|over[- ]?temp|is at \d+ °C|degrees celsius/i,
    name: "Too hot",
    steps: ["Let the joint rest without load until it is well below its bound (Health shows the temperatures).", AGAIN],
  },
  {
    words: /input voltage error|voltage/i,
    name: "Supply voltage",
    steps: ["Measure the supply: charge or exchange the battery, or use one that gives the current that all servos need together.", ITSELF],
  },
  {
    words: /motor encoder error|electrical shock|encoder/i,
    name: "Damaged servo",
    steps: ["Switch the supply off and on once. If the servo complains again, exchange it.", AGAIN],
  },
  {
    words: /watchdog/i,
    name: "Watchdog",
    steps: [
      "The servo stopped because the daemon was silent for 0.3 s. Look at missed ticks in Timing, and at what else keeps the machine busy.",
      "Clear the fault, if there is one, and release the arm.",
    ],
  },
  {
    words: /torque limit 0|alarm shutdown|shut down by itself|hardware alert/i,
    name: "Servo shut down",
    steps: ["Take the load off and let it cool. What the servo complains of stands with its joint.", `${AGAIN} If it stays, switch its supply off and on.`],
  },
  {
    words: /(lost|gained) torque unasked|was reset/i,
    name: "Servo was reset",
    steps: ["A plug is loose, or the supply gives way under load: look at both.", "Clear the fault, switch torque on, and release the arm. Support it: joints may be limp."],
  },
  {
    words: /model number|speaks protocol|expects an? |same servo id|firmware|operating mode|homing offset|velocity limit|return level/i,
    name: "Servo is another, or set up otherwise",
    steps: ["Check the wiring and the id of the servo against the config. `bentod servo` changes what a servo keeps, torque off.", AGAIN],
  },
  {
    words: /stands at .*outside its limit/i,
    name: "Outside its limits",
    steps: ["Move the joint back into its range by hand.", "Then switch torque on."],
  },
  {
    words: /torque (could|was) not|did not confirm|confirmed to switch/i,
    name: "Torque was not confirmed",
    steps: ["Support the arm, and cut its power if a joint should be limp and is not.", "Look at the servo's cable and its complaints below.", AGAIN],
  },
  {
    words: /no answer|does not answer|silent|check its cable/i,
    name: "Servo silent",
    steps: [
      "Look at the cable of that servo and of those before it on the chain, and at its power.",
      "If cables are good: two servos with the same id, or a cable beside a motor's that picks up noise, do the same.",
      AGAIN,
    ],
  },
  {
    words: /(crc|checksum|instruction|data range|data length|data limit|access|range) error/i,
    name: "Garbled messages",
    steps: ["Look for loose plugs, and keep the servos' cable away from motor and mains cables.", ITSELF],
  },
  {
    words: /angle limit error/i,
    name: "Servo's own limits",
    steps: ["The servo keeps narrower limits than the config: change them with `bentod servo`, or narrow the config."],
  },
  {
    words: /internal error|memoryerror|the driver does not answer|took longer than/i,
    name: "Error in the daemon",
    steps: ["Clear the fault and release the arm.", TRACE],
  },
  { words: /learning broke|assist .* broke/i, name: "Learning or assist", steps: ["The arm goes on without. Start the daemon again when convenient.", TRACE] },
  {
    words: /emg source (ended|broke)|has no samples/i,
    name: "Muscle signals ended",
    steps: ["Look at the amplifier: is it on, charged, plugged in, in reach? What can be opened again is opened by itself; a file that has ended needs a restart."],
  },
  {
    words: /no emg sample|emg samples are .* old/i,
    name: "Muscle signals lost",
    steps: ["Look at the amplifier and its connection: battery, cable, radio.", "It goes on by itself; muscles must be seen at rest first."],
  },
  {
    words: /emg .*(stuck|saturated|not a finite|mains|hum|slower than|lead|offset|no change)/i,
    name: "Electrode",
    steps: ["Press the electrode on, or moisten it; look at its lead and at the reference electrode.", "Keep away from mains cables. It goes on by itself."],
  },
  { words: /at rest|must rest/i, name: "Muscles must rest", steps: ["Relax all muscles for a moment: then they drive the arm again."] },
  { words: /ticks? (was|were) missed|began late|took long|too busy/i, name: "Late ticks", steps: ["Close what keeps the machine busy, or lower rate_hz; `bentod bench` tells how late ticks are."] },
];

/** @type {Advice} */
const UNKNOWN = { name: "Fault", steps: ["Read what it says, and look at cables, power and temperatures.", AGAIN, TRACE] };

/**
 * What to do about a complaint in the daemon's words.
 * @param {string} text
 * @returns {Advice}
 */
export function adviceFor(text) {
  return TABLE.find(({ words }) => words.test(text)) ?? UNKNOWN;
}

/** What a joint that is slowed or held tells about its surroundings, by its frame's `limited`. */
const LIMITED = {
  load: "It pushes against something: it moves no further that way. Take the load off, or move back.",
  warm: "It is warm, and slower therefore: let it rest.",
  stale: "Its reading is too old to move by: look at its cable.",
};

/** @typedef {{what: string, text: string, advice: Advice, grave: boolean}} Complaint */

/**
 * All that is wrong in a frame, the worst first; what the fault tells of a joint is not told again.
 * `late`: ticks that were missed in the last minute.
 * @returns {Complaint[]}
 */
export function complaints(frame, late = 0) {
  const found = frame.fault ? [complaint("The arm", frame.fault, true)] : [];
  const told = (joint) => /any joint/.test(frame.fault) || frame.fault.includes(joint.name);
  for (const one of frame.joints.flatMap((joint) => (told(joint) ? [] : ofJoint(joint)))) {
    const same = found.find((other) => other.text === one.text);
    if (same) same.what += `, ${one.what}`;
    else found.push(one);
  }
  if (frame.emg?.problem) found.push(complaint("Muscle signals", frame.emg.problem, false));
  if (late) found.push(complaint("The daemon", `Ticks missed in the last 60 s: ${late}.`, false, adviceFor("ticks were missed")));
  return found;
}

const complaint = (what, text, grave, advice = adviceFor(text)) => ({ what, text, advice, grave });

function ofJoint(joint) {
  const found = [];
  if (joint.freshness === "lost") found.push(complaint(joint.name, "It does not answer.", true));
  if (joint.errors.length) found.push(complaint(joint.name, joint.errors.join(", "), true));
  const limited = LIMITED[joint.limited];
  if (limited) found.push(complaint(joint.name, `Held back: ${joint.limited}.`, false, { name: "Limit", steps: [limited] }));
  return found;
}
