// @ts-check
/** Faults that a simulated arm can be given, what each is like on a real one, and what it needs: pure. */

/** `whole`: it befalls the whole arm and takes no joint. */
export const PRACTICE = {
  cable: { whole: true, like: "The simulated USB cable is pulled.", todo: "Plug it in (mend), clear the fault, release." },
  power: { whole: true, like: "The arm's supply fails: joints go limp and forget their settings.", todo: "Mend it, clear the fault, torque on, release." },
  noise: { whole: true, like: "The cable picks up noise: messages are lost and garbled.", todo: "Mend it. Readings turn stale until then; the arm goes on, or stops and must be cleared." },
  silent: { whole: false, like: "A servo no longer answers.", todo: "Mend it, clear the fault, release." },
  stuck: { whole: false, like: "A gearbox jams: the joint moves neither way.", todo: "Let go, mend it; an overload may follow." },
  blocked: { whole: false, like: "Something stands in the joint's way.", todo: "Move back; the joint holds against the load." },
  reboot: { whole: false, like: "A loose plug resets the servo: its torque is gone.", todo: "Clear the fault, torque on, release." },
  overload: { whole: false, like: "A servo has carried too much for too long, and shuts down.", todo: "Mend it (take the load off), clear the fault, torque on, release." },
  overheat: { whole: false, like: "A servo is too hot, and shuts down.", todo: "Mend it (let it cool), clear the fault, torque on, release." },
  low_voltage: { whole: false, like: "The supply is too weak.", todo: "Mend it: until then the servo complains and goes on." },
  encoder_glitch: { whole: false, like: "One reading in twenty of the angle is wrong.", todo: "Mend it. Such readings are thrown away: watch them turn stale." },
  load_offset: { whole: false, like: "A hand holds something: the load has an offset.", todo: "Mend it (put it down), and watch the load of the joint." },
  slow: { whole: false, like: "A servo is slow in what it does.", todo: "Mend it, and watch the joint lag behind no more." },
  wrong_model: { whole: false, like: "A servo of another model was put in.", todo: "Pull the cable and mend it: it is found when the daemon connects." },
  wrong_firmware: { whole: false, like: "A servo with old firmware was put in.", todo: "Pull the cable and mend it: it is found when the daemon connects." },
  id_clash: { whole: false, like: "Two servos have the same id.", todo: "Mend it, clear the fault, release: until then both are silent." },
  narrow_limits: { whole: false, like: "A servo keeps narrower limits than the config.", todo: "Mend it: it is found when the daemon connects, or the joint stops early." },
  watchdog: { whole: false, like: "A servo has stopped by its own watchdog.", todo: "Mend it, clear the fault, release." },
};

const UNKNOWN = { whole: false, like: "A fault of this simulator's own.", todo: "See what the arm says, mend it, clear the fault." };

/** @param {string} fault one of get_info's faults */
export function practiceOf(fault) {
  return PRACTICE[fault] ?? UNKNOWN;
}
