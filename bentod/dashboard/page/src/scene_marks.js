/** What is drawn around joints: a ring at the one that is attended to, and the limits of all of them. */

import {
  ConeGeometry,
  DoubleSide,
  Group,
  Matrix4,
  Mesh,
  MeshBasicMaterial,
  RingGeometry,
  TorusGeometry,
  Vector3,
} from "three";

const RING = 0.043; // m, so that it clears the largest servo
const OUTER = 0.062;
const INNER = 0.05;

/** A ring around an axis, with arrowheads in the direction of motion. Drawn over everything else. */
export class Ring extends Group {
  constructor() {
    super();
    this.material = new MeshBasicMaterial({ depthTest: false, transparent: true });
    this.add(new Mesh(new TorusGeometry(RING, 0.0022, 8, 64), this.material));
    this.arrows = [0, 1, 2].map((third) => this.#arrow((third * 2 * Math.PI) / 3));
    this.renderOrder = 2;
    this.visible = false;
  }

  /** Go to a joint of a robot, or away. @param {number} way 1, −1, or 0 for no arrowheads */
  mark(joint, way) {
    this.visible = joint !== undefined;
    if (!joint) return;
    joint.parent.add(this);
    this.position.copy(joint.position);
    this.quaternion.setFromRotationMatrix(aligned(joint));
    for (const arrow of this.arrows) {
      arrow.visible = way !== 0;
      arrow.children[0].rotation.z = way < 0 ? Math.PI : 0;
    }
  }

  #arrow(angle) {
    const arrow = new Group();
    const head = new Mesh(new ConeGeometry(0.008, 0.02, 16), this.material);
    head.position.set(RING, 0, 0);
    arrow.add(head);
    arrow.rotation.z = angle;
    this.add(arrow);
    return arrow;
  }
}

/** The range of each joint as an arc, and a hand on it that shows where the joint is. */
export class Arcs {
  constructor(robot, ranges) {
    this.material = new MeshBasicMaterial({ side: DoubleSide, transparent: true, opacity: 0.7, depthWrite: false });
    this.handMaterial = new MeshBasicMaterial({ side: DoubleSide });
    this.parts = Object.entries(ranges)
      .filter(([name]) => robot.joints[name])
      .flatMap(([name, range]) => this.#arc(robot.joints[name], range));
    this.show(false);
  }

  show(on) {
    for (const part of this.parts) part.visible = on;
  }

  remove() {
    for (const part of this.parts) part.removeFromParent();
  }

  #arc(joint, [lower, upper]) {
    const arc = new Mesh(new RingGeometry(INNER, OUTER, 48, 1, lower, upper - lower), this.material);
    arc.position.copy(joint.position);
    arc.quaternion.setFromRotationMatrix(aligned(joint));
    joint.parent.add(arc);
    const hand = new Mesh(new RingGeometry(INNER - 0.008, OUTER + 0.006, 1, 1, -0.03, 0.06), this.handMaterial);
    hand.quaternion.copy(arc.quaternion);
    joint.add(hand); // turns with it
    return [arc, hand];
  }
}

/** Turns z to a joint's axis, and x to where its link points at angle 0: forward, or up where that is the axis. */
function aligned(joint) {
  const axis = joint.axis.clone().normalize();
  const forward = Math.abs(axis.x) > 0.9 ? new Vector3(0, 0, 1) : new Vector3(1, 0, 0);
  return new Matrix4().makeBasis(forward, axis.clone().cross(forward), axis);
}
