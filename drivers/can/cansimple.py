"""ODrive's CANSimple, sans-I/O: firmware 0.6 (Pro, S1, Micro). Never tried on hardware.

Identifier: node << 5 | command; numbers little-endian.
https://docs.odriverobotics.com/v/latest/manual/can-protocol.html

Firmware 0.5 (v3.6) has the same frames for all that moves, but other bits for errors, and not the command
for disarm reasons. What is said about the firmware's inside is from the source of 0.5.6, the last that is
open, `Firmware/communication/can/can_simple.cpp` and `Firmware/MotorControl/controller.cpp`.
"""

import math
import struct
from collections.abc import Callable

from drivers.can.codec import (
    Bounds,
    Current,
    Disarmed,
    Estimate,
    Go,
    Heartbeat,
    Heat,
    Motion,
    Report,
    Rest,
    Spin,
    Supply,
)
from drivers.can.link import Frame

COMMAND_BITS = 5

HEARTBEAT = 0x01
ESTOP = 0x02
GET_ERROR = 0x03
SET_AXIS_STATE = 0x07
GET_ENCODER_ESTIMATES = 0x09
SET_CONTROLLER_MODE = 0x0B
SET_INPUT_POS = 0x0C
SET_INPUT_VEL = 0x0D
SET_LIMITS = 0x0F
SET_TRAJ_VEL_LIMIT = 0x11
SET_TRAJ_ACCEL_LIMITS = 0x12
GET_IQ = 0x14
GET_TEMPERATURE = 0x15
GET_BUS_VOLTAGE_CURRENT = 0x17
CLEAR_ERRORS = 0x18

IDLE, CLOSED_LOOP_CONTROL = 1, 8
VELOCITY_CONTROL, POSITION_CONTROL = 2, 3
PASSTHROUGH, TRAP_TRAJ = 1, 5

ERRORS = {
    0x1: "INITIALIZING",
    0x2: "SYSTEM_LEVEL",
    0x4: "TIMING_ERROR",
    0x8: "MISSING_ESTIMATE",
    0x10: "BAD_CONFIG",
    0x20: "DRV_FAULT",
    0x40: "MISSING_INPUT",
    0x100: "DC_BUS_OVER_VOLTAGE",
    0x200: "DC_BUS_UNDER_VOLTAGE",
    0x400: "DC_BUS_OVER_CURRENT",
    0x800: "DC_BUS_OVER_REGEN_CURRENT",
    0x1000: "CURRENT_LIMIT_VIOLATION",
    0x2000: "MOTOR_OVER_TEMP",
    0x4000: "INVERTER_OVER_TEMP",
    0x8000: "VELOCITY_LIMIT_VIOLATION",
    0x10000: "POSITION_LIMIT_VIOLATION",
    0x1000000: "WATCHDOG_TIMER_EXPIRED",
    0x2000000: "ESTOP_REQUESTED",
    0x4000000: "SPINOUT_DETECTED",
    0x8000000: "BRAKE_RESISTOR_DISARMED",
    0x10000000: "THERMISTOR_DISCONNECTED",
    0x40000000: "CALIBRATION_ERROR",
}
"""ODrive.Error, https://docs.odriverobotics.com/v/latest/fibre_types/com_odriverobotics_ODrive.html"""

POLLS = (GET_IQ, GET_ERROR, GET_IQ, GET_BUS_VOLTAGE_CURRENT, GET_IQ, GET_TEMPERATURE)
"""Asked in turn, because the controller does not send them by itself unless it is configured to."""


def names(errors: int) -> tuple[str, ...]:
    """Names of the bits that are set; those that are not in the manual by their value."""
    bits = (1 << bit for bit in range(32) if errors >> bit & 1)
    return tuple(ERRORS.get(bit, f"ERROR_0x{bit:X}") for bit in bits)


def _heartbeat(data: bytes) -> Report:
    errors, state = struct.unpack_from("<IB", data)
    return Heartbeat(state == CLOSED_LOOP_CONTROL, names(errors))


def _error(data: bytes) -> Report:
    _, reason = struct.unpack("<II", data)
    return Disarmed(names(reason))


def _estimate(data: bytes) -> Report:
    return Estimate(*struct.unpack("<ff", data))


def _current(data: bytes) -> Report:
    _, measured = struct.unpack("<ff", data)
    return Current(measured)


def _supply(data: bytes) -> Report:
    volts, _ = struct.unpack("<ff", data)
    return Supply(volts)


def _heat(data: bytes) -> Report:
    sensors = struct.unpack("<ff", data)
    return Heat(max((sensor for sensor in sensors if math.isfinite(sensor)), default=math.nan))


DECODERS: dict[int, Callable[[bytes], Report]] = {
    HEARTBEAT: _heartbeat,
    GET_ERROR: _error,
    GET_ENCODER_ESTIMATES: _estimate,
    GET_IQ: _current,
    GET_BUS_VOLTAGE_CURRENT: _supply,
    GET_TEMPERATURE: _heat,
}
"""All of these have 8 bytes."""


class CanSimple:
    """A `CanCodec`."""

    def decode(self, frame: Frame) -> tuple[int, Report] | None:
        """See `CanCodec`. A number that is not finite makes the frame garbage."""
        decoder = DECODERS.get(frame.id & 0x1F)
        if decoder is None or frame.remote or len(frame.data) != 8 or not 0 <= frame.id < 0x800:
            return None
        report = decoder(frame.data)
        return (frame.id >> COMMAND_BITS, report) if _sound(report) else None

    def prepare(self, node: int, bounds: Bounds, position: float) -> tuple[Frame, ...]:
        """Limits each time, because a controller that was reset has forgotten them."""
        acceleration = struct.pack("<ff", bounds.acceleration, bounds.acceleration)
        return (
            _frame(node, SET_LIMITS, struct.pack("<ff", bounds.velocity, bounds.current)),
            _frame(node, SET_TRAJ_ACCEL_LIMITS, acceleration),
            *self.move(node, Rest(position), None),
        )

    def arm(self, node: int, on: bool) -> Frame:
        """Closed loop control, or idle."""
        return _frame(node, SET_AXIS_STATE, struct.pack("<I", CLOSED_LOOP_CONTROL if on else IDLE))

    def move(self, node: int, motion: Motion, before: Motion | None) -> tuple[Frame, ...]:
        """Input, mode, input: no order of mode and input alone is safe with every firmware.

        0.5.6 sets the goal to the present position when the mode becomes position control; a firmware that
        did not would jump to an old goal if the new one came only after the mode.
        """
        told = before is not None and type(before) is type(motion)
        match motion:
            case Spin(velocity):
                entry = (_velocity(node, 0.0), _mode(node, VELOCITY_CONTROL, PASSTHROUGH))
                return (*(() if told else entry), _velocity(node, velocity))
            case Rest(position):
                goal = _position(node, position)
                return (goal,) if told else (goal, _mode(node, POSITION_CONTROL, PASSTHROUGH), goal)
            case Go(position, speed):
                limit = _frame(node, SET_TRAJ_VEL_LIMIT, struct.pack("<f", speed))
                mode = () if told else (_mode(node, POSITION_CONTROL, TRAP_TRAJ),)
                return (limit, *mode, _position(node, position))

    def poll(self, node: int, turn: int) -> Frame:
        """Current every other turn, the rest more seldom."""
        return Frame(node << COMMAND_BITS | POLLS[turn % len(POLLS)], remote=True)

    def clear_errors(self, node: int) -> Frame:
        """Without making it blink (identify)."""
        return _frame(node, CLEAR_ERRORS, b"\x00")

    def estop(self, node: int) -> Frame:
        """No data."""
        return _frame(node, ESTOP, b"")


def _sound(report: Report) -> bool:
    match report:
        case Estimate(position, velocity):
            return math.isfinite(position) and math.isfinite(velocity)
        case Current(value) | Supply(value) | Heat(value):
            return math.isfinite(value)
        case _:
            return True


def _mode(node: int, control: int, shape: int) -> Frame:
    return _frame(node, SET_CONTROLLER_MODE, struct.pack("<II", control, shape))


def _velocity(node: int, velocity: float) -> Frame:
    return _frame(node, SET_INPUT_VEL, struct.pack("<ff", velocity, 0.0))


def _position(node: int, position: float) -> Frame:
    return _frame(node, SET_INPUT_POS, struct.pack("<fhh", position, 0, 0))


def _frame(node: int, command: int, data: bytes) -> Frame:
    return Frame(node << COMMAND_BITS | command, data)
