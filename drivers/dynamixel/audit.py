"""Whether the servos on the bus are the ones in the config; differences are errors, never mended silently."""

import logging
import math

from bentod.errors import BusError, ConfigError
from bentod.frames import JointSpec
from drivers.dynamixel.servo import Servo
from drivers.dynamixel.tables import KNOWN_NUMBERS, SPEED_STEP
from drivers.dynamixel.units import LAST_TICK, angle, from_raw, ticks, to_raw

log = logging.getLogger(__name__)

PROVISION = "with the servo maker's tool, torque off"
"""Where settings that survive power-off are changed: never here."""


def check_spec(spec: JointSpec) -> None:
    """A joint that this kind of servo can be.

    Raises:
        ConfigError: its limits are beyond one turn, or it is to be slower than a servo can be.
    """
    lowest, highest = angle(0), angle(LAST_TICK)
    if spec.minimum < lowest or spec.maximum > highest:
        raise ConfigError(
            f"Joint {spec.name} is to move {_degrees(spec.minimum, spec.maximum)}; "
            f"a servo in joint mode moves {_degrees(lowest, highest)}.",
            field=spec.name,
        )
    if spec.max_velocity < SPEED_STEP:
        raise ConfigError(
            f"Joint {spec.name} has a maximum of {spec.max_velocity:.4f} rad/s; "
            f"the slowest a servo moves is {SPEED_STEP:.4f} rad/s.",
            field=spec.name,
        )


def check_ids(servos: list[Servo]) -> None:
    """One id, one joint.

    Raises:
        ConfigError: two joints share a servo.
    """
    by_id: dict[int, Servo] = {}
    for servo in servos:
        other = by_id.setdefault(servo.id, servo)
        if other is not servo:
            raise ConfigError(
                f"Joints {other.spec.name} and {servo.spec.name} have the same servo id {servo.id}.",
                field=servo.spec.name,
            )


async def audit(servo: Servo) -> float:
    """Find a servo, check it, and learn its torque and a first reading; returns its return delay (s).

    Raises:
        BusError: it is absent, another model, or set up in a way that cannot be worked with.
    """
    await servo.ping()
    _check_model(servo, await servo.get("Model Number"))
    settings = await servo.get_bytes("Model Number", "Status Return Level")
    _check_limits(servo, settings)
    _check_replies(servo, settings)
    _check_drive_mode(servo, settings)
    await _check_torque_mode(servo)
    servo.torque = await servo.get("Torque Enable") != 0
    servo.in_doubt = False
    await servo.read_window()
    return _return_delay(servo, settings)


def _check_model(servo: Servo, found: int) -> None:
    if found != servo.model.number:
        what = KNOWN_NUMBERS.get(found, "unknown")
        raise servo.error(
            f"has model number {found} ({what}) where the config expects {servo.model.number} "
            f"(an {servo.hardware.model}); check the wiring, the id and the config."
        )


def _check_limits(servo: Servo, settings: bytes) -> None:
    cw = to_raw(servo.register("CW Angle Limit"), settings)
    ccw = to_raw(servo.register("CCW Angle Limit"), settings)
    if cw == ccw == 0:
        raise _wrong_mode(servo, "wheel mode: its CW and CCW Angle Limit are both 0")
    if cw == ccw == LAST_TICK:
        raise _wrong_mode(servo, f"multi-turn mode: its CW and CCW Angle Limit are both {LAST_TICK}")
    low, high = ticks(servo.spec.minimum), ticks(servo.spec.maximum)
    if cw > low:
        raise _narrow(servo, "CW Angle Limit", cw, "minimum", low)
    if ccw < high:
        raise _narrow(servo, "CCW Angle Limit", ccw, "maximum", high)


def _wrong_mode(servo: Servo, mode: str) -> BusError:
    low, high = ticks(servo.spec.minimum), ticks(servo.spec.maximum)
    return servo.error(f"is in {mode}; set them to {low} and {high} {PROVISION}.")


def _narrow(servo: Servo, register: str, found: int, bound: str, needed: int) -> BusError:
    return servo.error(
        f"has a {register} of {found} ({_degrees(angle(found))}), inside the config's {bound} of {needed} "
        f"({_degrees(angle(needed))}); set it to {needed} {PROVISION}, or narrow the config."
    )


def _check_replies(servo: Servo, settings: bytes) -> None:
    level = to_raw(servo.register("Status Return Level"), settings)
    if level != 2:
        raise servo.error(
            f"has a Status Return Level of {level} and does not confirm what it is told; "
            f"set it to 2 {PROVISION}."
        )


def _check_drive_mode(servo: Servo, settings: bytes) -> None:
    register = servo.model.table.get("Drive Mode")
    if register is not None and (mode := to_raw(register, settings)) != 0:
        raise servo.error(
            f"has a Drive Mode of {mode} and turns the wrong way or follows another servo; "
            f"set it to 0 {PROVISION}."
        )


async def _check_torque_mode(servo: Servo) -> None:
    if "Torque Ctrl Mode Enable" in servo.model.table and await servo.get("Torque Ctrl Mode Enable"):
        raise servo.error(
            "has Torque Ctrl Mode Enable set and would ignore positions and limits; "
            "power it off and on, and find out what set it."
        )


def _return_delay(servo: Servo, settings: bytes) -> float:
    register = servo.register("Return Delay Time")
    delay = from_raw(register, to_raw(register, settings))
    if delay > 0:
        log.warning("%s waits %.0f µs before each reply; Return Delay Time 0 is faster.", servo, delay * 1e6)
    return delay


def _degrees(*angles: float) -> str:
    return " to ".join(f"{math.degrees(a):.1f}" for a in angles) + " degrees"
