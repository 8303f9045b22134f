"""What a control table is made of, and what a servo may have against a write; the same for both protocols."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum, auto


class Refusal(Enum):
    """Why an instruction was not carried out; each protocol has its own numbers for these."""

    NONE = auto()
    RESULT = auto()  # failed all the same
    INSTRUCTION = auto()  # unknown, or an action without anything registered
    CHECKSUM = auto()
    RANGE = auto()  # a value that the register cannot hold
    LENGTH = auto()  # a part of a register
    LIMIT = auto()  # a goal outside the limits
    ACCESS = auto()  # read only, locked or no register


@dataclass(frozen=True, slots=True)
class Cell:
    """One entry of a control table."""

    address: int
    size: int  # bytes, little-endian
    initial: int
    low: int = 0
    high: int = -1  # below `low`: read only
    signed: bool = False  # two's complement

    @property
    def writable(self) -> bool:
        """Whether a client may write it."""
        return self.high >= self.low

    @property
    def end(self) -> int:
        """The address after the last byte."""
        return self.address + self.size

    def value(self, memory: bytes | bytearray) -> int:
        """What `memory` holds here."""
        end = self.address + self.size
        return int.from_bytes(memory[self.address : end], "little", signed=self.signed)

    def put(self, memory: bytearray, value: int) -> None:
        """Have `memory` hold `value` here, as far as it fits."""
        end = self.address + self.size
        memory[self.address : end] = (value % (1 << 8 * self.size)).to_bytes(self.size, "little")


@dataclass(frozen=True, slots=True)
class Common:
    """Where a table keeps what every servo has."""

    model: Cell
    firmware: Cell
    id: Cell
    baud: Cell
    return_delay: Cell  # 2 µs
    return_level: Cell
    lowest: Cell  # position limit
    highest: Cell  # position limit
    torque: Cell
    goal: Cell
    registered: Cell


@dataclass(frozen=True, slots=True)
class Table:
    """The control table of one model."""

    name: str
    common: Common
    cells: tuple[Cell, ...]
    size: int  # bytes
    end_of_eeprom: int  # what lies below keeps its values without power, and is locked while torque is on
    rates: Mapping[int, int]  # bit/s by the value of the baud register
    bulk_read: bool = True  # whether it takes part in protocol 1.0's
    turnaround: float = 50e-6  # s from request to reply without return delay
    addresses: frozenset[int] = field(init=False)
    _touched: dict[tuple[int, int], tuple[Cell, ...]] = field(init=False, default_factory=dict, compare=False)

    def __post_init__(self) -> None:
        """Note where cells begin."""
        object.__setattr__(self, "addresses", frozenset(cell.address for cell in self.cells))

    def has(self, cell: Cell) -> bool:
        """Whether this model has it."""
        return cell.address in self.addresses

    def defaults(self) -> bytearray:
        """A fresh memory, shape (size,)."""
        memory = bytearray(self.size)
        for cell in self.cells:
            cell.put(memory, cell.initial)
        return memory

    def touched(self, address: int, size: int) -> tuple[Cell, ...]:
        """Cells that share a byte with `address` .. `address + size`."""
        found = self._touched.get((address, size))
        if found is None:
            found = tuple(c for c in self.cells if c.address < address + size and address < c.end)
            self._touched[address, size] = found  # the same few goals are written every tick
        return found

    def baud_register(self, baud: int) -> int:
        """The value of the baud register that comes nearest to `baud` (bit/s)."""
        return min(self.rates, key=lambda register: abs(self.rates[register] - baud))
