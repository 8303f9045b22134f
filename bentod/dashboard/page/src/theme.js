// Dark, light, or as the system says.
import { button, say } from "./dom.js";

const NEXT = { system: "dark", dark: "light", light: "system" };

export function themeButton(app) {
  const chosen = app.setting("theme", "system");
  const element = button("", () => show(NEXT[chosen.get()]), { id: "theme", class: "plain" });
  function show(theme) {
    chosen.set(theme);
    document.documentElement.dataset.theme = theme;
    say(element, `Colours: ${theme}`);
    dispatchEvent(new Event("themechange"));
  }
  show(chosen.get() in NEXT ? chosen.get() : "system");
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => dispatchEvent(new Event("themechange")));
  return element;
}
