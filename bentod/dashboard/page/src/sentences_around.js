/** What the page knows beside the frames: who looks, at what, and whether it is now. */

/** @returns {Required<import("./sentences_waiting.js").Around>} */
export function around(app) {
  return {
    lost: lost(app.linkState),
    silent: app.linkState.why === "silent",
    operator: app.role === "operator",
    muscles: Boolean(app.info?.emg ?? true),
    touch: matchMedia("(hover: none) and (pointer: coarse)").matches,
    replaying: Boolean(app.replaying),
  };
}

const OLD = "what stands here is old.";

function lost({ page, daemon, why }) {
  if (page && daemon) return "";
  if (why === "silent") return `Nothing is heard of the arm: ${OLD}`;
  if (!page) return `The page has lost its server: ${OLD}`;
  return `The page has no connection to the daemon: ${OLD} ${why ?? ""}`.trim();
}
