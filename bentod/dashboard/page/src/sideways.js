// @ts-check
// Whatever is wider than the room it has says so: on a phone nothing else shows that it can be moved sideways.
import "./sideways.css";

/** `element`: scrolls sideways when it must. @template {HTMLElement} T @param {T} element @returns {T} */
export function sideways(element) {
  const look = () => element.classList.toggle("sideways", element.scrollWidth > element.clientWidth + 1);
  const watch = new ResizeObserver(look);
  const watchAll = () => [element, ...element.children].forEach((one) => watch.observe(one));
  new MutationObserver(watchAll).observe(element, { childList: true });
  watchAll();
  return element;
}
