"""What of a frame or an event can be heard: a few words of it, in values that do not depend on the wire."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from bentod.config_sounds import named
from bentod.frames import Value

WORDS = {"active": "release", "paused": "pause", "holding": "pause", "limp": "limp", "fault": "fault"}
"""The event that tells of each mode of the arm; one that holds is to its wearer one that is paused."""


@dataclass(frozen=True, slots=True)
class GroupSeen:
    """A joint group."""

    name: str
    active: str  # the joint
    together: bool  # all joints are selected at once
    driven: bool  # somebody moves it now

    @property
    def event(self) -> str:
        """What says which joint is selected."""
        return "together" if self.together else f"joint.{self.active}"


@dataclass(frozen=True, slots=True)
class Glance:
    """One frame."""

    word: str  # of WORDS; empty for a mode that nobody knows
    groups: tuple[GroupSeen, ...]
    homing: bool  # a goal moves the arm
    goal: tuple[int, str]  # number and status of the newest goal; (0, "") before the first
    trial: int  # number of the one that is running; 0 for none
    muscles: bool  # there are signals
    offers: frozenset[str]  # groups of which all joints may be selected at once


def glance(frame: Mapping[str, Value]) -> Glance:
    """What of a frame can be heard; whatever it lacks is taken not to be so."""
    number, status = _goal(frame.get("goal"))
    trial = frame.get("trial")
    emg = frame.get("emg")
    return Glance(
        word=WORDS.get(str(frame.get("mode")), ""),
        groups=tuple(_group(group) for group in _tables(frame.get("groups"))),
        homing=status in ("accepted", "moving"),
        goal=(number, status),
        trial=_number(trial.get("number")) if isinstance(trial, dict) else 0,
        muscles=isinstance(emg, dict) and emg.get("alive") is True,
        offers=frozenset(_offers(frame)),
    )


def told(event: Mapping[str, Value]) -> str:
    """What an event says that no frame does: `stop`, a mark, or a movement that is asked for; else empty."""
    kind, data = event.get("kind"), event.get("data")
    if kind == "mode" and str(event.get("text")).startswith("stopped by "):
        return "stop"
    if kind in ("trial", "mark") and isinstance(data, dict) and (mark := data.get("mark")):
        return named("mark", str(mark))
    if kind == "emg" and isinstance(data, dict) and (label := data.get("prompt")):
        return named("emg.prompt", str(label))
    return ""


def _group(group: Mapping[str, Value]) -> GroupSeen:
    effort = group.get("effort")
    driven = bool(group.get("operator")) and isinstance(effort, int | float) and effort != 0
    return GroupSeen(str(group.get("name")), str(group.get("active")), group.get("together") is True, driven)


def _goal(goal: Value) -> tuple[int, str]:
    return (_number(goal.get("id")), str(goal.get("status"))) if isinstance(goal, dict) else (0, "")


def _offers(frame: Mapping[str, Value]) -> Iterator[str]:
    for assist in (frame.get("assist"), *_tables(frame.get("more_assists"))):
        if isinstance(assist, dict) and assist.get("offers_together") is True:
            yield str(assist.get("group"))


def _tables(value: Value) -> list[dict[str, Value]]:
    return [entry for entry in value if isinstance(entry, dict)] if isinstance(value, list) else []


def _number(value: Value) -> int:
    return int(value) if isinstance(value, int | float) else 0
