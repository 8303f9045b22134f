// The token comes in the address's fragment, which is sent nowhere, and is then taken out of it.
import { button, el } from "./dom.js";

const KEPT = "bentod.token";

/** The token of this tab; empty when there is none. */
export function takeToken() {
  const given = location.hash.slice(1);
  if (given) {
    sessionStorage.setItem(KEPT, given);
    history.replaceState(null, "", location.pathname);
  }
  return sessionStorage.getItem(KEPT) ?? "";
}

/** What is shown to somebody without a token. */
export function signIn(refused) {
  const input = el("input", { type: "password", id: "token", autocomplete: "off", required: true, size: 44 });
  const enter = (event) => {
    event.preventDefault();
    sessionStorage.setItem(KEPT, input.value.trim().split("#").pop());
    location.reload();
  };
  const why = refused ? "That token is not valid (any more)." : "This page needs the address that bentod dashboard printed, with its token.";
  return el(
    "main",
    { class: "signin" },
    el("h1", { text: "bentod" }),
    el("p", { text: why }),
    el("p", { text: "In a terminal, bentod watch shows the page's address, and bentod ctl stop stops the arm." }),
    el("form", { on: { submit: enter } }, el("label", { for: "token", text: "Token, or the whole address" }), input, button("Enter", enter, { type: "submit" })),
  );
}
