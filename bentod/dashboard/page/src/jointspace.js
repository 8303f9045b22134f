// @ts-check
// Two joints as a plane, seen live: where the arm is, where it is expected, which way it can go, and what a task wants.
import { el } from "./dom.js";
import { words } from "./units.js";
import * as draw from "./jointspace_draw.js";
import { Path } from "./jointspace_path.js";
import { heightFor, Scale } from "./jointspace_scale.js";
import "./jointspace.css";

const INK = ["surface", "raised", "line", "text", "soft", "good", "warning", "bad", "series-1", "series-4"];
const MARGIN = { left: 58, right: 24, top: 36, bottom: 60 };

export class JointSpace {
  /** @param {any} app */
  constructor(app) {
    this.app = app;
    /** @type {any} a task's geometry, as the server tells it; null: the joints alone */
    this.task = null;
    /** @type {any} how far the task has come */
    this.state = null;
    this.pair = ["", ""];
    this.path = new Path();
    this.bounds = [[-1, 1], [-1, 1]];
    this.canvas = el("canvas", { class: "jointspace-canvas", "aria-hidden": "true" });
    this.element = el("div", { class: "jointspace", role: "application", tabindex: 0 }, this.canvas);
    this.element.view = this; // for tests
    this._drawn = "";
    this._readInk();
    new ResizeObserver(() => this._resize()).observe(this.element);
    addEventListener("themechange", () => (this._readInk(), this._again()));
    app.onTick((frame) => this._take(frame));
    app.onFrame((frame) => this._draw(frame), { element: this.element });
  }

  /** Show these joints. `bounds`: rad, lowest and highest of either; `task`: or null. */
  show(pair, bounds, task) {
    const same = JSON.stringify([pair, task?.name]) === JSON.stringify([this.pair, this.task?.name]);
    if (!same) this.path.clear();
    [this.pair, this.bounds, this.task] = [pair, bounds, task];
    this._resize();
  }

  /** Position and expectation (rad) of the two joints in a frame, and the strips that show which way they can go. */
  look(frame) {
    const rows = this.pair.map((name) => frame.joints.find((joint) => joint.name === name));
    if (!rows[0] || !rows[1]) return null;
    const seen = rows.every((row) => row.freshness !== "lost");
    const expected = rows.map((row) => longest(row.predictions) ?? row.position);
    const known = rows.some((row) => longest(row.predictions) !== undefined);
    return { position: rows.map((row) => row.position), expected: known ? expected : null, seen, axes: this.axes(frame) };
  }

  /** Which of the two joints their groups have active. */
  axes(frame) {
    const active = (name) => frame.groups.some((group) => group.joints.includes(name) && (group.together || group.active === name));
    return { across: active(this.pair[0]), up: active(this.pair[1]) };
  }

  _take(frame) {
    const look = this.look(frame);
    const state = this.task && this.app.told.task?.task === this.task.name ? this.app.told.task : null;
    if (!look?.seen) return;
    const [was, now] = [this.state, state];
    if (now && was && now.done > was.done) this.path.turn();
    if (now && was?.phase !== "running" && now.phase === "running") this.path.clear();
    this.path.add(look.position[0], look.position[1]);
    if (now?.touching && !was?.touching) this.path.touch(look.position[0], look.position[1]);
    this.state = state;
  }

  _resize() {
    const width = this.element.clientWidth;
    if (!width) return;
    const size = { width, height: heightFor(this.bounds, width) };
    const dpr = Math.min(devicePixelRatio || 1, 3);
    this.canvas.style.setProperty("height", `${size.height}px`);
    this.canvas.width = Math.round(size.width * dpr);
    this.canvas.height = Math.round(size.height * dpr);
    this.scale = new Scale(this.bounds, size, MARGIN);
    this.canvas.getContext("2d").setTransform(dpr, 0, 0, dpr, 0, 0);
    this._again();
  }

  _readInk() {
    const style = getComputedStyle(document.documentElement);
    this.ink = Object.fromEntries(INK.map((name) => [name, style.getPropertyValue(`--${name}`).trim()]));
  }

  _again() {
    this._drawn = "";
    if (this.app.frame) this._draw(this.app.frame);
  }

  _draw(frame) {
    const look = this.look(frame);
    if (!look || !this.scale) return;
    const shown = [look.position, look.expected].flat().map((angle) => angle && Math.round(angle * this.scale.perRad * 4));
    const { leg, phase, inside, resting, held, touching } = this.state ?? {};
    const key = JSON.stringify([shown, look.axes, look.seen, this.path.count, [leg, phase, inside, resting, held, touching]]);
    if (key === this._drawn) return;
    this._drawn = key;
    this._paint(look);
  }

  _paint(look) {
    const pen = /** @type {CanvasRenderingContext2D} */ (this.canvas.getContext("2d"));
    const { scale, ink, task, state, path } = this;
    pen.clearRect(0, 0, scale.size.width, scale.size.height);
    draw.drawAxes(pen, scale, ink, [`${words(this.pair[0])} →`, `↑ ${words(this.pair[1])}`]);
    if (task?.corridor) draw.drawCorridor(pen, scale, ink, task.corridor, Boolean(state?.touching));
    draw.drawBounds(pen, scale, ink);
    draw.drawStrip(pen, scale, ink, look.position, look.axes);
    if (task) this._paintTask(pen);
    draw.drawPath(pen, scale, ink, path.before, path.countBefore, true);
    draw.drawPath(pen, scale, ink, path.now, path.count, false);
    draw.drawContacts(pen, scale, ink, path.contacts);
    if (look.expected) draw.drawExpected(pen, scale, look.expected);
    pen.globalAlpha = look.seen ? 1 : 0.4;
    draw.drawPosition(pen, scale, look.position);
    pen.globalAlpha = 1;
  }

  _paintTask(pen) {
    const { scale, ink, task, state } = this;
    const busy = state && state.phase !== "over";
    const leg = busy ? state.leg : -1;
    const [from, to] = [task.order[Math.max(0, leg)], task.order[leg + 1]];
    const centre = (index) => task.places[index].centre;
    if (busy && leg >= 0 && !state.resting && !task.corridor) draw.drawGuide(pen, scale, ink, centre(from), centre(to), task.path);
    task.places.forEach((place, index) => {
      const aimed = index === to;
      const at = { aimed, inside: aimed && Boolean(busy && state.inside), resting: aimed && Boolean(busy && state.resting), held: state?.held ?? 0 };
      (place.inwards ? draw.drawBarrier : draw.drawSpot)(pen, scale, ink, place, at);
    });
  }
}

/** The prediction (rad) that looks farthest ahead; undefined without any. */
export function longest(predictions) {
  const keys = Object.keys(predictions ?? {});
  return keys.length ? predictions[keys.reduce((a, b) => (Number(b) > Number(a) ? b : a))] : undefined;
}
