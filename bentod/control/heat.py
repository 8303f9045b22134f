"""How warm the joints are: told when it changes, and from which temperature on a joint must rest."""

from collections.abc import Sequence
from dataclasses import dataclass

from bentod.frames import Freshness, JointSpec, JointState, State

COOLED = 5.0
"""Degrees Celsius below `hot` from which on a joint may be armed: else it would go limp again at once."""

STEADY = 2.0
"""Degrees Celsius below `warm` at which a joint counts as cool again: a sensor flickers between two steps."""

CERTAIN = 3
"""Fresh readings in a row that a joint must be hot in: one that was garbled must not let an arm fall."""


@dataclass(slots=True)
class _Joint:
    warm: bool = False
    hot: int = 0  # fresh readings in a row


class Heat:
    """Remembers which joints are warm, and for how long they have been hot."""

    def __init__(self, specs: Sequence[JointSpec]) -> None:
        self._specs = tuple(specs)
        self._joints = tuple(_Joint() for _ in specs)
        self.too_hot: frozenset[int] = frozenset()
        """Joints that are certainly hot, again after each `CERTAIN` readings."""

    def take(self, state: State) -> list[tuple[JointSpec, str]]:
        """Take in a reading; what is new about a joint, as a sentence."""
        found = [
            (spec, text)
            for spec, joint, reading in zip(self._specs, self._joints, state.joints, strict=True)
            if (text := _change(joint, spec, reading))
        ]
        self.too_hot = frozenset(
            index
            for index, (spec, joint) in enumerate(zip(self._specs, self._joints, strict=True))
            if _certainly_hot(joint, spec, state.joints[index])
        )
        return found


def complaint(joints: Sequence[int], specs: Sequence[JointSpec], state: State) -> str:
    """Which of `joints` are hot, as a sentence; nothing if none is."""
    found = [
        f"{specs[joint].name} is at {state.joints[joint].temperature:.0f} °C "
        f"(limp from {specs[joint].bounds.hot:g} °C on)"
        for joint in joints
        if state.joints[joint].temperature >= specs[joint].bounds.hot
    ]
    return f"too hot: {', '.join(found)}; let it cool" if found else ""


def _change(joint: _Joint, spec: JointSpec, reading: JointState) -> str:
    bounds, temperature = spec.bounds, reading.temperature
    if not joint.warm and temperature >= bounds.warm:
        joint.warm = True
        return (
            f"{spec.name} is warm, {temperature:.0f} °C: slower from {bounds.warm:g} °C on, "
            f"limp at {bounds.hot:g} °C"
        )
    if joint.warm and temperature <= bounds.warm - STEADY:
        joint.warm = False
        return f"{spec.name} has cooled to {temperature:.0f} °C"
    return ""


def _certainly_hot(joint: _Joint, spec: JointSpec, reading: JointState) -> bool:
    if reading.freshness is not Freshness.FRESH:
        return False
    joint.hot = joint.hot % CERTAIN + 1 if reading.temperature >= spec.bounds.hot else 0
    return joint.hot == CERTAIN
