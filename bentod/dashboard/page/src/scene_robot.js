/** The arm of a URDF as objects of three: turned by joint angles, asked for where its links are. */

import { Color, EdgesGeometry, LineBasicMaterial, LineSegments, Mesh, MeshPhongMaterial } from "three";
import URDFLoader from "urdf-loader";

/** The arm as its URDF draws it. */
export function readRobot(text) {
  const loader = new URDFLoader();
  loader.loadMeshCb = (path, manager, material, done) => done(null); // primitives only
  const robot = loader.parse(text);
  for (const joint of Object.values(robot.joints)) joint.ignoreLimits = true; // an arm may be found beyond them
  return robot;
}

/** Turn joints by name (rad); names that the URDF lacks are ignored, joints that are absent stay. */
export function turn(robot, angles) {
  for (const [name, angle] of Object.entries(angles)) robot.joints[name]?.setJointValue(angle);
}

/** The links from the first joint to the one at the farthest end, by name. */
export function chain(robot) {
  const below = robot.children.map(chain).reduce((long, one) => (one.length > long.length ? one : long), []);
  return robot.isURDFLink && robot.parent?.isURDFJoint ? [robot.urdfName, ...below] : below;
}

/** The matrix of each link by name: 16 numbers, column by column, m, from the link to the foot of the stand. */
export function pose(robot) {
  robot.updateMatrixWorld(true);
  const links = Object.entries(robot.links);
  return Object.fromEntries(links.map(([name, link]) => [name, [...link.matrixWorld.elements]]));
}

/** A second arm, translucent with drawn edges: told apart from the first by its lines, not by colour alone. */
export class Ghost {
  constructor(text) {
    this.robot = readRobot(text);
    this.robot.visible = false;
    this.skin = new MeshPhongMaterial({
      transparent: true,
      depthWrite: false,
      polygonOffset: true, // where both arms coincide, the real one is seen
      polygonOffsetFactor: 1,
      polygonOffsetUnits: 4,
    });
    this.edge = new LineBasicMaterial({ transparent: true });
    this.#dress();
  }

  /** Be there, or be gone with null: only what `moved` joints carry, the rest is where the arm is. */
  show(expected) {
    this.robot.visible = expected !== null;
    if (expected === null) return;
    turn(this.robot, expected.angles);
    reveal(this.robot, expected.moved, false);
    this.skin.opacity = expected.opacity * 0.6;
    this.edge.opacity = Math.min(1, expected.opacity + 0.25);
  }

  paint(colour) {
    this.skin.color = new Color(colour);
    this.edge.color = new Color(colour);
  }

  #dress() {
    const meshes = [];
    this.robot.traverse((part) => part instanceof Mesh && meshes.push(part));
    for (const mesh of meshes) {
      mesh.material = this.skin;
      mesh.add(new LineSegments(new EdgesGeometry(mesh.geometry, 30), this.edge));
    }
  }
}

function reveal(part, moved, seen) {
  for (const child of part.children) {
    if (child.isURDFVisual) child.visible = seen;
    else reveal(child, moved, seen || (child.isURDFJoint && moved.includes(child.name)));
  }
}
