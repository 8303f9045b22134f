"""The simulated controllers' own reading and writing of CANSimple frames, apart from the driver's.

Tables of fields in the order and the words of the published DBC (ODrive 0.6.10), read and written one
field at a time, so that a mistake in the driver's layouts does not meet its mirror image here.
"""

import struct
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, TypeAlias

Kind: TypeAlias = Literal["float", "u32", "u16", "i16", "u8"]

WIDTH: Mapping[Kind, int] = {"float": 4, "u32": 4, "u16": 2, "i16": 2, "u8": 1}


@dataclass(frozen=True, slots=True)
class Field:
    """One number in a frame."""

    name: str
    kind: Kind
    start: int  # byte


@dataclass(frozen=True, slots=True)
class Layout:
    """One kind of frame."""

    command: int
    size: int
    fields: tuple[Field, ...]

    def pack(self, **values: float) -> bytes:
        """The frame's data; fields that are not named are 0."""
        data = bytearray(self.size)
        for field in self.fields:
            data[field.start : field.start + WIDTH[field.kind]] = _encoded(values.get(field.name, 0), field)
        return bytes(data)

    def unpack(self, data: bytes) -> dict[str, float] | None:
        """Numbers by name; None when the size is another."""
        if len(data) != self.size:
            return None
        return {
            field.name: _decoded(data[field.start :][: WIDTH[field.kind]], field) for field in self.fields
        }


def _layout(command: int, *fields: tuple[str, Kind], size: int = 0) -> Layout:
    places: list[Field] = []
    start = 0
    for name, kind in fields:
        places.append(Field(name, kind, start))
        start += WIDTH[kind]
    return Layout(command, size or start, tuple(places))


HEARTBEAT = _layout(
    0x01, ("Axis_Error", "u32"), ("Axis_State", "u8"), ("Procedure_Result", "u8"), ("Done", "u8"), size=8
)
ESTOP = _layout(0x02)
GET_ERROR = _layout(0x03, ("Active_Errors", "u32"), ("Disarm_Reason", "u32"))
SET_AXIS_STATE = _layout(0x07, ("Axis_Requested_State", "u32"))
ENCODER_ESTIMATES = _layout(0x09, ("Pos_Estimate", "float"), ("Vel_Estimate", "float"))
CONTROLLER_MODE = _layout(0x0B, ("Control_Mode", "u32"), ("Input_Mode", "u32"))
INPUT_POS = _layout(0x0C, ("Input_Pos", "float"), ("Vel_FF", "i16"), ("Torque_FF", "i16"))
INPUT_VEL = _layout(0x0D, ("Input_Vel", "float"), ("Input_Torque_FF", "float"))
LIMITS = _layout(0x0F, ("Velocity_Limit", "float"), ("Current_Limit", "float"))
TRAJ_VEL_LIMIT = _layout(0x11, ("Traj_Vel_Limit", "float"))
TRAJ_ACCEL_LIMITS = _layout(0x12, ("Traj_Accel_Limit", "float"), ("Traj_Decel_Limit", "float"))
IQ = _layout(0x14, ("Iq_Setpoint", "float"), ("Iq_Measured", "float"))
TEMPERATURE = _layout(0x15, ("FET_Temperature", "float"), ("Motor_Temperature", "float"))
BUS_VOLTAGE_CURRENT = _layout(0x17, ("Bus_Voltage", "float"), ("Bus_Current", "float"))
CLEAR_ERRORS = _layout(0x18, ("Identify", "u8"))


def _encoded(value: float, field: Field) -> bytes:
    if field.kind == "float":
        return struct.pack("<f", value)
    return int(value).to_bytes(WIDTH[field.kind], "little", signed=field.kind == "i16")


def _decoded(data: bytes, field: Field) -> float:
    if field.kind == "float":
        (value,) = struct.unpack("<f", data)
        return float(value)
    return int.from_bytes(data, "little", signed=field.kind == "i16")
