// Elements, made in one way. Text is only ever text: nothing that arrives becomes markup.

/**
 * @param {string} tag
 * @param {{class?: string, text?: string, title?: string, on?: Record<string, (event: any) => void>} & Record<string, any>} [given]
 *   `class`, `text`, `on` (listeners), `aria` and `data` (maps); everything else is an attribute; null and false leave it out.
 * @param {...(Node | string | null | undefined | false)} children
 */
export function el(tag, given = {}, ...children) {
  const element = document.createElement(tag);
  const { class: names, text, on = {}, aria = {}, data = {}, ...attributes } = given;
  if (names) element.className = names;
  if (text !== undefined) element.textContent = text;
  for (const [name, listener] of Object.entries(on)) element.addEventListener(name, listener);
  for (const [name, value] of Object.entries(aria)) setAttribute(element, `aria-${name}`, value);
  for (const [name, value] of Object.entries(data)) element.dataset[name] = value;
  for (const [name, value] of Object.entries(attributes)) setAttribute(element, name, value);
  element.append(...children.filter((child) => child || child === ""));
  return element;
}

function setAttribute(element, name, value) {
  const aria = name.startsWith("aria-");
  if (value === null || value === undefined || (value === false && !aria)) return;
  element.setAttribute(name, value === true && !aria ? "" : String(value));
}

/** Put `text` into `element`, if it says something else: screen readers and layout hear of every change. */
export function say(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

/** A button. `label` is what it says. */
export function button(label, onClick, given = {}) {
  return el("button", { type: "button", text: label, on: { click: onClick }, ...given });
}

/** A labelled part of the page: every panel is one. */
export function section(title, ...children) {
  const id = `section-${title.toLowerCase().replace(/\W+/g, "-")}`;
  return el("section", { class: "panel", "aria-labelledby": id }, el("h2", { id, text: title }), ...children);
}

/** An input with what it is for: before it, or behind a box to tick. */
export function field(label, input) {
  const told = el("span", { text: label });
  return el("label", { class: "field" }, ...(input.type === "checkbox" ? [input, told] : [told, input]));
}

/** A number field with its unit and bounds; `onChange` gets a number within them. */
export function numberField(label, unit, { value, min, max, step }, onChange) {
  const input = el("input", { type: "number", value, min, max, step, inputmode: "decimal" });
  input.addEventListener("change", () => {
    if (input.value !== "" && input.checkValidity()) onChange(Number(input.value));
    else input.reportValidity();
  });
  const field = el("label", { class: "field" }, el("span", { text: label }), input, el("span", { class: "unit", text: unit }));
  return Object.assign(field, { input });
}
