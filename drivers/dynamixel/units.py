"""Raw register values to SI units and back."""

from dataclasses import dataclass
from struct import Struct

from drivers.dynamixel.firmware1 import ERRORS
from drivers.dynamixel.firmware2 import HARDWARE_ERRORS
from drivers.dynamixel.motion import Goal
from drivers.dynamixel.registers import SIGN_BIT
from drivers.dynamixel.tables import ALARM_SHUTDOWN, ServoModel


@dataclass(frozen=True, slots=True)
class Reading:
    """The window of one servo, in SI units."""

    position: float  # rad
    velocity: float  # rad/s, positive counter-clockwise
    load: float  # share of the greatest torque, -1..1, positive counter-clockwise
    voltage: float  # V
    temperature: float  # degrees Celsius
    errors: tuple[str, ...] = ()  # in the manual's words
    trajectory: tuple[float, float] | None = None  # rad, rad/s: where firmware 2 wants the joint to be now


def angle(model: ServoModel, ticks: int) -> float:
    """The angle (rad) of a position in ticks; the model's centre is 0."""
    return (ticks - model.centre) * model.tick


def ticks(model: ServoModel, angle: float) -> int:
    """The position nearest to `angle` (rad), within the model's range."""
    return min(max(model.centre + round(angle / model.tick), 0), model.last_tick)


def moving_speed(model: ServoModel, speed: float) -> int:
    """Moving Speed or Profile Velocity for `speed` (rad/s), at least 1.

    Never 0, which is "maximum rpm without controlling the speed" to firmware 1 and "an infinite velocity" to
    firmware 2: https://emanual.robotis.com/docs/en/dxl/mx/mx-28/#moving-speed, .../mx-28-2/#profile-velocity
    """
    step = model.speed_step
    if not speed > step:  # also what is not a number
        return 1
    return round(min(speed / step, model.layout.fastest))


def acceleration(model: ServoModel, value: float) -> int:
    """Goal or Profile Acceleration for `value` (rad/s²); only 0 becomes 0, which is no limit at all."""
    if value <= 0:
        return 0
    step = model.table[model.layout.acceleration].per_lsb
    return min(max(round(value / step), 1), model.layout.greatest_acceleration)


def goal_bytes(model: ServoModel, goal: Goal) -> bytes:
    """What is written to the registers of `Layout.goal`: 4 bytes to firmware 1, 8 to firmware 2."""
    position, speed = ticks(model, goal.position), moving_speed(model, goal.speed)
    if model.layout.protocol == 1:
        return position.to_bytes(2, "little") + speed.to_bytes(2, "little")
    return speed.to_bytes(4, "little") + position.to_bytes(4, "little")


def error_names(error: int) -> tuple[str, ...]:
    """What the error byte of a status packet of protocol 1.0 says."""
    return tuple(name for bit, name in enumerate(ERRORS) if error >> bit & 1)


def hardware_errors(status: int) -> tuple[str, ...]:
    """What Hardware Error Status says."""
    return tuple(name for bit, name in enumerate(HARDWARE_ERRORS) if name and status >> bit & 1)


def reading(model: ServoModel, error: int, window: bytes) -> Reading | None:
    """The reply of a servo to the reading of `Layout.windows[0]`; None if it says what no servo can say.

    The checksum of protocol 1.0 lets one damaged packet in 256 pass, so its values are looked at.
    """
    return _reading_1(model, error, window) if model.layout.protocol == 1 else _reading_2(model, window)


_WINDOW_1 = Struct("<HHHHBB")  # torque limit, position, speed, load, voltage, temperature
_WINDOW_2 = Struct("<hiiiiHB")  # load, velocity, position, their trajectories, voltage, temperature


def _reading_1(model: ServoModel, error: int, window: bytes) -> Reading | None:
    limit, position, speed, load, voltage, temperature = _WINDOW_1.unpack(window)
    if position > model.last_tick or limit > 1023 or speed > 2047 or load > 2047 or error > 127:
        return None
    return Reading(
        position=angle(model, position),
        velocity=_clockwise(speed) * model.speed_step,
        load=_clockwise(load) / 1023,
        voltage=voltage / 10,
        temperature=float(temperature),
        errors=(error_names(error) if error else ()) + (() if limit else (ALARM_SHUTDOWN,)),
    )


def _reading_2(model: ServoModel, window: bytes) -> Reading:
    load, velocity, position, wanted, target, voltage, temperature = _WINDOW_2.unpack(window)
    step = model.speed_step
    return Reading(
        position=angle(model, position),
        velocity=velocity * step,
        load=min(max(load * model.load_step, -1.0), 1.0),
        voltage=voltage / 10,
        temperature=float(temperature),
        trajectory=(angle(model, target), wanted * step),
    )


def _clockwise(raw: int) -> int:
    return SIGN_BIT - raw if raw & SIGN_BIT else raw
