"""Control tables of MX servos with firmware 1 (protocol 1.0), as the simulated servos hold them.

Addresses, sizes, defaults and ranges: https://emanual.robotis.com/docs/en/dxl/mx/mx-28/ (and mx-64, mx-106).
Written from the manual for the simulator alone; the driver has its own, so that a mistake shows.
"""

from dataclasses import dataclass

END_OF_EEPROM = 24
"""Registers below this address keep their values without power, and are locked while torque is on."""

TABLE_SIZE = 74


@dataclass(frozen=True, slots=True)
class Cell:
    """One entry of a control table."""

    address: int
    size: int  # bytes, little-endian
    initial: int
    low: int = 0
    high: int = -1  # below `low`: read only

    @property
    def writable(self) -> bool:
        """Whether a client may write it."""
        return self.high >= self.low


@dataclass(frozen=True, slots=True)
class Table:
    """The control table of one model."""

    name: str
    cells: tuple[Cell, ...]

    def defaults(self) -> bytearray:
        """A fresh memory, shape (TABLE_SIZE,)."""
        memory = bytearray(TABLE_SIZE)
        for cell in self.cells:
            memory[cell.address : cell.address + cell.size] = cell.initial.to_bytes(cell.size, "little")
        return memory

    def touched(self, address: int, size: int) -> tuple[Cell, ...]:
        """Cells that share a byte with `address` .. `address + size`."""
        return tuple(c for c in self.cells if c.address < address + size and address < c.address + c.size)


MODEL_NUMBER = Cell(0, 2, 29)
FIRMWARE = Cell(2, 1, 41)
ID = Cell(3, 1, 1, 0, 252)
BAUD = Cell(4, 1, 34, 0, 254)
RETURN_DELAY = Cell(5, 1, 250, 0, 254)
CW_LIMIT = Cell(6, 2, 0, 0, 4095)
CCW_LIMIT = Cell(8, 2, 4095, 0, 4095)
TEMPERATURE_LIMIT = Cell(11, 1, 80, 0, 100)
MAX_TORQUE = Cell(14, 2, 1023, 0, 1023)
RETURN_LEVEL = Cell(16, 1, 2, 0, 2)
TORQUE_ENABLE = Cell(24, 1, 0, 0, 1)
P_GAIN = Cell(28, 1, 32, 0, 254)
GOAL = Cell(30, 2, 2048, 0, 4095)
MOVING_SPEED = Cell(32, 2, 0, 0, 2047)
TORQUE_LIMIT = Cell(34, 2, 1023, 0, 1023)
POSITION = Cell(36, 2, 2048)
SPEED = Cell(38, 2, 0)
LOAD = Cell(40, 2, 0)
VOLTAGE = Cell(42, 1, 120)
TEMPERATURE = Cell(43, 1, 25)
REGISTERED = Cell(44, 1, 0)
MOVING = Cell(46, 1, 0)
LOCK = Cell(47, 1, 0, 0, 1)
REALTIME_TICK = Cell(50, 2, 0)
CURRENT = Cell(68, 2, 2048)
GOAL_ACCELERATION = Cell(73, 1, 0, 0, 254)

_COMMON = (
    FIRMWARE,
    ID,
    BAUD,
    RETURN_DELAY,
    CW_LIMIT,
    CCW_LIMIT,
    TEMPERATURE_LIMIT,
    Cell(12, 1, 60, 50, 160),  # lowest voltage, 0.1 V
    Cell(13, 1, 160, 50, 160),  # highest voltage, 0.1 V
    MAX_TORQUE,
    RETURN_LEVEL,
    Cell(17, 1, 36, 0, 127),  # alarm LED
    Cell(18, 1, 36, 0, 127),  # shutdown
    Cell(20, 2, 0, 0, 65535),  # multi-turn offset
    Cell(22, 1, 1, 1, 4),  # resolution divider
    TORQUE_ENABLE,
    Cell(25, 1, 0, 0, 1),  # LED
    Cell(26, 1, 0, 0, 254),  # D gain
    Cell(27, 1, 0, 0, 254),  # I gain
    P_GAIN,
    GOAL,
    MOVING_SPEED,
    TORQUE_LIMIT,
    POSITION,
    SPEED,
    LOAD,
    VOLTAGE,
    TEMPERATURE,
    REGISTERED,
    MOVING,
    LOCK,
    Cell(48, 2, 0, 0, 1023),  # punch
    REALTIME_TICK,
    GOAL_ACCELERATION,
)

_TORQUE_CONTROL = (CURRENT, Cell(70, 1, 0, 0, 1), Cell(71, 2, 0, 0, 2047))
"""What MX-64 and MX-106 have and MX-28 has not: current, torque control mode, goal torque."""

MX_28 = Table("MX-28", (MODEL_NUMBER, *_COMMON))
MX_64 = Table("MX-64", (Cell(0, 2, 310), *_COMMON, *_TORQUE_CONTROL))
MX_106 = Table("MX-106", (Cell(0, 2, 320), Cell(10, 1, 0, 0, 3), *_COMMON, *_TORQUE_CONTROL))

TABLES = {table.name: table for table in (MX_28, MX_64, MX_106)}
