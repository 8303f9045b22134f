"""Where to send a joint so that it comes to rest without reversing."""

from dataclasses import dataclass
from typing import Literal, TypeAlias

from drivers.dynamixel.reference import coast

StopRule: TypeAlias = Literal["full", "thesis", "last_position", "creep"]
"""Which estimate a stop uses; `full` is the one to use, the others exist to compare it with."""


@dataclass(frozen=True, slots=True)
class Travel:
    """A joint as it was read when the stop was asked for, and where its reference will be."""

    position: float  # rad
    previous: float  # rad, in the reading before this one
    velocity: float  # rad/s
    reference: float  # rad, the servo's reference when the stop will take effect
    rate: float  # rad/s, of the reference at that moment
    acceleration: float = 0.0  # rad/s², the servo's Goal Acceleration; 0: unlimited


def full(travel: Travel) -> float:
    """Where the reference can stop at the earliest, rad: r + sign(v) v² / 2a.

    A goal behind the reference makes the joint come back; one beyond it only costs travel. At a steady
    speed r = p + e_lag + v (T_age + T_bus + T_cmd): the rule of Sherstan 2015, section A.2, which names
    the delay of reading and command as the cause of the bounce, with the control lag.
    """
    return travel.reference + coast(travel.rate, travel.acceleration)


def thesis(travel: Travel) -> float:
    """The estimate of Sherstan 2015, section A.2, rad: p + (p - p_prev), which bounces at speed."""
    return travel.position + (travel.position - travel.previous)


def last_position(travel: Travel) -> float:
    """The position as read, rad: what brachIOplexus does (`StopVelocity`)."""
    return travel.position


RULES = {"full": full, "thesis": thesis, "last_position": last_position, "creep": full}
"""`creep` slows down first and then stops as `full` does, from a speed at which little can go wrong."""


def resting_place(travel: Travel, rule: StopRule, slowest: float) -> float:
    """The goal (rad) that stops the joint by `rule`, never behind `position` in the direction of travel.

    Below 2 `slowest` (rad/s) a velocity is measurement noise and has no direction: a joint that hangs
    from its control lag then keeps its reference instead of being let down onto its position.
    """
    place = RULES[rule](travel)
    if abs(travel.velocity) < 2 * slowest:
        return place
    return max(place, travel.position) if travel.velocity > 0 else min(place, travel.position)
