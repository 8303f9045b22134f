// @ts-check
/** Faults that a simulated arm can be given, what each is like on a real one, and what it needs: pure. */

/** `whole`: it befalls the whole arm and takes no joint. */
export const PRACTICE = {
  cable: { whole: true, like: "The USB cable is pulled.", todo: "Plug it in (mend), clear the fault, release." },
  power: { whole: true, like: "The arm's supply fails: joints go limp and forget their settings.", todo: "Mend it, clear the fault, torque on, release." },
  noise: { whole: true, like: "The cable picks up noise: messages are lost and garbled.", todo: "Readings turn stale; the arm goes on, or stops and must be cleared." },
  silent: { whole: false, like: "A servo no longer answers.", todo: "Mend it, clear the fault, release." },
  stuck: { whole: false, like: "A gearbox jams: the joint moves neither way.", todo: "Let go, mend it; an overload may follow." },
  blocked: { whole: false, like: "Something stands in the joint's way.", todo: "Move back; the joint holds against the load." },
  reboot: { whole: false, like: "A loose plug resets the servo: its torque is gone.", todo: "Clear the fault, torque on, release." },
  overload: { whole: false, like: "A servo has carried too much for too long, and shuts down.", todo: "Mend it (take the load off), clear the fault, torque on, release." },
  overheat: { whole: false, like: "A servo is too hot, and shuts down.", todo: "Mend it (let it cool), clear the fault, torque on, release." },
  low_voltage: { whole: false, like: "The supply is too weak.", todo: "The servo complains and goes on: mend it." },
  encoder_glitch: { whole: false, like: "One reading in twenty of the angle is wrong.", todo: "Such readings are thrown away: watch them turn stale." },
  load_offset: { whole: false, like: "A hand holds something: the load has an offset.", todo: "Watch the load of the joint." },
  slow: { whole: false, like: "A servo answers late in what it does.", todo: "Watch the joint lag behind." },
  wrong_model: { whole: false, like: "A servo of another model was put in.", todo: "It is found when the daemon connects: pull the cable and mend it." },
  wrong_firmware: { whole: false, like: "A servo with old firmware was put in.", todo: "It is found when the daemon connects: pull the cable and mend it." },
  id_clash: { whole: false, like: "Two servos have the same id.", todo: "Both are silent: mend it, clear the fault, release." },
  narrow_limits: { whole: false, like: "A servo keeps narrower limits than the config.", todo: "It is found when the daemon connects, or the joint stops early." },
  watchdog: { whole: false, like: "A servo has stopped by its own watchdog.", todo: "Mend it, clear the fault, release." },
};

const UNKNOWN = { whole: false, like: "A fault of this simulator's own.", todo: "See what the arm says, mend it, clear the fault." };

/** @param {string} fault one of get_info's faults */
export function practiceOf(fault) {
  return PRACTICE[fault] ?? UNKNOWN;
}
