"""Frames as samples: which channels the stream of state has, and one sample a frame."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache, partial

import numpy as np
from numpy.typing import NDArray

from bentod.control.arbiter import PRIORITY
from bentod.frames import Freshness, Mode, Value
from bentod.lsl.stream import Channel, Stream, Table

MODES = tuple(Mode)
"""Codes by their place; what comes to be added is added at the end."""

FRESHNESS = tuple(Freshness)

HOLDERS = ("nobody", *PRIORITY, *(mode.value for mode in (Mode.HOLDING, Mode.PAUSED, Mode.FAULT)))
"""Who decides what a joint is told: a source, or the mode that stops it."""


@dataclass(frozen=True, slots=True)
class Quantity:
    """One number of a frame or of a joint; not a number where there is none."""

    name: str
    unit: str
    meaning: str
    value: Callable[[Table], float]
    codes: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Layout:
    """Which joints and which predictions have channels; both in their order."""

    joints: tuple[str, ...]
    timescales: tuple[str, ...]  # steps

    def holds(self, other: "Layout") -> bool:
        """Whether frames of `other` lose nothing here."""
        return self.joints == other.joints and set(self.timescales) >= set(other.timescales)

    def channels(self) -> tuple[Channel, ...]:
        """Of the whole arm first, then joint by joint."""
        whole = [_channel(quantity, "") for quantity in WHOLE]
        each = _of_joint(self.timescales)
        return (*whole, *(_channel(quantity, name) for name in self.joints for quantity in each))

    def sample(self, frame: Table) -> NDArray[np.float64]:
        """One frame, shape (1, channels); what it does not tell is not a number."""
        told = {joint["name"]: joint for joint in _joints(frame)}
        values = [quantity.value(frame) for quantity in WHOLE]
        for name in self.joints:
            values += [quantity.value(told.get(name, {})) for quantity in _of_joint(self.timescales)]
        return np.array([values])


def layout_of(frame: Table) -> Layout:
    """The channels that this frame can fill."""
    joints = _joints(frame)
    scales = {scale for joint in joints for scale in _table(joint.get("predictions"))}
    return Layout(tuple(str(joint["name"]) for joint in joints), tuple(sorted(scales, key=_step)))


def state_stream(layout: Layout, arm: str, rate_hz: float, about: dict[str, str]) -> Stream:
    """The stream of an arm's state, one sample a tick."""
    return Stream("bentod state", "Robot", f"{arm}/state", rate_hz, "double64", layout.channels(), about)


def number(value: Value) -> float:
    """A number or a flag; not a number if it is neither."""
    return float(value) if isinstance(value, int | float) else math.nan


def _channel(quantity: Quantity, joint: str) -> Channel:
    label = f"{joint}.{quantity.name}" if joint else quantity.name
    kind = quantity.name.partition("_")[0].capitalize() if joint else "Arm"
    return Channel(label, quantity.unit, kind, quantity.meaning, joint, quantity.codes)


def _joints(frame: Table) -> list[Table]:
    found = frame.get("joints")
    return [joint for joint in found if isinstance(joint, dict)] if isinstance(found, list) else []


def _table(value: Value) -> Table:
    return value if isinstance(value, dict) else {}


def _step(scale: str) -> tuple[float, str]:
    try:
        return float(scale), scale
    except ValueError:
        return math.inf, scale


def _at(key: str, table: Table) -> float:
    return number(table.get(key))


def _inside(key: str, inner: str, table: Table) -> float:
    return number(_table(table.get(key)).get(inner))


def _coded(key: str, codes: Sequence[str], table: Table) -> float:
    value = table.get(key)
    return float(codes.index(value)) if isinstance(value, str) and value in codes else math.nan


def _read_after(frame: Table) -> float:
    return _at("read_at", frame) - _at("time", frame)


def _holder(joint: Table) -> float:
    source = str(joint.get("holder", "?")).partition(":")[0] or "nobody"
    return float(HOLDERS.index(source)) if source in HOLDERS else math.nan


def _asked(key: str, joint: Table) -> float:
    """Of the wish that won."""
    source = str(joint.get("holder", "")).partition(":")[0]
    return _of_command(key, _table(joint.get("asked")).get(source))


def _sent(key: str, joint: Table) -> float:
    return _of_command(key, joint.get("sent"))


def _of_command(key: str, command: Value) -> float:
    told = _table(command)
    if told.get("kind") == "stop":
        return 0.0 if key == "velocity" else math.nan
    return _at(key, told)


@cache
def _of_joint(timescales: tuple[str, ...]) -> tuple[Quantity, ...]:
    return (*JOINT, *(_prediction(timescale) for timescale in timescales))


def _prediction(timescale: str) -> Quantity:
    meaning = f"expected position, {timescale} steps ahead"
    return Quantity(f"prediction_{timescale}", "radians", meaning, partial(_inside, "predictions", timescale))


WHOLE = (
    Quantity("tick", "", "number of the tick; one that is missing was missed or lost", partial(_at, "tick")),
    Quantity("read_after", "seconds", "from the time stamp to the end of the round on the bus", _read_after),
    Quantity("lateness", "seconds", "from the time stamp to the start of the tick", partial(_at, "lateness")),
    Quantity("mode", "", "mode of the whole arm", partial(_coded, "mode", MODES), MODES),
    Quantity("whole", "", "0: the tick broke, and its joints are the last known", partial(_at, "whole")),
    Quantity("assist", "", "1: the arm helps", partial(_inside, "assist", "engaged")),
    Quantity(
        "trial", "", "number of the trial that runs; none between trials", partial(_inside, "trial", "number")
    ),
)
"""Of the whole arm."""

JOINT = (
    Quantity("position", "radians", "as read", partial(_at, "position")),
    Quantity("velocity", "radians/second", "as read", partial(_at, "velocity")),
    Quantity("load", "normalized", "share of the greatest torque", partial(_at, "load")),
    Quantity("age", "seconds", "of what was read, at the end of the round", partial(_at, "age")),
    Quantity("freshness", "", "of what was read", partial(_coded, "freshness", FRESHNESS), FRESHNESS),
    Quantity("mode", "", "what it is allowed to do", partial(_coded, "mode", MODES), MODES),
    Quantity("torque", "", "1: on", partial(_at, "torque")),
    Quantity("holder", "", "who decides what it is told", _holder, HOLDERS),
    Quantity("asked_velocity", "radians/second", "that the holder wishes", partial(_asked, "velocity")),
    Quantity("asked_position", "radians", "that the holder wishes", partial(_asked, "position")),
    Quantity("asked_speed", "radians/second", "towards that position, at most", partial(_asked, "speed")),
    Quantity("sent_velocity", "radians/second", "within limits", partial(_sent, "velocity")),
    Quantity("sent_position", "radians", "within limits", partial(_sent, "position")),
    Quantity("sent_speed", "radians/second", "towards that position, at most", partial(_sent, "speed")),
)
"""Of each joint, before its predictions."""
