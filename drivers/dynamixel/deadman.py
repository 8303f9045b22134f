"""The bounded goal: a servo without a watchdog that nobody talks to any more still comes to rest soon.

Protocol 1.0 has no watchdog (DynamixelSDK#14): a servo that was sent to the far end of its range goes there,
also when the daemon has died. So it is sent only as far as it may go without a further order. Every
tick moves that goal on; without ticks the joint reaches it and stops. Own proposal, tried in the simulator.
"""

import math

from bentod.errors import ConfigError
from drivers.dynamixel.reference import coast
from drivers.dynamixel.tuning import Tuning

SETTLING = 0.18
"""s from the end of the reference's motion until the joint follows no more. The least damped joint of the
simulated Bento Arm (an MX-64 that turns the whole arm) takes so long to come below 0.02 rad/s for good."""

PERIODS = 3
"""Periods that the goal is ahead: two orders in a row may be lost before a motion falters."""

USUAL = 0.3
"""s"""

TICKS_AHEAD = 3
"""Position ticks that the goal is ahead at least: at the slowest speeds the way is less than the noise."""


def chosen(wanted: float | None, period: float) -> float:
    """The dead-man's time (s), 0 for none; `wanted` None: the usual one, or what this period (s) needs.

    Raises:
        ConfigError: it is so short that it would slow motions down.
    """
    least = PERIODS * period + SETTLING
    if wanted is None:
        return max(USUAL, least)
    if 0 < wanted < least:
        raise ConfigError(
            f"Dynamixel bus: dead_man_s is {wanted:g}, which must be at least {least:.3g} at "
            f"{1 / period:.4g} Hz: {PERIODS} ticks, and {SETTLING:g} s to come to rest; 0 switches it off.",
            field="dead_man_s",
        )
    return wanted


def bounded(target: float, reference: float, velocity: float, tuning: Tuning, last: float | None) -> float:
    """The goal (rad) on the way to `target`: no farther than the joint goes in the time it is given.

    `reference` (rad) is the servo's when this order takes effect, `velocity` (rad/s) what is asked for, with
    the sign of the direction; `last` the goal (rad) of the order before, if that asked for no more speed in
    the same direction: no goal lies behind it, or the noise of the readings would make small reversals.
    """
    sign = math.copysign(1.0, velocity)
    ahead = abs(velocity) * (tuning.dead_man - SETTLING) + abs(coast(velocity, tuning.goal_acceleration))
    goal = reference + sign * max(ahead, TICKS_AHEAD * tuning.tick)
    if last is not None:
        goal = sign * max(sign * goal, sign * last)
    return sign * min(sign * goal, sign * target)
