"""What a tick perceives, as a vector of named signals that questions and representations are made from."""

import ast
import math
import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from typing import Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

from bentod.errors import ConfigError, nearest
from bentod.frames import EmgFrame, Freshness, GroupFrame, JointSpec, JointState, State

Range: TypeAlias = tuple[float, float] | None
"""Where a value is expected to lie, both ends included; None: not known."""


@dataclass(frozen=True, slots=True)
class Percept:
    """What learners are told of one tick; a recorded frame holds all of it."""

    tick: int
    due: float  # monotonic s, the tick's deadline
    gap: bool  # ticks just before it were missed or broke
    state: State
    emg: EmgFrame
    groups: tuple[GroupFrame, ...]
    rewards: Mapping[str, float] = field(default_factory=dict)  # by group; a recording's events tell them


class Named(Protocol):
    """Signals by name."""

    @property
    def names(self) -> tuple[str, ...]:
        """In the order in which their values are given."""
        ...

    def range(self, name: str) -> Range:
        """The range of one of them."""
        ...


@dataclass(frozen=True, slots=True)
class Declared:
    """Signals that somebody else reads, e.g. those of a study."""

    ranges: Mapping[str, Range]

    @property
    def names(self) -> tuple[str, ...]:
        """In the order in which their values are given."""
        return tuple(self.ranges)

    def range(self, name: str) -> Range:
        """The range of one of them."""
        return self.ranges[name]


class Signals:
    """Names, ranges and values of everything that the arm perceives.

    | name | unit | range |
    |---|---|---|
    | `<joint>.position` | rad | the joint's limits |
    | `<joint>.velocity` | rad/s | up to the joint's greatest, either way |
    | `<joint>.load` | share of the greatest torque | -1..1 |
    | `<joint>.voltage`, `<joint>.temperature` | V, degrees Celsius | – |
    | `emg.<site>` | effort | 0..1 |
    | `emg.likely.<class>` | how likely the muscles make this movement, by themselves | 0..1 |
    | `<group>.effort` | share of the active joint's speed | -1..1 |
    | `<group>.active.<joint>` | 1 while that joint is the active one | 0..1 |
    | `<group>.toggled` | 1 in a tick in which another joint, or all, came to be selected | 0..1 |
    | `<group>.together` | 1 while all joints are selected at once | 0..1 |
    | `<group>.reward` | rewarded since the tick before, toggles and contacts included | – |

    NaN: not known in this tick, because the joint was not read in it or the muscle signal is not alive.
    """

    def __init__(
        self,
        specs: Sequence[JointSpec],
        sites: Sequence[str] = (),
        groups: Mapping[str, Sequence[str]] = {},
        classes: Sequence[str] = (),
    ) -> None:
        """`classes`: of recognised contractions."""
        self._sites = tuple(sites)
        self._classes = tuple(classes)
        self._groups = {name: tuple(joints) for name, joints in groups.items()}
        ranges: dict[str, Range] = {}
        named = [_joint_ranges(spec) for spec in specs]
        named.append({f"emg.{site}": (0.0, 1.0) for site in self._sites})
        named.append({class_signal(label): (0.0, 1.0) for label in self._classes})
        for part in (*named, *(_group_ranges(*group) for group in self._groups.items())):
            for name, bounds in part.items():
                if name in ranges:
                    raise ConfigError(
                        f"two signals would be called '{name}': rename the joint, the site or the group"
                    )
                ranges[name] = bounds
        self._ranges = ranges
        self.names = tuple(ranges)
        self._active: dict[str, str] = {}

    def range(self, name: str) -> Range:
        """The range of one signal. A reading may leave it, e.g. of a joint beyond its limit."""
        return self._ranges[name]

    def read(self, percept: Percept) -> NDArray[np.float64]:
        """The values, in the order of `names`, shape (signals,). To be called once a tick, in order."""
        values: list[float] = []
        for joint in percept.state.joints:
            values += _joint_values(joint)
        effort = percept.emg.effort if percept.emg.alive else {}
        values += [effort.get(site, math.nan) for site in self._sites]
        recognised = _recognised(percept.emg) if self._classes else {}
        unknown = 0.0 if recognised else math.nan  # a class that the model does not tell is never made
        values += [recognised.get(label, unknown) for label in self._classes]
        told = {group.name: group for group in percept.groups}
        for name in self._groups:
            values += self._group_values(name, told.get(name), percept.rewards.get(name, 0.0))
        if len(values) != len(self.names):
            raise ValueError(f"{len(self.names)} signals were declared, and {len(values)} were read.")
        return np.array(values, dtype=np.float64)

    def restart(self) -> None:
        """Forget which joints were active: the next tick is the first."""
        self._active.clear()

    def memory(self) -> dict[str, NDArray[np.float64]]:
        """Which joints were selected: their places in their groups, -1 for all, NaN where nobody knows."""
        places = [
            _place(self._active[name], joints) if name in self._active else math.nan
            for name, joints in self._groups.items()
        ]
        return {"active": np.array(places, dtype=np.float64)}

    def recall(self, memory: Mapping[str, NDArray[np.float64]]) -> None:
        """Remember it again. Raises ValueError: it is not of these groups."""
        places = memory.get("active")
        if set(memory) != {"active"} or places is None or places.shape != (len(self._groups),):
            raise ValueError(f"These are not the active joints of {len(self._groups)} groups.")
        told = list(zip(self._groups.items(), places.tolist(), strict=True))
        if any(it not in range(-1, len(joints)) for (_, joints), it in told if not math.isnan(it)):
            raise ValueError("An active joint is not one of its group.")
        self._active = {n: (*joints, _ALL)[int(it)] for (n, joints), it in told if not math.isnan(it)}

    def _group_values(self, name: str, told: GroupFrame | None, reward: float) -> list[float]:
        joints = self._groups[name]
        if told is None:
            return [math.nan] * (len(joints) + 4)
        selected = _ALL if told.together else told.active
        toggled = self._active.get(name, selected) != selected
        self._active[name] = selected
        active = [float(joint == told.active) for joint in joints]
        return [told.effort, *active, float(toggled), float(told.together), reward]


def class_signal(label: str) -> str:
    """The name of the signal that tells how likely a class is."""
    return f"emg.likely.{label}"


def _recognised(emg: EmgFrame) -> Mapping[str, float]:
    """What the classifier alone says of each class; nothing where the wearer does not use it freely."""
    told = emg.recognition
    if told is None or emg.paused or not emg.alive or told.reason or told.prompted:
        return {}
    return told.probabilities


def starred(text: str, names: Collection[str]) -> tuple[str, ...]:
    """All `names`, in their order, that a pattern with stars stands for; of any other text, itself.

    "*.velocity" is such a pattern; what Python's grammar takes for a product is a product.

    Raises:
        ConfigError: it stands for none of them.
    """
    if "*" not in text or not _PATTERN.fullmatch(text) or _is_expression(text):
        return (text,)
    found = tuple(name for name in names if fnmatchcase(name, text))
    if not found:
        raise ConfigError(f"'{text}' stands for no signal{nearest(text, names)}")
    return found


def _is_expression(text: str) -> bool:
    try:
        ast.parse(text, mode="eval")
    except SyntaxError:
        return False
    return True


_PATTERN = re.compile(r"[A-Za-z0-9_.*]{1,200}")
_UNKNOWN = [math.nan] * 5
_ALL = ""
"""Stands for all joints at once among the names of those that are selected."""


def _joint_values(joint: JointState) -> list[float]:
    if joint.freshness is not Freshness.FRESH:
        return _UNKNOWN
    return [joint.position, joint.velocity, joint.load, joint.voltage, joint.temperature]


def _joint_ranges(spec: JointSpec) -> dict[str, Range]:
    return {
        f"{spec.name}.position": (spec.minimum, spec.maximum),
        f"{spec.name}.velocity": (-spec.max_velocity, spec.max_velocity),
        f"{spec.name}.load": (-1.0, 1.0),
        f"{spec.name}.voltage": None,
        f"{spec.name}.temperature": None,
    }


def _group_ranges(name: str, joints: Sequence[str]) -> dict[str, Range]:
    reward: dict[str, Range] = {f"{name}.reward": None}
    active: dict[str, Range] = {f"{name}.active.{joint}": (0.0, 1.0) for joint in joints}
    selected = {f"{name}.toggled": (0.0, 1.0), f"{name}.together": (0.0, 1.0)}
    return {f"{name}.effort": (-1.0, 1.0), **active, **selected, **reward}


def _place(selected: str, joints: Sequence[str]) -> float:
    if selected == _ALL:
        return -1
    return joints.index(selected) if selected in joints else math.nan
