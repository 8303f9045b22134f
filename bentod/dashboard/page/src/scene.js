/** The stage on which the arm is drawn: light, floor, camera and renderer. It draws when it is told to. */

import { Color, DirectionalLight, GridHelper, HemisphereLight, Scene, WebGLRenderer } from "three";
import { Arcs, Ring } from "./scene_marks.js";
import { Orbit } from "./scene_orbit.js";
import { Ghost, chain, pose, readRobot, turn } from "./scene_robot.js";

/** More pixels than this are not seen, and cost a phone its battery. */
const FINEST = 2;

const CONTEXT = { alpha: true, antialias: true, powerPreference: "low-power" };

/** The arm, where it is expected, and its marks: works without WebGL, for who wants to know where things are. */
export class Model {
  constructor(urdf) {
    this.robot = readRobot(urdf);
    this.ghost = new Ghost(urdf);
    this.ring = new Ring();
    this.chain = chain(this.robot);
    this.arcs = new Arcs(this.robot, {});
  }

  /** Take the posture of a picture. */
  show(picture) {
    turn(this.robot, picture.angles);
    this.ghost.show(picture.ghost);
    this.ring.mark(this.robot.joints[picture.attended], picture.way);
  }

  /** Have arcs for these ranges (rad, [lower, upper] by joint), seen or not. */
  range(ranges, on) {
    this.arcs.remove();
    this.arcs = new Arcs(this.robot, ranges);
    this.arcs.show(on);
  }

  pose() {
    return pose(this.robot);
  }

  ghostPose() {
    return pose(this.ghost.robot);
  }

  paint(colours) {
    this.ghost.paint(colours.ghost);
    this.ring.material.color = new Color(colours.attended);
    this.arcs.material.color = new Color(colours.range);
    this.arcs.handMaterial.color = new Color(colours.attended);
  }
}

/** A canvas with a model on it. Throws where there is no WebGL. */
export class Stage {
  /** @param {HTMLCanvasElement} canvas @param {Model} model @param {() => void} changed the view was moved */
  constructor(canvas, model, changed) {
    const context = canvas.getContext("webgl2", CONTEXT); // three would complain on the console
    if (!context) throw new Error("no WebGL");
    this.renderer = new WebGLRenderer({ canvas, context });
    this.orbit = new Orbit(changed);
    this.orbit.listen(canvas);
    this.model = model;
    this.scene = new Scene();
    this.scene.add(model.robot, model.ghost.robot, ...lights());
    this.drawn = 0;
  }

  /** Fit a size in CSS pixels. */
  resize(width, height) {
    if (!width || !height) return;
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, FINEST));
    this.renderer.setSize(width, height, false);
    this.orbit.aspect = width / height;
  }

  paint(colours) {
    this.model.paint(colours);
    this.grid?.removeFromParent();
    this.grid = new GridHelper(0.8, 8, new Color(colours.grid), new Color(colours.grid));
    this.grid.rotation.x = Math.PI / 2;
    this.grid.position.x = 0.2;
    this.scene.add(this.grid);
  }

  draw() {
    this.renderer.render(this.scene, this.orbit.camera);
    this.drawn += 1;
  }
}

function lights() {
  const sun = new DirectionalLight(0xffffff, 2.2);
  sun.position.set(0.4, -0.8, 1.4);
  return [new HemisphereLight(0xffffff, 0x8890a0, 1.6), sun];
}
