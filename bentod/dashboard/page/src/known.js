// What cannot work now is not offered, and what has just changed its meaning waits a moment.

/** Whoever meant the one, just as somebody else did it, must not do the other: `settled` a while after a change. */
export function guard(wait) {
  let state = null;
  let since = -Infinity;
  return {
    see(now) {
      if (state !== null && now !== state) since = performance.now();
      state = now;
    },
    settled: () => performance.now() - since > wait,
  };
}

/** Keep `element` disabled while the arm is not known, and while `may()` says no. */
export function whileKnown(app, element, may) {
  const show = () => (element.disabled = !app.linkState.daemon || app.replaying || !may());
  app.onFrame(show);
  app.onLink(show);
}
