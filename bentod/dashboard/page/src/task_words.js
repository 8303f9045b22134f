// @ts-check
// A task in words: what to do now, and what the picture shows.
import { degrees, number, seconds, words } from "./units.js";

/** What to do now: a mark that is no colour, and a sentence. `state`: as the server tells it, or null. */
export function advice(task, state) {
  if (!task) return { mark: "·", text: "No task: the two joints as they are." };
  if (!state) return { mark: "·", text: "Choose who helps, and start." };
  if (state.phase === "over") return { mark: "■", text: state.why };
  if (state.phase === "starting") return { mark: "…", text: "The trial begins." };
  if (state.halted) return { mark: "‖", text: "The arm is paused. The clock runs on, and the circuit will say so." };
  const goal = `${state.phase === "approach" ? "Bring the arm to the start" : "Go to"} ${state.target}`;
  if (!state.resting) return { mark: "→", text: `${goal}${state.phase === "approach" ? ": the trial begins there." : "."}` };
  const left = number(Math.max(0, (1 - state.held) * task.dwell), 1, "s");
  if (state.inside) return { mark: "●", text: `Hold ${state.target}: ${left} left.` };
  return { mark: "○", text: `Back to ${state.target}: ${left} left.` };
}

/** The picture for those who do not see it. `look`: as `JointSpace.look` returns it. */
export function described(pair, look, task, state) {
  if (!look) return "";
  const where = pair.map((name, axis) => `${words(name)} ${degrees(look.position[axis])}`).join(", ");
  const expected = look.expected ? ` Expected: ${look.expected.map((angle) => degrees(angle)).join(", ")}.` : "";
  const active = pair.filter((_, axis) => (axis ? look.axes.up : look.axes.across)).map(words).join(" and ");
  const can = active ? ` Active: ${active}.` : "";
  const wall = state?.touching ? " A wall is touched." : "";
  return `${task ? advice(task, state).text : ""} ${where}.${expected}${can}${wall}`.trim();
}

/** What was out of the ordinary in a circuit. */
export function remarks(lap) {
  const found = [];
  if (lap.slips) found.push(`left too early ${lap.slips} ×`);
  if (lap.paused > 0.05) found.push(`paused ${seconds(lap.paused)}`);
  if (lap.unseen > 0.05) found.push(`not seen ${seconds(lap.unseen)}`);
  return found.join(", ") || "–";
}
