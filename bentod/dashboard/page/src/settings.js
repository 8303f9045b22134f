// What this browser remembers from visit to visit.

/** One thing to remember; a private window forgets it, and the page works without. */
export function setting(name, fallback) {
  const key = `bentod.${name}`;
  return {
    get() {
      try {
        return JSON.parse(localStorage.getItem(key)) ?? fallback;
      } catch {
        return fallback;
      }
    },
    set(value) {
      try {
        localStorage.setItem(key, JSON.stringify(value));
      } catch {
        // Nothing is kept.
      }
    },
  };
}
