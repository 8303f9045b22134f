"""When to say what: frames and events in, what is to be heard out, each change once. No clock, no sound.

The page has the same rules in `bentod/dashboard/page/src/soundcues.js`; `tests/voice/cues.json` holds both to
the same cases.
"""

import math
from dataclasses import replace

from bentod.voice.glance import Glance, GroupSeen

SETTLE = 0.15
"""s that a change must last before it is told: of joints that are toggled through, only the last is."""

URGENT = 1.2
"""s after a fault or a stop in which nothing else is told, so that nothing talks over it."""

STALE = 0.5
"""s without a frame after which nobody knows whether the selected joint may still be moved."""

STOPPED = 1.0
"""s after a stop in which the pause that it brought is not told as well."""

AT_ONCE = ("mark", "emg.prompt")
"""Events that mean the moment in which they come: late, they would mislead."""


class Cues:
    """Times are monotonic s of whoever listens."""

    def __init__(self) -> None:
        self._seen: Glance | None = None
        self._heard_at = -math.inf  # of the last frame
        self._away = False
        self._pending: dict[str, tuple[str, float]] = {}  # by topic: the event, and when it is due
        self._quiet_until = -math.inf
        self._stopped_at = -math.inf
        self._attended = ""  # the group in which a joint was last selected, or moved

    def frame(self, now: float, seen: Glance) -> None:
        """Take in a frame."""
        before, self._seen, self._heard_at = self._seen, seen, now
        if before is None:
            self._pending |= {f"group {group.name}": (group.event, now) for group in self._current()}
            return
        if before.word == "pause" and seen.homing and seen.word == "release":
            # Joints that are paused are lent to the goal: the wearer has not got them back.
            seen = self._seen = replace(seen, word="pause")
        if not self._away:
            self._notice_what_passes(now, before, seen)
        self._notice_groups(now, before, seen)
        self._notice_word(now, before.word, seen.word)
        self._away = False

    def event(self, now: float, told: str) -> None:
        """Take in what an event said (`glance.told`); nothing, if that is empty."""
        if told == "stop":
            self._urge(now, told)
            self._stopped_at = now
        elif told and now >= self._quiet_until:
            self._pending[next(topic for topic in AT_ONCE if told.startswith(topic))] = (told, now)

    def lost(self) -> None:
        """The daemon is away. When it is back, only what is different then is told."""
        self._away = True
        self._heard_at = -math.inf
        self._pending.clear()

    def due(self, now: float) -> list[str]:
        """The events that are to be heard now, in this order; whatever still sounds may end."""
        urgent = self._pending.pop("urgent", None)
        if urgent:
            return [urgent[0]]
        if now < self._quiet_until:
            return []
        ready = [topic for topic, (_, when) in self._pending.items() if when <= now + 1e-9]
        return [self._pending.pop(topic)[0] for topic in ready]

    def selected(self, now: float) -> str:
        """What moves if the wearer moves: a joint, "together", or nothing while nothing may."""
        if self._seen is None or now - self._heard_at > STALE or self._seen.word != "release":
            return ""
        return next(("together" if group.together else group.active for group in self._current()), "")

    def _current(self) -> list[GroupSeen]:
        """The group that is attended to, or else the first."""
        groups = list(self._seen.groups) if self._seen else []
        return ([group for group in groups if group.name == self._attended] or groups)[:1]

    def _notice_groups(self, now: float, before: Glance, seen: Glance) -> None:
        events = {group.name: group.event for group in before.groups}
        for group in seen.groups:
            if events.get(group.name) != group.event:
                self._pending[f"group {group.name}"] = (group.event, now + SETTLE)
                self._attended = group.name
            elif group.driven:
                self._attended = group.name

    def _notice_word(self, now: float, before: str, word: str) -> None:
        if word == before or (word == "pause" and now - self._stopped_at < STOPPED):
            return
        self._drop_cancelled_goal()
        if word == "fault":
            self._urge(now, word)
        elif word:
            self._pending["mode"] = (word, now + SETTLE)

    def _notice_what_passes(self, now: float, before: Glance, seen: Glance) -> None:
        later = now + SETTLE
        status = seen.goal[1]
        if seen.goal != before.goal and status in ("done", "cancelled"):
            self._pending["goal"] = (f"home.{status}", later)
            # What ends the arm's way home says why by itself.
            if "mode" in self._pending or now < self._quiet_until:
                self._drop_cancelled_goal()
        if seen.trial != before.trial:
            self._pending["trial"] = ("trial.start" if seen.trial else "trial.stop", later)
        if before.muscles and not seen.muscles:
            self._pending["muscles"] = ("emg.lost", later)
        elif seen.muscles:
            self._pending.pop("muscles", None)
        for group in before.offers - seen.offers:
            self._pending.pop(f"offer {group}", None)
        for group in sorted(seen.offers - before.offers):
            self._pending[f"offer {group}"] = ("assist.offers_together", later)

    def _drop_cancelled_goal(self) -> None:
        if self._pending.get("goal", ("", 0.0))[0] == "home.cancelled":
            del self._pending["goal"]

    def _urge(self, now: float, event: str) -> None:
        """Tell of it before all else. What was to be told of the selected joint is told afterwards."""
        self._pending = {t: entry for t, entry in self._pending.items() if t.startswith("group ")}
        self._pending["urgent"] = (event, now)
        self._quiet_until = now + URGENT
