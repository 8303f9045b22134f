"""Whether the servos on the bus are the ones in the config; differences are errors, never mended silently."""

import logging
import math

from bentod.errors import BusError, ConfigError
from bentod.frames import JointSpec
from drivers.dynamixel.options import Hardware
from drivers.dynamixel.registers import from_raw
from drivers.dynamixel.servo import Servo
from drivers.dynamixel.tables import KNOWN_NUMBERS
from drivers.dynamixel.units import angle, error_names, ticks

log = logging.getLogger(__name__)

PROVISION = "with `bentod servo` or the servo maker's tool, torque off"
"""How settings that survive power-off are changed: never by the driver."""

POSITION_MODE = 3
"""Operating Mode, https://emanual.robotis.com/docs/en/dxl/mx/mx-28-2/#operating-mode"""


def check_spec(spec: JointSpec, hardware: Hardware) -> None:
    """A joint that this kind of servo can be.

    Raises:
        ConfigError: its limits are beyond what the servo can reach, or it is to be slower than it can be.
    """
    model = hardware.kind
    lowest, highest = angle(model, 0), angle(model, model.last_tick)
    # Half a turn is 4096 / 2 steps, and so one more than the last.
    if spec.minimum < lowest - model.tick / 2 or spec.maximum > highest + 1.5 * model.tick:
        raise ConfigError(
            f"Joint {spec.name} is to move {_degrees(spec.minimum, spec.maximum)}; "
            f"an {hardware.model} moves {_degrees(lowest, highest)}.",
            field=spec.name,
        )
    if spec.max_velocity < model.speed_step:
        raise ConfigError(
            f"Joint {spec.name} has a maximum of {spec.max_velocity:.4f} rad/s; "
            f"the slowest an {hardware.model} moves is {model.speed_step:.4f} rad/s.",
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
    if not await servo.ping():
        raise await _nobody(servo)
    _check_model(servo, await servo.get("Model Number"))
    check = _check_settings_1 if servo.model.layout.protocol == 1 else _check_settings_2
    settings = await check(servo)
    servo.torque = await servo.get("Torque Enable") != 0
    servo.in_doubt = False
    await servo.read_window()
    log.info("%s is an %s, firmware %d.", servo, servo.hardware.model, settings["Firmware Version"])
    return _return_delay(servo, settings["Return Delay Time"])


async def _nobody(servo: Servo) -> BusError:
    number = await servo.other_number()
    if number is None:
        return servo.error("does not answer a ping; check its power, its cable, its id and the baud rate.")
    spoken = 3 - servo.model.layout.protocol
    return servo.error(
        f"speaks protocol {spoken}.0, as model number {number} ({KNOWN_NUMBERS.get(number, 'unknown')}); the "
        f"config expects an {servo.hardware.model}, which speaks {servo.model.layout.protocol}.0. Change the "
        f"model in the config, or the servo's firmware or protocol {PROVISION}."
    )


def _check_model(servo: Servo, found: int) -> None:
    if found != servo.model.number:
        what = KNOWN_NUMBERS.get(found, "unknown")
        raise servo.error(
            f"has model number {found} ({what}) where the config expects {servo.model.number} "
            f"({KNOWN_NUMBERS[servo.model.number]}); check the wiring, the id and the config."
        )


async def _check_settings_1(servo: Servo) -> dict[str, int]:
    settings = await servo.get_all("Model Number", "Shutdown")
    _check_mode_1(servo, settings["CW Angle Limit"], settings["CCW Angle Limit"])
    _check_limits(servo, settings)
    _check_replies(servo, settings["Status Return Level"])
    _check_drive_mode(servo, settings.get("Drive Mode", 0))
    _check_shutdown(servo, settings["Shutdown"])
    if "Torque Ctrl Mode Enable" in servo.model.table and await servo.get("Torque Ctrl Mode Enable"):
        raise servo.error(
            "has Torque Ctrl Mode Enable set and would ignore positions and limits; "
            "power it off and on, and find out what set it."
        )
    return settings


async def _check_settings_2(servo: Servo) -> dict[str, int]:
    """Each run of registers by itself: an undefined address among them would be an access error."""
    settings = await servo.get_all("Model Number", "Protocol Version")
    settings |= await servo.get_all("Homing Offset", "Homing Offset")
    settings |= await servo.get_all("Velocity Limit", "Min Position Limit")
    settings |= await servo.get_all("Shutdown", "Torque Enable")
    settings |= await servo.get_all("Status Return Level", "Hardware Error Status")
    _check_drive_mode(servo, settings["Drive Mode"])
    _check_mode_2(servo, settings)
    _check_limits(servo, settings)
    _check_speed(servo, settings["Velocity Limit"])
    _check_replies(servo, settings["Status Return Level"])
    _check_shutdown(servo, settings["Shutdown"])
    servo.condition.note_hardware(settings["Hardware Error Status"])
    servo.condition.note_watchdog(await servo.get("BUS Watchdog"))
    return settings


def _check_mode_1(servo: Servo, cw: int, ccw: int) -> None:
    if cw == ccw == 0:
        raise _wrong_mode(servo, "wheel mode: its CW and CCW Angle Limit are both 0")
    if cw == ccw == servo.model.last_tick:
        raise _wrong_mode(servo, f"multi-turn mode: its CW and CCW Angle Limit are both {ccw}")


def _check_mode_2(servo: Servo, settings: dict[str, int]) -> None:
    mode = settings["Operating Mode"]
    if mode != POSITION_MODE:
        raise servo.error(
            f"has an Operating Mode of {mode}; set it to {POSITION_MODE}, position control, {PROVISION}."
        )
    offset = settings["Homing Offset"]
    if offset:
        raise servo.error(
            f"has a Homing Offset of {offset} and shows other positions than it has; set it to 0 {PROVISION}."
        )


def _check_limits(servo: Servo, settings: dict[str, int]) -> None:
    low, high = ticks(servo.model, servo.spec.minimum), ticks(servo.model, servo.spec.maximum)
    lowest, highest = servo.model.layout.lowest, servo.model.layout.highest
    if settings[lowest] > low:
        raise _narrow(servo, lowest, settings[lowest], "minimum", low)
    if settings[highest] < high:
        raise _narrow(servo, highest, settings[highest], "maximum", high)


def _wrong_mode(servo: Servo, mode: str) -> BusError:
    low, high = ticks(servo.model, servo.spec.minimum), ticks(servo.model, servo.spec.maximum)
    return servo.error(f"is in {mode}; set them to {low} and {high} {PROVISION}.")


def _narrow(servo: Servo, register: str, found: int, bound: str, needed: int) -> BusError:
    return servo.error(
        f"has a {register} of {found} ({_degrees(angle(servo.model, found))}), inside the config's {bound} "
        f"of {needed} ({_degrees(angle(servo.model, needed))}); set it to {needed} {PROVISION}, or narrow "
        "the config."
    )


def _check_speed(servo: Servo, limit: int) -> None:
    fastest = limit * servo.model.speed_step
    if servo.spec.max_velocity > fastest:
        raise servo.error(
            f"has a Velocity Limit of {limit} ({fastest:.2f} rad/s), less than the config's maximum of "
            f"{servo.spec.max_velocity:.2f} rad/s; lower the config's, or raise it {PROVISION}."
        )


def _check_replies(servo: Servo, level: int) -> None:
    if level != 2:
        raise servo.error(
            f"has a Status Return Level of {level} and does not confirm what it is told; "
            f"set it to 2 {PROVISION}."
        )


def _check_drive_mode(servo: Servo, mode: int) -> None:
    if mode != 0:
        raise servo.error(
            f"has a Drive Mode of {mode} and turns the wrong way, follows another servo or takes speeds for "
            f"times; set it to 0 {PROVISION}."
        )


def _check_shutdown(servo: Servo, mask: int) -> None:
    missing = servo.model.layout.protected & ~mask
    if missing:
        names = " and ".join(error_names(missing))
        raise servo.error(
            f"has a Shutdown of {mask} and would not protect itself after an {names}; "
            f"set it to {mask | missing} {PROVISION}."
        )
    servo.condition.fatal = mask


def _return_delay(servo: Servo, raw: int) -> float:
    delay = from_raw(servo.register("Return Delay Time"), raw)
    if delay > 0:
        log.warning("%s waits %.0f µs before each reply; Return Delay Time 0 is faster.", servo, delay * 1e6)
    return delay


def _degrees(*angles: float) -> str:
    return " to ".join(f"{math.degrees(a):.1f}" for a in angles) + " degrees"
