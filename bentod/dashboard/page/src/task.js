// @ts-check
// Tasks in the plane of two joints (thesis 5.4, 5.5), done live; without a task, the two joints as they are.
import { el, say, section } from "./dom.js";
import { JointSpace } from "./jointspace.js";
import { KeysDrive } from "./keys_drive.js";
import { sideways } from "./sideways.js";
import { TaskChoice } from "./task_choice.js";
import { lapTable, summary } from "./task_tables.js";
import { advice, described } from "./task_words.js";
import { number, seconds } from "./units.js";
import "./task.css";

const QUIET = 2000; // ms between two sentences for screen readers

/** @returns {HTMLElement} */
export function taskPanel(app) {
  return new TaskPanel(app).element;
}

class TaskPanel {
  constructor(app) {
    this.app = app;
    /** @type {any[]} */ this.tasks = [];
    this.chosen = app.setting("task.chosen", "");
    this.done = -1;
    this.spoken = 0;
    this.space = new JointSpace(app);
    this.drive = new KeysDrive(app, this.space.element);
    this.choice = new TaskChoice(app, {
      onTask: (name) => (this.chosen.set(name), this._show()),
      onPair: () => this._show(),
      onStart: () => this._start(),
      onStop: () => this._stop(),
    });
    this.element = section("Task", this.choice.element, this._status(), this.space.element, this._below());
    app.onTick((frame) => this._take(frame));
    app.onFrame((frame) => this._draw(frame), { element: this.element });
    app.onRole(() => void this._load());
  }

  /** The task that is shown: the one under way, else the chosen one; null for none. */
  get task() {
    const name = this.busy ? this.state.task : this.chosen.get();
    return this.tasks.find((one) => one.name === name) ?? null;
  }

  get state() {
    return this.app.told.task ?? null;
  }

  get busy() {
    return Boolean(this.state && this.state.phase !== "over");
  }

  _status() {
    this.mark = el("span", { class: "task-mark", "aria-hidden": "true" });
    this.advice = el("span", { class: "task-advice" });
    this.circuit = el("dd", { text: "–" });
    this.clock = el("dd", { text: "–" });
    this.contacts = el("dd", { text: "–" });
    const pairs = [["Circuit", this.circuit], ["Time", this.clock], ["Contacts", this.contacts]];
    this.numbers = el("dl", { class: "task-numbers" }, ...pairs.map(([name, dd]) => el("div", {}, el("dt", { text: name }), dd)));
    return el("div", { class: "task-status" }, el("p", { class: "task-now" }, this.mark, this.advice), this.numbers);
  }

  _below() {
    this.live = el("p", { class: "visually-hidden", "aria-live": "polite" });
    this.problems = el("p", { class: "task-problems", hidden: true });
    this.summary = el("p", { class: "task-summary" });
    this.laps = sideways(el("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": "Circuits of this run" }));
    const legend = el("p", { class: "soft task-legend", text: "● is the arm, the yellow ◆ where it is expected, the strip which way the active joint can go." });
    return el("div", {}, this.live, this.drive.hint, this.drive.element, legend, this.problems, this.summary, this.laps);
  }

  async _load() {
    if (!this.app.can("dashboard.tasks")) return this._show();
    const told = await this.app.act("dashboard.tasks");
    if (!told) return;
    this.tasks = told.tasks;
    say(this.problems, told.problems.join(" "));
    this.problems.hidden = told.problems.length === 0;
    this.choice.fill(told.tasks, told.state && told.state.phase !== "over" ? told.state.task : this.chosen.get());
    this._show();
    this._tabulate(told.laps);
  }

  /** Show what is chosen. */
  _show() {
    const task = this.task;
    const pair = task ? task.joints : this.choice.joints2;
    const limits = pair.map((name) => this.app.info.joints.find((joint) => joint.name === name));
    const bounds = task ? task.bounds : limits.map((joint) => [joint.min_rad, joint.max_rad]);
    this.shown = `${task?.name} ${pair}`;
    this.space.show(pair, bounds, task);
    this.space.element.setAttribute("aria-label", `Joint space of ${pair.join(" and ").replaceAll("_", " ")}`);
    const group = Object.entries(this.app.info.groups).find(([, joints]) => pair.every((name) => joints.includes(name)));
    this.drive.drive(pair, group?.[0] ?? "");
  }

  async _start() {
    const mode = this.choice.condition.value;
    const assist = this.app.frame?.assist;
    const asked = { mode, ...(assist?.group ? { group: assist.group } : {}) };
    if (mode && (await this.app.act("assist_set", asked)) === undefined) return;
    const helps = mode || assist?.mode || "off";
    const condition = helps === "off" ? "manual" : helps;
    await this.app.act("dashboard.task_start", { task: this.chosen.get(), name: this.choice.name.value, condition });
    this.space.element.focus();
  }

  async _stop() {
    await this.app.act("dashboard.task_stop");
  }

  /** Also while nobody looks: another page may begin a task. */
  _take(frame) {
    if (this.busy && this.task && this.shown !== `${this.task.name} ${this.task.joints}`) {
      this.choice.task.value = this.task.name;
      this._show();
    }
    if (this.busy && !this.task && !this.loading) {
      this.loading = this._load().finally(() => (this.loading = null)); // a task that this page does not know yet
    }
    this._sound();
    const done = this.state?.done ?? 0;
    if (done === this.done) return;
    this.done = done;
    void this._fetch(frame);
  }

  /** Before the trial nobody hears of marks, and yet the start is a place. */
  _sound() {
    const reached = this.state?.phase === "approach" && this.state.inside;
    if (reached && !this.reached) this.app.sound?.("waypoint");
    this.reached = reached;
  }

  async _fetch() {
    if (!this.app.can("dashboard.task_laps") || !this.state) return;
    const laps = await this.app.act("dashboard.task_laps");
    if (laps) this._tabulate(laps);
  }

  _tabulate(laps) {
    const task = this.tasks.find((one) => one.name === this.state?.task) ?? this.task;
    this.laps.hidden = !task || !laps.length;
    say(this.summary, summary(laps));
    if (task) this.laps.replaceChildren(lapTable(task, laps));
  }

  _draw(frame) {
    const { task, state } = this;
    const other = frame.trial && !this.busy;
    this.choice.offer(frame.assist?.mode);
    this.choice.allow({ task, busy: this.busy || (Boolean(frame.trial) && Boolean(task)), mine: this.busy });
    const mine = state && task && state.task === task.name ? state : null;
    const { mark, text } = other && task ? foreign(frame.trial) : advice(task, mine);
    say(this.mark, mark);
    say(this.advice, task?.problem || text);
    this.numbers.hidden = !task;
    const begun = mine && (mine.phase === "running" || (mine.phase === "over" && mine.trial)); // the last one's stay
    say(this.circuit, begun ? number(mine.number, 0) : "–");
    say(this.clock, begun ? seconds(mine.time) : "–");
    say(this.contacts, mine && mine.trial ? number(mine.contacts_in_all, 0) : "–");
    this.element.dataset.phase = mine?.phase ?? "free";
    this._speak(frame, mine);
  }

  _speak(frame, mine) {
    const now = performance.now();
    if (now - this.spoken < QUIET) return;
    this.spoken = now;
    say(this.live, described(this.space.pair, this.space.look(frame), this.task, mine));
  }
}

/** A trial that this server does not watch: begun elsewhere, or before the server was started again. */
function foreign(trial) {
  const text = `Trial ${trial.number} (${trial.name}) runs, and its circuits are not watched: it was begun elsewhere, or before this page's server was started again. Stop it to begin a task.`;
  return { mark: "!", text };
}
