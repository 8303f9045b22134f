// The pieces of the picture of joint space (thesis, Fig. 5.3). Nothing here knows the page: a pen, a scale, values.

/** @typedef {import("./jointspace_scale.js").Scale} Scale */
/** @typedef {Record<string, string>} Colours of the theme, by the names in style.css */

/** @param {CanvasRenderingContext2D} pen @param {Scale} scale @param {Colours} ink */
export function drawAxes(pen, scale, ink, names) {
  const [[x0, x1], [y0, y1]] = scale.bounds;
  const [left, right, top, bottom] = [scale.x(x0), scale.x(x1), scale.y(y1), scale.y(y0)];
  pen.font = "18px system-ui, sans-serif";
  pen.fillStyle = ink.soft;
  pen.strokeStyle = ink.line;
  pen.lineWidth = 1;
  pen.textAlign = "center";
  pen.textBaseline = "top";
  for (const angle of scale.marks(0, 62)) {
    line(pen, scale.x(angle), top, scale.x(angle), bottom);
    pen.fillText(label(angle), scale.x(angle), bottom + 7);
  }
  pen.fillText(names[0], (left + right) / 2, bottom + 30);
  pen.textAlign = "right";
  pen.textBaseline = "middle";
  for (const angle of scale.marks(1, 45)) {
    line(pen, left, scale.y(angle), right, scale.y(angle));
    pen.fillText(label(angle), left - 8, scale.y(angle));
  }
  pen.textAlign = "left";
  pen.textBaseline = "bottom";
  pen.fillText(names[1], 6, top - 8);
}

/** The box that the joints keep to. */
export function drawBounds(pen, scale, ink) {
  const [[x0, x1], [y0, y1]] = scale.bounds;
  pen.strokeStyle = ink.good;
  pen.lineWidth = 3;
  pen.strokeRect(scale.x(x0), scale.y(y1), scale.perRad * (x1 - x0), scale.perRad * (y1 - y0));
}

/** The corridor of a maze: its floor, and its walls as a thick edge that turns dashed where one is touched. */
export function drawCorridor(pen, scale, ink, corridor, touching) {
  const width = 2 * corridor.half_width * scale.perRad;
  pen.save();
  pen.lineJoin = "round";
  pen.lineCap = "butt";
  trace(pen, scale, corridor.centre);
  pen.strokeStyle = touching ? ink.bad : ink.text;
  pen.lineWidth = width + (touching ? 14 : 8);
  pen.stroke();
  pen.strokeStyle = ink.surface;
  pen.lineWidth = width;
  pen.stroke();
  pen.restore();
}

/** The end of a corridor; the middle, where it is felt, stands out. */
export function drawBarrier(pen, scale, ink, place, state) {
  const [cx, cy] = [scale.x(place.centre[0]), scale.y(place.centre[1])];
  const [ix, iy] = [scale.x(place.inwards[0]) - cx, scale.y(place.inwards[1]) - cy];
  const length = Math.hypot(ix, iy);
  const [ux, uy] = [ix / length, iy / length];
  const half = place.exposed * scale.perRad;
  pen.lineWidth = state.inside ? 12 : 7;
  pen.strokeStyle = colourOf(ink, state);
  pen.setLineDash(state.aimed || state.inside ? [] : [6, 4]);
  line(pen, cx - uy * half, cy + ux * half, cx + uy * half, cy - ux * half);
  pen.setLineDash([]);
  const away = 30 + 20 * Math.abs(ux); // words are wider than they are high
  const [lx, ly] = [cx - ux * away, cy - uy * away];
  tag(pen, ink, place.name, lx, ly, state);
  ring(pen, ink, lx, ly, 22, state);
}

/** A way point: red and hollow; green and filled when the arm is within its tolerance; a ring fills as it is held. */
export function drawSpot(pen, scale, ink, place, state) {
  const [cx, cy] = [scale.x(place.centre[0]), scale.y(place.centre[1])];
  const half = Math.max(place.tolerance * scale.perRad, 9);
  pen.beginPath();
  pen.roundRect(cx - half, cy - half, 2 * half, 2 * half, half / 2);
  pen.strokeStyle = colourOf(ink, state);
  pen.lineWidth = state.aimed ? 4 : 2;
  pen.setLineDash(state.aimed || state.inside ? [] : [5, 4]);
  pen.stroke();
  pen.setLineDash([]);
  if (state.inside) {
    pen.fillStyle = ink.good;
    pen.fill();
  }
  ring(pen, ink, cx, cy, half + 9, state);
  tag(pen, ink, place.name, cx + half + 20, cy - half - 6, state);
}

/** Which way the arm can be moved now: a strip along the active joint's axis. */
export function drawStrip(pen, scale, ink, position, axes) {
  const [[x0, x1], [y0, y1]] = scale.bounds;
  const [left, right, top, bottom] = [scale.x(x0), scale.x(x1), scale.y(y1), scale.y(y0)];
  pen.save();
  pen.beginPath();
  pen.rect(left, top, right - left, bottom - top);
  pen.clip();
  pen.globalAlpha = 0.3;
  pen.fillStyle = ink["series-4"];
  if (axes.across) pen.fillRect(left, scale.y(position[1]) - 9, right - left, 18);
  if (axes.up) pen.fillRect(scale.x(position[0]) - 9, top, 18, bottom - top);
  pen.restore();
}

/** How one is asked to go from place to place, with an arrow's head at the end. */
export function drawGuide(pen, scale, ink, from, to, path) {
  const bend = path === "up_first" ? [from[0], to[1]] : path === "across_first" ? [to[0], from[1]] : from;
  pen.strokeStyle = pen.fillStyle = ink.soft;
  pen.lineWidth = 2;
  pen.setLineDash([3, 6]);
  trace(pen, scale, [from, bend, to]);
  pen.stroke();
  pen.setLineDash([]);
  const start = Math.hypot(to[0] - bend[0], to[1] - bend[1]) > 1e-6 ? bend : from;
  arrow(pen, scale, start, to);
}

/** @param {Float32Array} points x, y, x, y … in rad */
export function drawPath(pen, scale, ink, points, count, old) {
  if (count < 2) return;
  pen.strokeStyle = old ? ink.line : ink["series-1"];
  pen.lineWidth = old ? 2 : 3;
  pen.lineJoin = "round";
  pen.beginPath();
  for (let i = 0; i < count; i++) pen.lineTo(scale.x(points[2 * i]), scale.y(points[2 * i + 1]));
  pen.stroke();
}

/** Where a wall was touched: a cross each. */
export function drawContacts(pen, scale, ink, contacts) {
  pen.strokeStyle = ink.bad;
  pen.lineWidth = 3;
  for (const [x, y] of contacts) {
    const [cx, cy] = [scale.x(x), scale.y(y)];
    line(pen, cx - 7, cy - 7, cx + 7, cy + 7);
    line(pen, cx - 7, cy + 7, cx + 7, cy - 7);
  }
}

/** Where the arm is: a black circle in a white one, on any ground; at the edge of the picture when it is beyond. */
export function drawPosition(pen, scale, position) {
  const within = (value, most) => Math.min(Math.max(value, 12), most - 12);
  pen.beginPath();
  pen.arc(within(scale.x(position[0]), scale.size.width), within(scale.y(position[1]), scale.size.height), 9, 0, 2 * Math.PI);
  pen.fillStyle = "#000000";
  pen.fill();
  pen.strokeStyle = "#ffffff";
  pen.lineWidth = 3;
  pen.stroke();
}

/** Where it is expected: a yellow diamond, so that colour need not tell. */
export function drawExpected(pen, scale, expected) {
  const [cx, cy] = [scale.x(expected[0]), scale.y(expected[1])];
  pen.beginPath();
  for (const [x, y] of [[0, -12], [12, 0], [0, 12], [-12, 0]]) pen.lineTo(cx + x, cy + y);
  pen.closePath();
  pen.fillStyle = "#f0e442";
  pen.fill();
  pen.strokeStyle = "#14181d";
  pen.lineWidth = 2;
  pen.stroke();
}

function colourOf(ink, state) {
  if (state.inside) return ink.good;
  return state.aimed ? ink.bad : ink.soft;
}

function ring(pen, ink, cx, cy, radius, state) {
  if (!state.resting) return;
  pen.strokeStyle = state.inside ? ink.good : ink.warning;
  pen.lineWidth = 5;
  pen.beginPath();
  pen.arc(cx, cy, radius, -Math.PI / 2, -Math.PI / 2 + 2 * Math.PI * Math.min(1, Math.max(0.001, state.held)));
  pen.stroke();
}

function tag(pen, ink, text, x, y, state) {
  pen.font = `${state.aimed ? "bold " : ""}20px system-ui, sans-serif`;
  pen.textAlign = "center";
  pen.textBaseline = "middle";
  pen.strokeStyle = ink.surface;
  pen.lineWidth = 5;
  pen.strokeText(text, x, y);
  pen.fillStyle = ink.text;
  pen.fillText(text, x, y);
}

function arrow(pen, scale, from, to) {
  const [x, y] = [scale.x(to[0]), scale.y(to[1])];
  const angle = Math.atan2(y - scale.y(from[1]), x - scale.x(from[0]));
  pen.save();
  pen.translate(x, y);
  pen.rotate(angle);
  pen.beginPath();
  for (const [dx, dy] of [[-20, 0], [-34, -8], [-34, 8]]) pen.lineTo(dx, dy);
  pen.closePath();
  pen.fill();
  pen.restore();
}

function trace(pen, scale, points) {
  pen.beginPath();
  for (const [x, y] of points) pen.lineTo(scale.x(x), scale.y(y));
}

function line(pen, x0, y0, x1, y1) {
  pen.beginPath();
  pen.moveTo(x0, y0);
  pen.lineTo(x1, y1);
  pen.stroke();
}

function label(angle) {
  const rounded = Math.round((angle * 1800) / Math.PI) / 10;
  return `${String(Object.is(rounded, -0) ? 0 : rounded).replace("-", "−")}°`;
}
