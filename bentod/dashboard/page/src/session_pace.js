// @ts-check
/** When things happen: again and again while somebody looks, or only when asked twice. */

import { button, say } from "./dom.js";

/** ms within which the second press must come. */
const SURE = 3000;

/** Call `act` at once when `element` comes into sight, and every `every` ms as long as it is. */
export function repeatedly(element, every, act) {
  let timer = 0;
  const step = () => {
    if (!document.hidden) act();
  };
  new IntersectionObserver((entries) => {
    clearInterval(timer);
    if (!entries.at(-1)?.isIntersecting) return;
    step();
    timer = setInterval(step, every);
  }).observe(element);
}

/** A button that acts on the second of two presses, which says so itself. */
export function askTwice(label, sure, act) {
  let asked = 0;
  const made = button(label, () => {
    clearTimeout(asked);
    if (made.textContent === sure) {
      say(made, label);
      act();
      return;
    }
    say(made, sure);
    asked = setTimeout(() => say(made, label), SURE);
  });
  return made;
}
