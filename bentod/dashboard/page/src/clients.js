// @ts-check
/** Who is connected to the daemon and to this page's server, and how well frames get through. */

import { el, say, section } from "./dom.js";
import { Delay } from "./clients_delay.js";
import { factList } from "./health_timing.js";
import { sideways } from "./sideways.js";
import { asking, atMost } from "./sparing.js";
import { seconds } from "./units.js";

const SECOND = 1000; // ms
const COLUMNS = ["Name", "User", "May", "Missed"];

/** @returns {HTMLElement} */
export function clientsPart(app) {
  const own = factList(["Frames received", "Left out, because this page was slow", "Delay beyond the quickest frame", "The server answers within", "Browsers"]);
  const head = el("tr", {}, ...COLUMNS.map((title) => el("th", { scope: "col", text: title })));
  const body = el("tbody", {});
  const table = sideways(el("div", { class: "scroll", tabindex: 0, role: "group", "aria-label": "Clients of the daemon" }, el("table", { class: "clients-table" }, el("thead", {}, head), body)));
  const element = section("Connections", el("h3", { text: "This page" }), own.element, el("h3", { text: "Clients of the daemon" }), table);
  const delay = new Delay();
  const server = { browsers: "–", answered: NaN, began: 0 };
  app.onTick((frame) => delay.add(performance.now() / 1000, frame.time));
  app.onFrame(atMost(SECOND / 2, () => own.show(ownFigures(app, delay, server))), { element });
  asking(app, element, () => SECOND, () => ["list_clients", {}], (clients) => fill(body, clients));
  const question = () => ((server.began = performance.now()), /** @type {[string, object]} */ (["dashboard.stats", {}]));
  asking(app, element, () => SECOND, question, ({ browsers }) => {
    server.browsers = String(browsers);
    server.answered = (performance.now() - server.began) / 1000;
  });
  return element;
}

function ownFigures(app, delay, { browsers, answered }) {
  const { received, skipped } = app.stats;
  const late = delay.known ? `${seconds(delay.median)}; 99% within ${seconds(delay.most)}` : "–";
  return [String(received), String(skipped), late, seconds(answered), browsers];
}

function fill(body, clients) {
  while (body.children.length > clients.length) body.lastChild.remove();
  while (body.children.length < clients.length) body.append(el("tr", {}, ...COLUMNS.map(() => el("td", {}))));
  clients.forEach((client, place) => {
    const missed = `${client.replaced_frames} frames, ${client.dropped_events} events`;
    const texts = [client.name, client.user, client.role === "operator" ? "move the arm" : "look", missed];
    texts.forEach((text, column) => say(body.children[place].children[column], text));
  });
}
