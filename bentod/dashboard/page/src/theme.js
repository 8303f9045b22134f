// Dark, light, or as the system says.
import { button, say } from "./dom.js";
import { setting } from "./settings.js";

const NEXT = { system: "dark", dark: "light", light: "system" };

const chosen = setting("theme", "system");
const system = matchMedia("(prefers-color-scheme: dark)");

const theme = () => (chosen.get() in NEXT ? chosen.get() : "system");

/** Have the page in its colours, and whoever draws hear of it; again whenever the system changes its mind. */
export function applyTheme() {
  const dark = theme() === "system" ? system.matches : theme() === "dark";
  document.documentElement.dataset.theme = dark ? "dark" : "light";
  dispatchEvent(new Event("themechange"));
}

system.addEventListener("change", applyTheme);

export function themeButton() {
  const element = button("", () => (chosen.set(NEXT[theme()]), show()), { id: "theme", class: "plain" });
  function show() {
    applyTheme();
    say(element, `Colours: ${theme()}`);
  }
  show();
  return element;
}
