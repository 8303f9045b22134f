// @ts-check
/** Joint groups: which joint of each is active, who drives it, and how it is switched and moved (thesis A.1.1). */

import { button, el, say, section } from "./dom.js";
import { percent, sentence, words } from "./units.js";
import "./groups.css";

const SHARES = { min: 5, max: 100, step: 5 };

/** @returns {HTMLElement} */
export function groupsPanel(app) {
  const panel = new GroupsPanel(app);
  app.onFrame((frame) => panel.show(frame), { element: panel.element });
  app.onRole(() => panel.rebuild());
  app.onLink(() => panel.show(app.frame));
  app.key("[", "Previous joint of the first group", () => panel.toggleFirst("backward"));
  app.key("]", "Next joint of the first group", () => panel.toggleFirst("forward"));
  return panel.element;
}

class GroupsPanel {
  /** @type {GroupCard[]} */ cards = [];
  shape = "";

  constructor(app) {
    this.app = app;
    this.share = app.setting("groups.share", 25);
    this.list = el("div", { class: "groups-list" });
    this.element = section("Groups", this.#speed(), this.list);
    this.element.classList.add("groups");
  }

  show(frame) {
    if (!frame) return;
    const shape = JSON.stringify(frame.groups.map(({ name, joints }) => [name, joints]));
    if (shape !== this.shape) this.#build(frame.groups, shape);
    for (const [place, card] of this.cards.entries()) card.show(frame.groups[place], frame);
  }

  /** Begin anew with the next frame: another role may do something else. */
  rebuild() {
    this.shape = "";
    this.show(this.app.frame);
  }

  toggleFirst(direction) {
    const group = this.app.frame?.groups[0]?.name;
    if (group && this.app.can("group_toggle")) void this.app.act("group_toggle", { group, direction });
  }

  #build(groups, shape) {
    this.shape = shape;
    for (const card of this.cards) card.leave();
    this.cards = groups.map((group, place) => new GroupCard(this.app, group, () => this.share.get() / 100, place === 0));
    this.list.replaceChildren(...this.cards.map((card) => card.element));
    this.element.hidden = !groups.length;
  }

  #speed() {
    const shown = el("output");
    const tell = () => say(shown, `${slider.value} % of the active joint's top speed`);
    const input = () => (this.share.set(Number(slider.value)), tell());
    const slider = el("input", { type: "range", ...SHARES, value: this.share.get(), on: { input } });
    tell();
    return el("label", { class: "groups-speed" }, "Push of − and + ", slider, shown);
  }
}

class GroupCard {
  /** @param {() => number} share of the joint's top speed, 0..1 @param {boolean} first whether keys toggle it */
  constructor(app, group, share, first) {
    this.app = app;
    this.name = group.name;
    this.joints = new Map(group.joints.map((joint) => [joint, this.#joint(joint)]));
    this.together = el("span", { class: "groups-together", hidden: true, text: "▸ all together" });
    this.driver = el("span", { class: "groups-driver" });
    this.effort = new EffortBar(group.name);
    this.order = el("p", { class: "groups-order soft", hidden: true });
    this.toggles = [this.#toggle("◀ Back", "backward", first && "["), this.#toggle("Forward ▶", "forward", first && "]")];
    this.pushes = [this.#push("−", -1, share), this.#push("+", 1, share)];
    const title = el("h3", { text: sentence(words(group.name)) });
    const rows = el("ol", { class: "groups-joints" }, ...[...this.joints.values()].map(({ row }) => row));
    const bar = el("div", { class: "groups-actions" }, this.toggles[0], this.pushes[0], this.pushes[1], this.toggles[1]);
    const label = `Group ${words(group.name)}`;
    this.element = el("div", { class: "groups-card", role: "group", "aria-label": label, data: { group: group.name } }, el("div", { class: "groups-head" }, title, this.together, this.driver), rows, this.effort.element, bar, this.order);
  }

  show(group, frame) {
    for (const [name, { choose, mark }] of this.joints) {
      const active = name === group.active && !group.together;
      choose.setAttribute("aria-pressed", String(active));
      choose.disabled = !this.app.linkState.daemon || !this.app.can("group_activate");
      say(mark, active ? "▸ active" : group.together ? "▸ moves along" : "");
    }
    this.together.hidden = !group.together;
    const known = this.app.linkState.daemon;
    say(this.driver, known ? driverWords(group, frame) : "not known now");
    this.effort.show(known ? group.effort : NaN);
    this.#allow(group, frame);
    this.#explain(frame);
  }

  /** Whatever is held is let go. */
  leave() {
    for (const push of this.pushes) push.dispatchEvent(new Event("blur"));
  }

  #allow(group, frame) {
    for (const toggle of this.toggles) toggle.disabled = !this.app.linkState.daemon || !this.app.can("group_toggle");
    const moved = frame.joints.filter(({ name }) => (group.together ? group.joints.includes(name) : name === group.active));
    const off = !this.app.linkState.daemon || !this.app.can("group_command") || moved.some(({ mode }) => mode !== "active");
    for (const push of this.pushes) {
      if (off && !push.disabled) push.dispatchEvent(new Event("blur"));
      push.disabled = off;
    }
  }

  /** Where an assist orders the joints, in its own words: toggles then do not follow the list. */
  #explain(frame) {
    const helps = [frame.assist, ...(frame.more_assists ?? [])].find((assist) => assist?.group === this.name && assist.mode.includes("adaptive_switching"));
    this.order.hidden = !helps;
    if (helps) say(this.order, `Toggles go where the assist expects it: ${helps.reason}`);
  }

  #joint(name) {
    const mark = el("span", { class: "groups-mark" });
    const activate = () => this.app.act("group_activate", { group: this.name, joint: name });
    const choose = el("button", { type: "button", class: "groups-joint", data: { joint: name }, on: { click: activate }, title: "Make it the active joint" }, el("span", { text: sentence(words(name)) }), mark);
    return { choose, mark, row: el("li", {}, choose) };
  }

  #toggle(text, direction, key) {
    const press = () => this.app.act("group_toggle", { group: this.name, direction });
    const label = `${direction === "forward" ? "Next" : "Previous"} joint of ${words(this.name)}`;
    return button(text, press, { class: `groups-${direction}`, "aria-label": `${text.replace(/[◀▶]/g, "").trim()}: ${label}`, title: key ? `${label} (${key})` : label, "aria-keyshortcuts": key || null });
  }

  #push(sign, way, share) {
    const label = `Hold ${sign}: push the active joint of ${words(this.name)} to ${way > 0 ? "higher" : "lower"} angles`;
    const push = button(`Hold ${sign}`, () => {}, { class: `groups-push hold groups-${way > 0 ? "plus" : "minus"}`, "aria-label": label });
    return this.app.holdButton(push, `group ${this.name} ${sign}`, () => ["group_command", { group: this.name, effort: way * share() }]);
  }
}

/** Effort from −100 to 100 %, from the middle to the side that it pushes to. */
class EffortBar {
  constructor(name) {
    this.fill = el("span", { class: "groups-fill" });
    this.word = el("span", { class: "groups-effort" });
    const meter = { role: "meter", "aria-label": `Effort in ${words(name)}`, "aria-valuemin": -100, "aria-valuemax": 100, "aria-valuenow": 0 };
    this.bar = el("div", { class: "groups-bar", ...meter }, this.fill);
    this.element = el("div", { class: "groups-gauge" }, this.bar, this.word);
  }

  show(effort) {
    const shown = Math.round(100 * (effort || 0));
    const half = Math.min(Math.abs(shown), 100) / 2;
    this.fill.style.setProperty("width", `${half}%`);
    this.fill.style.setProperty("left", `${shown < 0 ? 50 - half : 50}%`);
    this.bar.setAttribute("aria-valuenow", String(shown));
    say(this.word, `effort ${shown > 0 ? "+" : ""}${percent(effort)}`);
  }
}

const WAITS = { paused: "○ paused", limp: "○ limp", holding: "○ holding still", fault: "○ stopped by a fault" };

/** Who drives a group; while it waits, that. */
function driverWords({ operator, active }, frame) {
  const mode = frame.mode === "active" ? frame.joints.find(({ name }) => name === active)?.mode : frame.mode;
  if (mode in WAITS) return WAITS[mode];
  if (!operator) return "○ nobody drives it";
  if (operator === "emg") return "● driven by the muscles";
  const [kind, name] = operator.split(":");
  return kind === "client" ? `● driven by ${name ?? "a client"}` : `● driven by ${words(kind)}`;
}
