"""Raw register values to SI units and back."""

from dataclasses import dataclass

from drivers.dynamixel.motion import Goal
from drivers.dynamixel.tables import ALARM_SHUTDOWN, ERRORS, MX_28, Register, Signed

CENTRE = 2048
"""The position (ticks) that is 0 rad."""

LAST_TICK = 4095
FASTEST = 1023
"""The greatest Moving Speed of joint mode."""

WINDOW = slice(MX_28["Torque Limit"].address, MX_28["Present Temperature"].end)
"""What is read in every round: 34 to 43, Torque Limit (0 after an overload) to Present Temperature."""

WINDOW_SIZE = WINDOW.stop - WINDOW.start

SIGN_BIT = 1 << 10


@dataclass(frozen=True, slots=True)
class Reading:
    """The window of one servo, in SI units."""

    position: float  # rad
    velocity: float  # rad/s, positive counter-clockwise
    load: float  # share of the greatest torque, -1..1, positive counter-clockwise
    voltage: float  # V
    temperature: float  # degrees Celsius
    errors: tuple[str, ...]  # in the manual's words


def to_raw(register: Register, data: bytes, start: int = 0) -> int:
    """The value of `register` in `data`, which begins at address `start`, unsigned."""
    return int.from_bytes(data[register.address - start : register.end - start], "little")


def from_raw(register: Register, raw: int) -> float:
    """`raw` in the register's unit."""
    return _with_sign(register, raw) * register.per_lsb


def angle(ticks: int) -> float:
    """The angle (rad) of a position in ticks; 2048 is 0."""
    return from_raw(MX_28["Present Position"], ticks - CENTRE)


def ticks(angle: float) -> int:
    """The position nearest to `angle` (rad), 0..4095 ticks."""
    return min(max(CENTRE + round(angle / MX_28["Goal Position"].per_lsb), 0), LAST_TICK)


def moving_speed(speed: float) -> int:
    """Moving Speed, 1..1023, for `speed` (rad/s).

    Never 0, which the manual defines as "maximum rpm without controlling the speed":
    https://emanual.robotis.com/docs/en/dxl/mx/mx-28/#moving-speed
    """
    step = MX_28["Moving Speed"].per_lsb
    if not speed > step:  # also what is not a number
        return 1
    return round(min(speed / step, FASTEST))


def acceleration(value: float) -> int:
    """Goal Acceleration, 0..254, for `value` (rad/s²); only 0 becomes 0, which is no limit at all."""
    if value <= 0:
        return 0
    return min(max(round(value / MX_28["Goal Acceleration"].per_lsb), 1), 254)


def goal_bytes(goal: Goal) -> bytes:
    """What is written to Goal Position and Moving Speed, 4 bytes."""
    return ticks(goal.position).to_bytes(2, "little") + moving_speed(goal.speed).to_bytes(2, "little")


def error_names(error: int) -> tuple[str, ...]:
    """What the error byte of a status packet says."""
    return tuple(name for bit, name in enumerate(ERRORS) if error >> bit & 1)


def reading(error: int, window: bytes) -> Reading:
    """A servo's reply to the reading of its window."""
    shut_down = to_raw(MX_28["Torque Limit"], window, WINDOW.start) == 0
    return Reading(
        position=angle(to_raw(MX_28["Present Position"], window, WINDOW.start)),
        velocity=_value("Present Speed", window),
        load=_value("Present Load", window),
        voltage=_value("Present Voltage", window),
        temperature=_value("Present Temperature", window),
        errors=error_names(error) + ((ALARM_SHUTDOWN,) if shut_down else ()),
    )


def _value(name: str, window: bytes) -> float:
    return from_raw(MX_28[name], to_raw(MX_28[name], window, WINDOW.start))


def _with_sign(register: Register, raw: int) -> int:
    match register.signed:
        case Signed.NO:
            return raw
        case Signed.BIT_10:
            return -(raw & (SIGN_BIT - 1)) if raw & SIGN_BIT else raw
        case Signed.OFFSET_2048:
            return raw - 2048
        case Signed.TWOS:
            bits = 8 * register.size
            return raw - (1 << bits) if raw >> (bits - 1) else raw
