/** The arm as lines, from the side and from above, with a bar for each joint: what needs no WebGL. */

import { el } from "./dom.js";
import { JointBar } from "./joints_bar.js";
import { angleWord } from "./sentences_words.js";
import { sentence, words } from "./units.js";

/** Which coordinates go right and up, and the part of the world that is seen: mm. */
const VIEWS = [
  { title: "From the side", right: 0, up: 2, box: [-40, -560, 640, 580] },
  { title: "From above", right: 0, up: 1, box: [-40, -480, 640, 960] },
];

export class Schematic {
  constructor() {
    this.views = VIEWS.map((view) => new View(view));
    this.rows = el("div", { class: "arm3d-bars" });
    const pictures = el("div", { class: "arm3d-views" }, ...this.views.map((view) => view.element));
    this.element = el("div", { class: "arm3d-schematic" }, pictures, this.rows);
    this.bars = new Map();
  }

  /** Bars for the joints of these ranges (rad, [lower, upper] by name). */
  range(ranges) {
    this.bars = new Map(Object.entries(ranges).map(([name, range]) => [name, new Row(name, range)]));
    this.rows.replaceChildren(...[...this.bars.values()].map((row) => row.element));
  }

  /** @param {import("./scene.js").Model | null} model null: only bars can be shown */
  show(model, picture) {
    for (const view of this.views) view.show(model, picture);
    for (const [name, row] of this.bars) {
      row.show(picture.angles[name], picture.ghost?.angles[name], name === picture.attended);
    }
  }
}

class View {
  constructor({ title, right, up, box }) {
    this.axes = [right, up];
    this.ghost = svg("polyline", { class: "arm3d-line-expected" });
    this.arm = svg("polyline", { class: "arm3d-line" });
    this.picture = svg("svg", { viewBox: box.join(" "), "aria-hidden": "true" }, this.ghost, this.arm);
    this.element = el("figure", { class: "arm3d-view" }, el("figcaption", { text: title }), this.picture);
  }

  show(model, picture) {
    this.element.hidden = model === null;
    if (model === null) return;
    this.arm.setAttribute("points", this.#points(model.chain, model.pose()));
    this.ghost.setAttribute("points", picture.ghost ? this.#points(model.chain, model.ghostPose()) : "");
  }

  #points(links, pose) {
    const [right, up] = this.axes;
    const corners = links.map((name) => pose[name].slice(12, 15));
    return corners.map((at) => `${(at[right] * 1000).toFixed(1)},${(-at[up] * 1000).toFixed(1)}`).join(" ");
  }
}

class Row {
  constructor(name, range) {
    this.bar = new JointBar(range);
    this.name = el("span", { class: "arm3d-bar-name", text: sentence(words(name)) });
    this.angle = el("span", { class: "arm3d-bar-angle" });
    this.element = el("div", { class: "arm3d-bar" }, this.name, this.bar.element, this.angle);
  }

  show(now, expected, attended) {
    this.bar.show(now, expected);
    this.angle.textContent = Number.isFinite(now) ? angleWord(now) : "–";
    this.element.classList.toggle("arm3d-bar-attended", attended);
  }
}

function svg(tag, attributes, ...children) {
  const node = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
  node.append(...children);
  return node;
}
