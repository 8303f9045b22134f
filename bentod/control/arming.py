"""Whether a limp joint may be given torque as it is found: still, in range, cool, unloaded, and just read."""

import math
from collections.abc import Sequence

from bentod.control.health import Ladder
from bentod.control.heat import COOLED
from bentod.frames import JointSpec, JointState, State

SAG = 0.2
"""Rad/s: a joint that sags no faster is caught within a degree or two; one that falls, or that a hand moves,
would be jerked to a halt."""

UNREAD = "the arm has not been read yet"
"""What stands in the way before the first tick has ended."""

OUTSIDE = 0.05
"""Rad that a joint may be found outside its limits: it is pinned there, and can only move back."""


def objections(
    joints: Sequence[int], specs: Sequence[JointSpec], state: State | None, ladder: Ladder, now: float
) -> str:
    """Why `joints` may not be armed `now` (monotonic s), a sentence for each; empty if they may."""
    if state is None:
        return UNREAD
    old = now - state.time
    if old > ladder.fault:
        return f"the arm was last read {old:.2f} s ago, bound {ladder.fault:g} s: try again"
    found = [_objection(specs[joint], state.joints[joint], ladder.hold) for joint in joints]
    return "; ".join(sentence for sentence in found if sentence)


def _objection(spec: JointSpec, reading: JointState, oldest: float) -> str:
    if not (reading.age <= oldest and math.isfinite(reading.position)):
        return (
            f"{spec.name} was last read {reading.age:.2f} s ago, bound {oldest:g} s: "
            "check its cable and its power"
        )
    if not abs(reading.velocity) <= SAG:
        return (
            f"{spec.name} moves at {abs(reading.velocity):.2f} rad/s, bound {SAG:g} rad/s: "
            "hold it still, or wait until it rests"
        )
    return _out_of_range(spec, reading.position) or _overburdened(spec, reading)


def _out_of_range(spec: JointSpec, position: float) -> str:
    limit = spec.clamp(position)
    outside = abs(position - limit)
    if outside <= OUTSIDE:
        return ""
    return (
        f"{spec.name} stands at {position:.3f} rad, {outside:.3f} rad outside its limit of {limit:.3f} rad, "
        f"bound {OUTSIDE:g} rad: move it back by hand"
    )


def _overburdened(spec: JointSpec, reading: JointState) -> str:
    coolest = spec.bounds.hot - COOLED
    if reading.temperature >= coolest:
        return f"{spec.name} is at {reading.temperature:.0f} °C, bound {coolest:g} °C: let it cool"
    if abs(reading.load) > spec.bounds.load:
        return (
            f"{spec.name} bears {abs(reading.load):.2f} of its greatest torque, "
            f"bound {spec.bounds.load:g}: take the load off"
        )
    return ""
