/** A camera that goes round the arm: by pointer, wheel and keys. It moves only when somebody moves it. */

import { PerspectiveCamera, Vector3 } from "three";

const DEGREE = Math.PI / 180;
const STEP = 5 * DEGREE;
const ZOOM = 1.1;

/** Seen from its right side, a little from the front and from above; m and rad. */
const HOME = { azimuth: -68 * DEGREE, elevation: 16 * DEGREE, distance: 0.8 };
const TARGET = new Vector3(0.2, 0, 0.17);

/** Width over height below which the view steps back, so that a narrow screen shows all of the arm. */
const WIDE = 1.35;

const KEYS = {
  ArrowLeft: (orbit) => orbit.turn(-STEP, 0),
  ArrowRight: (orbit) => orbit.turn(STEP, 0),
  ArrowUp: (orbit) => orbit.turn(0, STEP),
  ArrowDown: (orbit) => orbit.turn(0, -STEP),
  "+": (orbit) => orbit.zoom(1 / ZOOM),
  "=": (orbit) => orbit.zoom(1 / ZOOM),
  "-": (orbit) => orbit.zoom(ZOOM),
  Home: (orbit) => orbit.home(),
};

export class Orbit {
  /** @param {() => void} changed called after each move */
  constructor(changed) {
    this.camera = new PerspectiveCamera(35, WIDE, 0.05, 10);
    this.camera.up.set(0, 0, 1);
    this.changed = changed;
    this.at = { ...HOME };
    this.#place();
  }

  home() {
    this.at = { ...HOME };
    this.#moved();
  }

  /** Go round by an azimuth and up by an elevation, rad. */
  turn(azimuth, elevation) {
    this.at.azimuth += azimuth;
    this.at.elevation = clamp(this.at.elevation + elevation, -10 * DEGREE, 88 * DEGREE);
    this.#moved();
  }

  /** Away by a factor. */
  zoom(factor) {
    this.at.distance = clamp(this.at.distance * factor, 0.35, 3);
    this.#moved();
  }

  /** Width over height of the picture. */
  set aspect(aspect) {
    this.camera.aspect = aspect;
    this.#place();
  }

  /** Follow what happens on an element. */
  listen(element) {
    element.addEventListener("keydown", (event) => this.#key(event));
    element.addEventListener("dblclick", () => this.home());
    element.addEventListener("pointerdown", (event) => element.setPointerCapture(event.pointerId));
    element.addEventListener("pointermove", (event) => this.#drag(element, event));
    element.addEventListener("wheel", (event) => this.#wheel(element, event), { passive: false });
  }

  #key(event) {
    const act = event.ctrlKey || event.altKey || event.metaKey ? undefined : KEYS[event.key];
    if (!act) return;
    event.preventDefault();
    event.stopPropagation();
    act(this);
  }

  #drag(element, event) {
    if (!element.hasPointerCapture(event.pointerId)) return;
    this.turn((-event.movementX / element.clientWidth) * Math.PI, (event.movementY / element.clientHeight) * Math.PI);
  }

  /** Only with the focus: a page that is scrolled past the arm scrolls on. */
  #wheel(element, event) {
    if (document.activeElement !== element || !event.deltaY) return;
    event.preventDefault();
    this.zoom(event.deltaY > 0 ? ZOOM : 1 / ZOOM);
  }

  #moved() {
    this.#place();
    this.changed();
  }

  #place() {
    const { azimuth, elevation } = this.at;
    const distance = this.at.distance * Math.max(1, WIDE / this.camera.aspect);
    const flat = distance * Math.cos(elevation);
    const away = new Vector3(flat * Math.cos(azimuth), flat * Math.sin(azimuth), distance * Math.sin(elevation));
    this.camera.position.copy(TARGET).add(away);
    this.camera.lookAt(TARGET);
    this.camera.updateProjectionMatrix();
    this.camera.updateMatrixWorld();
  }
}

function clamp(value, least, most) {
  return Math.min(Math.max(value, least), most);
}
