"""Switching a servo's torque: pinned before it is on, and confirmed by reading it back."""

import math

from drivers.dynamixel.options import Options
from drivers.dynamixel.servo import Servo
from drivers.dynamixel.tables import ALARM_SHUTDOWN
from drivers.dynamixel.units import Reading, acceleration, goal_bytes

ALARMS = frozenset({"Overheating Error", "Overload Error", ALARM_SHUTDOWN})
"""Complaints under which a servo shuts down by its own Shutdown setting, or has done so."""


async def switch_off(servo: Servo) -> None:
    """Make a joint limp.

    Raises:
        BusError: not confirmed.
    """
    await _enable(servo, False)


async def switch_on(servo: Servo, options: Options) -> None:
    """Pin a joint where it is, then make it hold.

    The position is read anew, so that no stale one is ever pinned to. The goal goes first: a servo that
    is switched on moves to the goal it last had. Gains are set each time, because they are lost with power.

    Raises:
        BusError: not confirmed, in alarm, or too far outside the limits.
    """
    found = await servo.read_window()
    _check(servo, found, options.limit_margin_rad)
    servo.in_doubt = True
    await servo.put("P Gain", servo.hardware.p_gain)
    await servo.put("Goal Acceleration", acceleration(servo.hardware.goal_acceleration_rad_s2))
    await servo.put_bytes("Goal Position", goal_bytes(servo.motion.pin(found.position)))
    await _enable(servo, True)


def _check(servo: Servo, found: Reading, margin: float) -> None:
    alarms = sorted(ALARMS.intersection(found.errors))
    if alarms:
        raise servo.error(
            f"reports {', '.join(alarms)}; take the load off, let it cool, and power it off and on."
        )
    outside = abs(found.position - servo.spec.clamp(found.position))
    if outside > margin:
        raise servo.error(
            f"stands at {math.degrees(found.position):.1f} degrees, {math.degrees(outside):.1f} degrees "
            f"outside its limits, which is more than {math.degrees(margin):.1f}; move it back by hand."
        )


async def _enable(servo: Servo, on: bool) -> None:
    """Read back what was written: a late confirmation of an earlier write looks like one of this."""
    servo.in_doubt = True
    await servo.put("Torque Enable", int(on))
    servo.torque = await servo.get("Torque Enable") != 0
    servo.in_doubt = False
    if servo.torque != on:
        raise servo.error(f"confirmed to switch its torque {'on' if on else 'off'} and did not.")
