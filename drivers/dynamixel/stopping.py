"""Where to send a joint so that it comes to rest without reversing."""

import math
from dataclasses import dataclass
from typing import Literal, TypeAlias

StopRule: TypeAlias = Literal["full", "thesis", "last_position"]
"""Which estimate a stop uses; `full` is the one to use, the others exist to compare it with."""

LAG_AT_FULL_LOAD = math.radians(11.33)
"""rad: 1 / (0.158 P) at P = 32, the law measured in Rhoban's bam, `bam/dynamixel/actuator.py`."""

P_GAIN_OF_LAG = 32
"""The P gain at which `LAG_AT_FULL_LOAD` holds; also the MX default."""


@dataclass(frozen=True, slots=True)
class Travel:
    """A joint as it was read when the stop was asked for."""

    position: float  # rad
    previous: float  # rad, in the reading before this one
    velocity: float  # rad/s
    load: float  # share of the greatest torque, -1..1, positive towards increasing position
    delay: float  # s from the sampling of these values to the moment the stop takes effect
    p_gain: float = P_GAIN_OF_LAG  # the servo's P gain register
    acceleration: float = 0.0  # rad/s², the servo's Goal Acceleration; 0: unlimited


def lag(load: float, p_gain: float) -> float:
    """By how much (rad, signed) the servo's own reference leads its measured position.

    A proportional position loop holds an output of `load` only with an error of `load` / Kp.
    """
    return LAG_AT_FULL_LOAD * load * P_GAIN_OF_LAG / p_gain


def coast(velocity: float, acceleration: float) -> float:
    """Distance (rad, signed) that the servo's profile needs to slow down: v² / 2a, 0 without a profile."""
    if acceleration <= 0:
        return 0.0
    return math.copysign(velocity**2 / (2 * acceleration), velocity)


def full(travel: Travel) -> float:
    """The full estimate, rad: p + v (T_age + T_bus + T_cmd) + e_lag + sign(v) v² / 2a.

    Extends the rule of Sherstan 2015, section A.2, which names the delay of reading and command as the
    cause of the bounce, by the control lag and the servo's own deceleration.
    """
    ahead = travel.velocity * travel.delay + coast(travel.velocity, travel.acceleration)
    return travel.position + ahead + lag(travel.load, travel.p_gain)


def thesis(travel: Travel) -> float:
    """The estimate of Sherstan 2015, section A.2, rad: p + (p - p_prev), which bounces at speed."""
    return travel.position + (travel.position - travel.previous)


def last_position(travel: Travel) -> float:
    """The position as read, rad: what brachIOplexus does (`StopVelocity`)."""
    return travel.position


RULES = {"full": full, "thesis": thesis, "last_position": last_position}


def resting_place(travel: Travel, rule: StopRule, slowest: float) -> float:
    """The goal (rad) that stops the joint by `rule`, never behind `position` in the direction of travel.

    Below 2 `slowest` (rad/s) a velocity is measurement noise and has no direction: a joint that hangs
    from its control lag then keeps its reference instead of being let down onto its position.
    """
    place = RULES[rule](travel)
    if abs(travel.velocity) < 2 * slowest:
        return place
    return max(place, travel.position) if travel.velocity > 0 else min(place, travel.position)
