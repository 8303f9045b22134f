// @ts-check
// What is to be done and under which condition: the task, who helps, and what the trial is called.
import { button, el, field } from "./dom.js";
import { words } from "./units.js";

const FREE = "";

export class TaskChoice {
  /** `onTask(name)`: a task was chosen; `onPair(pair)`: joints for the plain view; both until `start` is pressed. */
  constructor(app, { onTask, onPair, onStart, onStop }) {
    this.app = app;
    this.pair = app.setting("task.pair", null);
    this.task = el("select", { id: "task-choice", on: { change: () => onTask(this.task.value) } });
    this.axes = [0, 1].map(() => el("select", { on: { change: () => onPair(this._picked()) } }));
    this.condition = el("select", { id: "task-condition" });
    this.name = el("input", { type: "text", maxlength: 64, size: 14, placeholder: "as the task" });
    this.start = button("Start", onStart, { class: "primary", id: "task-start" });
    this.stop = button("Stop the task", onStop, { id: "task-stop" });
    this.joints = el("span", { class: "row" }, field("Across", this.axes[0]), field("Up", this.axes[1]));
    this.trial = el("span", { class: "row" }, field("Condition", this.condition), field("Trial", this.name));
    this.element = el("div", { class: "row task-choice" }, field("Task", this.task), this.joints, this.trial, this.start, this.stop);
    this._fillAxes();
  }

  /** `tasks`: as the server tells them. */
  fill(tasks, chosen) {
    const options = tasks.map((task) => el("option", { value: task.name, text: task.problem ? `${task.title} (does not fit)` : task.title }));
    this.task.replaceChildren(el("option", { value: FREE, text: "none: joints only" }), ...options);
    this.task.value = tasks.some((task) => task.name === chosen) ? chosen : FREE;
  }

  /** The joints of the plain view, as they were chosen last. */
  get joints2() {
    const known = this.app.info.joints.map((joint) => joint.name);
    const kept = this.pair.get();
    return Array.isArray(kept) && kept.every((name) => known.includes(name)) && kept[0] !== kept[1] ? kept : known.slice(0, 2);
  }

  /** The modes of the assist that a trial may be done under; `mode`: the one that is on. */
  offer(mode) {
    const modes = [...new Set([mode, "dpcc"])].filter((one) => one && one !== "off");
    const told = JSON.stringify([modes, this.app.can("assist_set")]);
    if (this._offered === told) return;
    this._offered = told;
    const kept = this.condition.value;
    const helped = modes.map((one) => el("option", { value: one, text: `assist: ${words(one)}` }));
    const asItIs = el("option", { value: "", text: "assist as it is" });
    const manual = el("option", { value: "off", text: "manual (assist off)" });
    this.condition.replaceChildren(asItIs, ...(this.app.can("assist_set") && modes.length ? [manual, ...helped] : []));
    this.condition.value = [...this.condition.options].some((one) => one.value === kept) ? kept : "";
  }

  /** What may be pressed. `busy`: a task, or another trial, is under way. */
  allow({ task, busy, mine }) {
    this.joints.hidden = Boolean(task);
    this.trial.hidden = !task || mine;
    this.start.hidden = !task || mine;
    this.stop.hidden = !busy;
    this.start.disabled = !this.app.can("dashboard.task_start") || busy || Boolean(task?.problem);
    this.stop.disabled = !this.app.can("dashboard.task_stop");
    this.task.disabled = mine;
  }

  _fillAxes() {
    for (const [axis, select] of this.axes.entries()) {
      select.replaceChildren(...this.app.info.joints.map(({ name }) => el("option", { value: name, text: words(name) })));
      select.value = this.joints2[axis];
    }
  }

  _picked() {
    const [across, up] = this.axes.map((select) => select.value);
    if (across !== up) this.pair.set([across, up]);
    else this._fillAxes();
    return this.joints2;
  }
}
