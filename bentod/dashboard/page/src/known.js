// What cannot work now is not offered, and what has just changed its meaning waits a moment.

/** ms for which a button that has turned round does nothing. */
const JUST = 600;

/** ms within which the second press must come. */
export const SURE = 4000;

/** Whoever meant the one, just as somebody else did it, must not do the other: `settled` a while after a change. */
export function guard() {
  let state = null;
  let since = -Infinity;
  return {
    see(now) {
      if (state !== null && now !== state) since = performance.now();
      state = now;
    },
    settled: () => performance.now() - since > JUST,
  };
}

/** Where one might let an arm fall, the second of two presses counts: `armed` while one more is enough. */
export function twice() {
  let asked = -Infinity;
  const armed = () => performance.now() - asked < SURE;
  return {
    armed,
    clear: () => (asked = -Infinity),
    /** Whether this press is the second. */
    press() {
      const second = armed();
      asked = second ? -Infinity : performance.now();
      return second;
    },
  };
}

/** Keep `element` disabled while the arm is not known, and while `may()` says no. */
export function whileKnown(app, element, may) {
  const show = () => (element.disabled = !app.linkState.daemon || app.replaying || !may());
  app.onFrame(show);
  app.onLink(show);
}
