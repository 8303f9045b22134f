"""Switching a servo's torque: pinned before it is on, and confirmed by reading it back."""

import math

from drivers.dynamixel.options import Options
from drivers.dynamixel.servo import Servo
from drivers.dynamixel.tables import ALARM_SHUTDOWN, HARDWARE_ALERT
from drivers.dynamixel.units import Reading, acceleration, goal_bytes

ALARMS = frozenset({"Overheating Error", "Overload Error", ALARM_SHUTDOWN, HARDWARE_ALERT})
"""Complaints under which a servo shuts down by its own Shutdown setting, or has done so."""

WATCHDOG_STEPS = 127
"""The longest that the BUS Watchdog waits, https://emanual.robotis.com/docs/en/dxl/mx/mx-28-2/#bus-watchdog"""


async def switch_off(servo: Servo) -> None:
    """Make a joint limp.

    Raises:
        BusError: not confirmed.
    """
    await _enable(servo, False)


async def switch_on(servo: Servo, options: Options) -> None:
    """Pin a joint where it is, then make it hold.

    The position is read anew, so that no stale one is ever pinned to. The goal goes first: a servo that
    is switched on moves to the goal it last had. Gains and the like are set each time, because they are lost
    with power, and the BUS Watchdog, when it trips, also undoes the profile.

    Raises:
        BusError: not confirmed, in alarm, or too far outside the limits.
    """
    found = await servo.read_window()
    _check(servo, found, options.limit_margin_rad)
    servo.in_doubt = True
    layout, table = servo.model.layout, servo.model.table
    await watch(servo, 0.0)  # which also ends an error of the watchdog, under which goals are refused
    if layout.gain in table:
        await servo.put(layout.gain, servo.hardware.p_gain)
    if layout.acceleration in table:
        limit = acceleration(servo.model, servo.hardware.goal_acceleration_rad_s2)
        await servo.put(layout.acceleration, limit)
    await servo.put_bytes(layout.goal[0], goal_bytes(servo.model, servo.motion.pin(found.position)))
    await watch(servo, options.dead_man_s or 0.0)
    await _enable(servo, True)


async def watch(servo: Servo, dead_man: float) -> None:
    """Have the BUS Watchdog, of servos that have one, wait for `dead_man` (s, rounded up); 0: not at all.

    Raises:
        BusError: not confirmed, or refused.
    """
    register = servo.model.table.get("BUS Watchdog")
    if register is not None:
        steps = min(math.ceil(dead_man / register.per_lsb - 1e-9), WATCHDOG_STEPS)
        await servo.put("BUS Watchdog", steps)
        servo.condition.note_watchdog(steps)


def _check(servo: Servo, found: Reading, margin: float) -> None:
    alarms = sorted(ALARMS.intersection(servo.condition.errors))
    if alarms:
        raise servo.error(
            f"reports {', '.join(alarms)}; take the load off, let it cool, and clear the fault."
        )
    bound = servo.spec.clamp(found.position)
    outside = abs(found.position - bound)
    if outside > margin:
        raise servo.error(
            f"stands at {math.degrees(found.position):.1f} degrees, {math.degrees(outside):.1f} degrees "
            f"outside its limit of {math.degrees(bound):.1f}, which is more than the margin of "
            f"{math.degrees(margin):.1f}; move it back by hand."
        )


async def _enable(servo: Servo, on: bool) -> None:
    """Read back what was written: a late confirmation of an earlier write looks like one of this."""
    servo.in_doubt = True
    servo.torque = servo.torque or on  # what may have been switched on counts as on until it is read back
    await servo.put("Torque Enable", int(on))
    servo.torque = await servo.get("Torque Enable") != 0
    servo.in_doubt = False
    if servo.torque != on:
        raise servo.error(f"confirmed to switch its torque {'on' if on else 'off'} and did not.")
