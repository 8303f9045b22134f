/** The arm in 3D as it is, as a ghost where it is expected, and as lines where there is no WebGL. */

import { ArmControls } from "./arm3d_controls.js";
import { Schematic } from "./arm3d_schematic.js";
import { alike, picture } from "./arm3d_state.js";
import { el } from "./dom.js";
import { rangesOf } from "./joints_bar.js";
import { Model, Stage } from "./scene.js";
import { inOneBreath, sentences } from "./sentences.js";
import { around } from "./sentences_around.js";
import { angleWord } from "./sentences_words.js";
import { sentence, words } from "./units.js";
import "./arm3d.css";

/** ms between two changes of what is said of the picture. */
const BREATH = 2000;

const CANVAS = {
  class: "arm3d-canvas",
  tabindex: 0,
  role: "img",
  "aria-label": "The arm",
  "aria-describedby": "arm3d-hint",
  title: "Drag or arrow keys: turn the view. + and −: zoom. Home: as at first.",
};

const URDF = "models/arm.urdf";

/** @returns {HTMLElement} */
export function armView(app) {
  const view = new ArmView(app);
  app.arm3d = view;
  app.onFrame((frame) => view.show(frame), { element: view.element });
  app.onLink(() => view.link());
  return view.element;
}

class ArmView {
  /** @type {Model | null} */ model = null;
  /** @type {Stage | null} */ stage = null;
  lost = false;
  strange = false;
  picture = null;
  said = -Infinity;
  info = null;

  constructor(app) {
    this.app = app;
    this.canvas = el("canvas", CANVAS);
    this.label = el("div", { class: "arm3d-label" });
    this.box = el("div", { class: "arm3d-stage" }, this.canvas, this.label);
    this.schematic = new Schematic();
    this.controls = new ArmControls(app, this);
    this.element = el("div", { class: "arm3d" }, this.box, this.schematic.element, this.controls.element);
    this.ready = this.#load();
  }

  /** Hide what is no longer known, or show what is again. */
  link() {
    this.element.classList.toggle("arm3d-old", !this.app.linkState.daemon);
    this.said = -Infinity;
    this.show(this.app.frame);
  }

  /** Take in a frame of get_state; draws only if it looks different from the last one. */
  show(frame) {
    if (!frame) return;
    this.#describe(frame);
    const next = picture(frame, this.app.linkState.daemon);
    if (this.info !== this.app.info) this.range();
    if (alike(this.picture, next)) return;
    this.picture = next;
    this.model?.show(next);
    this.draw();
  }

  /** Matrices of the links by name, as in `pose` of scene_robot.js; of the arm as it is. */
  pose() {
    return this.model?.pose() ?? {};
  }

  /** The same of the arm where it is expected; null while nothing else is expected. */
  ghostPose() {
    return this.picture?.ghost ? (this.model?.ghostPose() ?? null) : null;
  }

  /** How often the arm was drawn in 3D. */
  get drawn() {
    return this.stage?.drawn ?? 0;
  }

  /** Whether lines are shown instead, by choice or for want of WebGL. */
  get flat() {
    return !this.stage || this.lost || this.strange || this.controls.wantsLines;
  }

  draw() {
    this.box.hidden = this.flat;
    this.schematic.element.hidden = !this.flat;
    this.controls.show(this.flat, this.stage !== null && !this.lost && !this.strange);
    if (!this.picture) return;
    if (this.flat) {
      this.schematic.show(this.strange ? null : this.model, this.picture);
      return;
    }
    this.stage.draw();
    this.#label();
  }

  /** Take the limits from what is known of the arm, and show them if they are wanted. */
  range() {
    this.info = this.app.info;
    const ranges = rangesOf(this.info);
    this.#compare(Object.keys(ranges));
    this.schematic.range(ranges);
    this.model?.range(ranges, this.controls.wantsLimits);
    this.paint();
  }

  /** A drawing of some other arm would mislead. */
  #compare(names) {
    const missing = names.filter((name) => this.model && !(name in this.model.robot.joints));
    this.strange = missing.length > 0 && missing.length === names.length;
    if (missing.length) this.controls.note(`Not in the drawing: ${missing.map(words).join(", ")}.`);
  }

  /** Take the colours of the page's theme. */
  paint() {
    this.stage?.paint(this.controls.colours());
    this.draw();
  }

  async #load() {
    try {
      const answer = await fetch(URDF);
      if (!answer.ok) throw new Error(`the server says ${answer.status}`);
      this.model = new Model(await answer.text());
    } catch (error) {
      this.controls.note(`The drawing of the arm cannot be had: ${error.message}.`);
    }
    if (this.model) this.#begin(this.model);
    if (this.picture) this.model?.show(this.picture);
    this.range();
  }

  #begin(model) {
    try {
      this.stage = new Stage(this.canvas, model, () => this.draw());
    } catch {
      this.controls.note("This browser has no WebGL: the arm is drawn as lines.");
      return;
    }
    this.canvas.addEventListener("webglcontextlost", (event) => this.#lose(event));
    this.canvas.addEventListener("webglcontextrestored", () => this.#regain());
    new ResizeObserver(() => this.#resize()).observe(this.box);
    this.controls.watchTheme();
    this.#resize();
  }

  #lose(event) {
    event.preventDefault(); // so that it may come back
    this.lost = true;
    this.controls.note("The graphics were lost: the arm is drawn as lines until they are back.");
    this.draw();
  }

  #regain() {
    this.lost = false;
    this.controls.note("");
    this.draw();
  }

  #resize() {
    this.stage?.resize(this.box.clientWidth, this.box.clientHeight);
    this.draw();
  }

  /** What is seen, in words: seldom enough to be listened to. */
  #describe(frame) {
    const now = performance.now();
    if (now - this.said < BREATH) return;
    this.said = now;
    this.canvas.setAttribute("aria-label", `The arm. ${inOneBreath(sentences(frame, around(this.app)))}`);
  }

  #label() {
    const { attended, angles } = this.picture;
    this.label.hidden = !(attended in angles);
    if (this.label.hidden) return;
    this.label.textContent = `${sentence(words(attended))} ${angleWord(angles[attended])}`;
  }
}
