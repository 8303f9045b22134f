"""One line of a servo's control table, as data."""

from dataclasses import dataclass
from enum import StrEnum
from typing import Literal, TypeAlias

Unit: TypeAlias = Literal["", "bit/s", "s", "rad", "degrees Celsius", "V", "rad/s", "A", "rad/s²"]


class Signed(StrEnum):
    """How a register holds values below zero."""

    NO = "never below zero"
    BIT_10 = "bit 10 set: clockwise"
    OFFSET_2048 = "2048 is zero"
    TWOS = "two's complement"


SIGN_BIT = 1 << 10


@dataclass(frozen=True, slots=True)
class Register:
    """One line of a control table; values are little-endian."""

    address: int
    size: int  # bytes
    signed: Signed = Signed.NO
    unit: Unit = ""
    per_lsb: float = 1.0  # `unit` per step

    @property
    def end(self) -> int:
        """The address after the last byte."""
        return self.address + self.size


def to_raw(register: Register, data: bytes, start: int = 0) -> int:
    """The value of `register` in `data`, which begins at address `start`, unsigned."""
    return int.from_bytes(data[register.address - start : register.end - start], "little")


def from_raw(register: Register, raw: int) -> float:
    """`raw` in the register's unit."""
    return with_sign(register, raw) * register.per_lsb


def with_sign(register: Register, raw: int) -> int:
    """`raw`, an unsigned number, as the register means it."""
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
