// When to say what: frames and events in, what is to be heard out, each change once. No clock, no sound.
// The same rules as in bentod/voice/glance.py and cues.py; tests/voice/cases.json holds both to the same cases.

const SETTLE = 0.15; // s that a change must last before it is told: of joints toggled through, only the last is
const URGENT = 1.2; // s after a fault or a stop in which nothing else is told
const STALE = 0.5; // s without a frame after which nobody knows whether the joint may still be moved
const STOPPED = 1.0; // s after a stop in which the pause that it brought is not told as well

const WORDS = { active: "release", paused: "pause", holding: "pause", limp: "limp", fault: "fault" };
const AT_ONCE = ["mark", "emg.prompt"]; // late, they would mislead

/** The event `base` about what `text` says, whatever characters that holds. */
export function named(base, text) {
  const name = strip(strip(text.toLowerCase().replace(/[^\p{L}\p{N}]+/gu, "_")).slice(0, 64));
  return name ? `${base}.${name}` : base;
}

const strip = (text) => text.replace(/^_+|_+$/g, "");

/** Keys of a table of sounds that may say how an event sounds, the most special first. */
export function candidates(event) {
  const base = ["joint", "mark", "emg.prompt"].find((known) => event.startsWith(`${known}.`)) ?? event;
  const name = event.slice(base.length + 1);
  if (base === "joint" || !name) return [...new Set([event, base])];
  const words = name.split("_");
  const found = words.flatMap((_, index) => {
    const beginning = words.slice(0, words.length - index);
    return [beginning.join("_"), beginning.filter((word) => !/^\p{Nd}+$/u.test(word)).join("_")];
  });
  return [...new Set([...found.filter(Boolean).map((key) => `${base}.${key}`), base])];
}

/** What of a frame can be heard. */
export function glance(frame) {
  const status = frame.goal?.status ?? "";
  return {
    word: WORDS[frame.mode] ?? "",
    groups: (frame.groups ?? []).map(({ name, active, together, effort, operator }) => ({
      name,
      active,
      together: together === true,
      driven: Boolean(operator) && Boolean(effort),
      event: together === true ? "together" : `joint.${active}`,
    })),
    homing: status === "accepted" || status === "moving",
    goal: `${frame.goal?.id ?? 0} ${status}`,
    status,
    trial: frame.trial?.number ?? 0,
    muscles: frame.emg?.alive === true,
    offers: [frame.assist, ...(frame.more_assists ?? [])].filter((assist) => assist?.offers_together === true).map((assist) => assist.group),
  };
}

/** What an event says that no frame does: a stop, a mark, a movement that is asked for; else empty. */
export function told({ kind, text, data }) {
  if (kind === "mode" && String(text).startsWith("stopped by ")) return "stop";
  if ((kind === "trial" || kind === "mark") && data?.mark) return named("mark", String(data.mark));
  if (kind === "emg" && data?.prompt) return named("emg.prompt", String(data.prompt));
  return "";
}

export class Cues {
  #seen = null;
  #heardAt = -Infinity;
  #away = false;
  #pending = new Map(); // by topic: [event, s when it is due]
  #quietUntil = -Infinity;
  #stoppedAt = -Infinity;
  #attended = "";

  /** Take in a glance at a frame; `now` in s. */
  frame(now, seen) {
    const before = this.#seen;
    this.#seen = seen;
    this.#heardAt = now;
    if (!before) {
      for (const group of this.#current()) this.#pending.set(`group ${group.name}`, [group.event, now]);
      return;
    }
    // Joints that are paused are lent to the goal: the wearer has not got them back.
    if (before.word === "pause" && seen.homing && seen.word === "release") seen.word = "pause";
    if (!this.#away) this.#noticeWhatPasses(now, before, seen);
    this.#noticeGroups(now, before, seen);
    this.#noticeWord(now, before.word, seen.word);
    this.#away = false;
  }

  /** Take in what an event said. */
  event(now, said) {
    if (said === "stop") {
      this.#urge(now, said);
      this.#stoppedAt = now;
    } else if (said && now >= this.#quietUntil) {
      this.#pending.set(AT_ONCE.find((topic) => said.startsWith(topic)), [said, now]);
    }
  }

  /** The daemon is away. When it is back, only what is different then is told. */
  lost() {
    this.#away = true;
    this.#heardAt = -Infinity;
    this.#pending.clear();
  }

  /** The events that are to be heard now, in this order. */
  due(now) {
    const urgent = this.#pending.get("urgent");
    if (urgent) {
      this.#pending.delete("urgent");
      return [urgent[0]];
    }
    if (now < this.#quietUntil) return [];
    const ready = [...this.#pending].filter(([, [, when]]) => when <= now + 1e-9);
    for (const [topic] of ready) this.#pending.delete(topic);
    return ready.map(([, [event]]) => event);
  }

  /** What moves if the wearer moves: a joint, "together", or nothing while nothing may. */
  selected(now) {
    if (!this.#seen || now - this.#heardAt > STALE || this.#seen.word !== "release") return "";
    const [group] = this.#current();
    return group ? (group.together ? "together" : group.active) : "";
  }

  #current() {
    const groups = this.#seen?.groups ?? [];
    const attended = groups.filter((group) => group.name === this.#attended);
    return (attended.length ? attended : groups).slice(0, 1);
  }

  #noticeGroups(now, before, seen) {
    const events = new Map(before.groups.map((group) => [group.name, group.event]));
    for (const group of seen.groups) {
      const changed = events.get(group.name) !== group.event;
      if (changed) this.#pending.set(`group ${group.name}`, [group.event, now + SETTLE]);
      if (changed || group.driven) this.#attended = group.name;
    }
  }

  #noticeWord(now, before, word) {
    if (word === before || (word === "pause" && now - this.#stoppedAt < STOPPED)) return;
    this.#dropCancelledGoal();
    if (word === "fault") this.#urge(now, word);
    else if (word) this.#pending.set("mode", [word, now + SETTLE]);
  }

  #noticeWhatPasses(now, before, seen) {
    const later = now + SETTLE;
    if (seen.goal !== before.goal && (seen.status === "done" || seen.status === "cancelled")) {
      this.#pending.set("goal", [`home.${seen.status}`, later]);
      // What ends the arm's way home says why by itself.
      if (this.#pending.has("mode") || now < this.#quietUntil) this.#dropCancelledGoal();
    }
    if (seen.trial !== before.trial) this.#pending.set("trial", [seen.trial ? "trial.start" : "trial.stop", later]);
    if (before.muscles && !seen.muscles) this.#pending.set("muscles", ["emg.lost", later]);
    else if (seen.muscles) this.#pending.delete("muscles");
    this.#noticeOffers(later, before.offers, seen.offers);
  }

  #noticeOffers(later, before, offers) {
    for (const group of before) if (!offers.includes(group)) this.#pending.delete(`offer ${group}`);
    for (const group of [...offers].sort()) {
      if (!before.includes(group)) this.#pending.set(`offer ${group}`, ["assist.offers_together", later]);
    }
  }

  #dropCancelledGoal() {
    if (this.#pending.get("goal")?.[0] === "home.cancelled") this.#pending.delete("goal");
  }

  /** Tell of it before all else. What was to be told of the selected joint is told afterwards. */
  #urge(now, event) {
    for (const topic of [...this.#pending.keys()]) if (!topic.startsWith("group ")) this.#pending.delete(topic);
    this.#pending.set("urgent", [event, now]);
    this.#quietUntil = now + URGENT;
  }
}

/** The cases that this and the voice of the room must agree on: what is due after each step. For tests. */
export function rehearse(steps) {
  const cues = new Cues();
  const heard = [];
  for (const [now, what, value] of steps) {
    if (what === "frame") cues.frame(now, glance(value));
    else if (what === "event") cues.event(now, told(value));
    else if (what === "lost") cues.lost();
    heard.push([cues.due(now), cues.selected(now)]);
  }
  return heard;
}
