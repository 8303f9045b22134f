"""One servo behind its control table: what is the same whatever its firmware."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import ClassVar

from sim.dynamixel.cells import Cell, Refusal, Table
from sim.servo import Servo, Setting

TICKS_PER_S = 1000
"""Of the Realtime Tick register, which wraps at 32 768."""


class Device(ABC):
    """A control table in front of a servo; what a firmware does with it is in the classes derived from this.

    Assumed, since the manuals are silent: a write that is refused is refused whole.
    """

    whole: ClassVar[bool] = False
    """Whether a write to a part of a register is refused."""

    def __init__(self, table: Table, servo: Servo, provisioned: Mapping[Cell, int]) -> None:
        self.table = table
        self.servo = servo
        self.fast = False
        """Whether it answers fast reads: two MX did not in dynamixel_hardware_interface#50."""
        self._memory = table.defaults()
        self._registered: tuple[int, bytes] | None = None
        self._told: Setting | None = None
        for cell, value in provisioned.items():
            self._set(cell, value)
        self._boot()
        self._recall()

    @property
    @abstractmethod
    def protocol(self) -> int:
        """1 or 2: what it listens to."""

    @property
    def return_level(self) -> int:
        """0: answers a ping, 1: and reads, 2: everything; not in every model's EEPROM."""
        return self.get(self.table.common.return_level)

    def get(self, cell: Cell) -> int:
        """Value of a register."""
        return cell.value(self._memory)

    def provision(self, cell: Cell, value: int) -> None:
        """Change a register behind everybody's back, as the maker's tool does."""
        self._set(cell, value)
        self._recall()

    def complaints(self) -> tuple[str, ...]:
        """What the servo itself complains of, in the manual's words."""
        return self.servo.errors()

    @abstractmethod
    def alert(self) -> bool:
        """Whether a status of protocol 2.0 is to point at the Hardware Error Status."""

    def read(self, address: int, size: int) -> tuple[Refusal, bytes]:
        """`size` bytes from `address`, or a refusal and nothing."""
        if not size or address + size > self.table.size:
            return Refusal.ACCESS, b""
        self._refresh()
        return Refusal.NONE, bytes(self._memory[address : address + size])

    def write(self, address: int, data: bytes) -> Refusal:
        """Check everything, then change registers and tell the servo; a refused write changes nothing."""
        self._notice_boot()
        self._follow_alarm()
        refusal = self._judge(address, data)
        if refusal is Refusal.NONE:
            self._memory[address : address + len(data)] = data
            if address < self.table.end_of_eeprom:
                self._recall()
            self._written(self.table.touched(address, len(data)))
            self._tell()
        return refusal

    def register(self, address: int, data: bytes) -> Refusal:
        """Keep a write until `act`; it is judged now and again then."""
        self._refresh()
        refusal = self._judge(address, data)
        if refusal is Refusal.NONE:
            self._registered = (address, data)
            self._set(self.table.common.registered, 1)
        return refusal

    def act(self) -> Refusal:
        """Carry out the registered write."""
        self._refresh()
        if self._registered is None:
            return Refusal.INSTRUCTION
        address, data = self._registered
        self._registered = None
        self._set(self.table.common.registered, 0)
        return self.write(address, data)

    def reset(self, keep: tuple[Cell, ...]) -> None:
        """Everything as it left the factory but `keep`, and a reboot."""
        kept = {cell: self.get(cell) for cell in (self.table.common.model, *keep)}
        self._memory = self.table.defaults()
        for cell, value in kept.items():
            self._set(cell, value)
        self._recall()
        self.servo.reboot()

    def _judge(self, address: int, data: bytes) -> Refusal:
        """Why a write is refused."""
        if not data or address + len(data) > self.table.size:
            return Refusal.ACCESS
        memory = bytearray(self._memory)
        memory[address : address + len(data)] = data
        locked = bool(self.get(self.table.common.torque))
        for cell in self.table.touched(address, len(data)):
            if not cell.writable or (locked and cell.address < self.table.end_of_eeprom):
                return Refusal.ACCESS
            if self.whole and (cell.address < address or cell.end > address + len(data)):
                return Refusal.LENGTH
            refusal = self._judge_value(cell, cell.value(memory))
            if refusal is not Refusal.NONE:
                return refusal
        return Refusal.NONE

    def _judge_value(self, cell: Cell, value: int) -> Refusal:
        """Why `cell` is not to hold `value`."""
        return Refusal.NONE if cell.low <= value <= cell.high else Refusal.RANGE

    @abstractmethod
    def _written(self, cells: tuple[Cell, ...]) -> None:
        """What follows from a write to `cells` besides what they hold."""

    @abstractmethod
    def _setting(self) -> Setting:
        """What the registers ask of the servo."""

    def _tell(self) -> None:
        """Hand the registers to the servo, if they say something new."""
        setting = self._setting()
        if setting != self._told:
            self._told = setting
            self.servo.tell(setting)

    def _boot(self) -> None:
        """Start with the defaults above the EEPROM, limp, the goal where the servo is."""
        start = self.table.end_of_eeprom
        self._memory[start:] = self.table.defaults()[start:]
        self._set(self.table.common.goal, self.servo.sense().ticks)
        self._registered = self._told = None
        self._boots = self.servo.boots

    def _recall(self) -> None:
        """Keep at hand what every packet asks for; to be called when the EEPROM has changed."""
        common = self.table.common
        self.id = self.get(common.id)
        self.baud = self.table.rates.get(self.get(common.baud), 0)
        """bit/s."""
        self.return_delay = self.table.turnaround + 2e-6 * self.get(common.return_delay)
        """s from a request to the reply."""

    def _refresh(self) -> None:
        """Bring the present values up to date."""
        self._notice_boot()
        self._show()

    def _notice_boot(self) -> None:
        if self.servo.boots != self._boots:
            self._boot()

    @abstractmethod
    def _follow_alarm(self) -> None:
        """Bring those registers up to date that an alarm changes."""

    @abstractmethod
    def _show(self) -> None:
        """Have the registers show what the sensors say."""

    def _set(self, cell: Cell, value: int) -> None:
        cell.put(self._memory, value)
