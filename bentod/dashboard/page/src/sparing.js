// @ts-check
/** Work that is done seldom: at most so often, and questions only while somebody sees the answer. */

/** `work`, but not again within `ms`; what is left out is not made up for. */
export function atMost(ms, work) {
  let last = -Infinity;
  return (...given) => {
    const now = performance.now();
    if (now - last < ms) return;
    last = now;
    work(...given);
  };
}

/**
 * Ask the daemon again and again while `element` is in sight and frames arrive, never twice at a time.
 * @param {() => number} period ms from one question to the next
 * @param {() => [string, object]} question method and parameters
 * @param {(answer: any) => void} take
 * @param {(error: Error) => void} [refused] what stands there is old until the next answer
 * @returns {() => Promise<void>} asks now
 */
export function asking(app, element, period, question, take, refused = () => {}) {
  let open = false;
  let due = 0;
  const ask = async () => {
    if (open) return;
    open = true;
    try {
      take(await app.call(...question()));
    } catch (error) {
      refused(/** @type {Error} */ (error));
    }
    open = false;
    due = performance.now() + period();
  };
  app.onFrame(() => void (performance.now() >= due && ask()), { element });
  return ask;
}
