"""One servo behind its control table: what a write does to the servo, and what the servo shows."""

from sim.dynamixel import tables
from sim.dynamixel.packets import Error
from sim.dynamixel.tables import END_OF_EEPROM, TABLE_SIZE, Cell, Table
from sim.servo import CENTRE, SPEED_STEP, TICK, Servo, Setting

SIGN = 1024
"""Bit 10 of speed and load: clockwise."""

ACCELERATION_STEP = 8.583 * TICK * 4096 / 360
"""rad/s² of one step of Goal Acceleration."""

CURRENT_STEP = 0.0045
"""A of one step of the current register."""

ERRORS = {
    "Input Voltage Error": Error.VOLTAGE,
    "Overheating Error": Error.OVERHEATING,
    "Overload Error": Error.OVERLOAD,
}


class Device:
    """Control table of firmware 1 in front of a servo.

    Assumed, since the manual is silent: a write that is refused is refused whole; EEPROM with torque on and
    read-only registers answer with a range error; a goal write switches torque on (lerobot#3585).
    """

    def __init__(self, table: Table, servo: Servo, provisioned: dict[Cell, int]) -> None:
        self.table = table
        self.servo = servo
        self._memory = table.defaults()
        self._registered: tuple[int, bytes] | None = None
        self._told: Setting | None = None
        for cell, value in provisioned.items():
            self._set(cell, value)
        self._boot()

    def get(self, cell: Cell) -> int:
        """Value of a register."""
        return int.from_bytes(self._memory[cell.address : cell.address + cell.size], "little")

    def errors(self) -> Error:
        """What the servo itself complains of."""
        found = Error.NONE
        for complaint in self.servo.errors():
            found |= ERRORS[complaint]
        return found

    def read(self, address: int, size: int) -> tuple[Error, bytes]:
        """`size` bytes from `address`, or a range error and nothing."""
        if not size or address + size > TABLE_SIZE:
            return Error.RANGE, b""
        self._refresh()
        return Error.NONE, bytes(self._memory[address : address + size])

    def write(self, address: int, data: bytes) -> Error:
        """Check everything, then change registers and tell the servo; a refused write changes nothing."""
        self._refresh()
        error, memory = self._judge(address, data)
        if error:
            return error
        cells = self.table.touched(address, len(data))
        if tables.GOAL in cells:
            memory[tables.TORQUE_ENABLE.address] = 1
        self._memory = memory
        if tables.TORQUE_LIMIT in cells and self.get(tables.TORQUE_LIMIT):
            self.servo.restore()
        self._tell()
        return Error.NONE

    def register(self, address: int, data: bytes) -> Error:
        """Keep a write until `act`; it is judged now and again then."""
        self._refresh()
        error, _ = self._judge(address, data)
        if not error:
            self._registered = (address, data)
            self._set(tables.REGISTERED, 1)
        return error

    def act(self) -> Error:
        """Carry out the registered write."""
        if self._registered is None:
            return Error.INSTRUCTION
        address, data = self._registered
        self._registered = None
        self._set(tables.REGISTERED, 0)
        return self.write(address, data)

    def _judge(self, address: int, data: bytes) -> tuple[Error, bytearray]:
        """Why a write is refused, and what the memory would be if it were not."""
        if not data or address + len(data) > TABLE_SIZE:
            return Error.RANGE, self._memory
        memory = bytearray(self._memory)
        memory[address : address + len(data)] = data
        locked = bool(self.get(tables.TORQUE_ENABLE))
        for cell in self.table.touched(address, len(data)):
            value = int.from_bytes(memory[cell.address : cell.address + cell.size], "little")
            if not cell.low <= value <= cell.high or (locked and cell.address < END_OF_EEPROM):
                return Error.RANGE, memory
            if cell is tables.GOAL and not self.get(tables.CW_LIMIT) <= value <= self.get(tables.CCW_LIMIT):
                return Error.ANGLE_LIMIT, memory
        return Error.NONE, memory

    def _tell(self) -> None:
        """Hand the registers to the servo, if they say something new."""
        limit = min(self.get(tables.TORQUE_LIMIT), self.get(tables.MAX_TORQUE))
        setting = Setting(
            goal=(self.get(tables.GOAL) - CENTRE) * TICK,
            speed=self.get(tables.MOVING_SPEED) % SIGN * SPEED_STEP,
            torque_on=bool(self.get(tables.TORQUE_ENABLE)),
            acceleration=self.get(tables.GOAL_ACCELERATION) * ACCELERATION_STEP,
            torque_limit=limit / 1023,
            p_gain=self.get(tables.P_GAIN),
        )
        if setting != self._told:
            self._told = setting
            self.servo.tell(setting)

    def _boot(self) -> None:
        """Start with the defaults above the EEPROM, limp, the goal where the servo is."""
        self._memory[END_OF_EEPROM:] = self.table.defaults()[END_OF_EEPROM:]
        self._set(tables.TORQUE_LIMIT, self.get(tables.MAX_TORQUE))
        self._set(tables.GOAL, self.servo.sense().ticks)
        self.servo.temperature_limit = float(self.get(tables.TEMPERATURE_LIMIT))
        self._registered = self._told = None
        self._boots = self.servo.boots
        self._alarmed = False

    def _refresh(self) -> None:
        """Bring the present values up to date."""
        servo = self.servo
        if servo.boots != self._boots:
            self._boot()
        seen = servo.sense()
        self._set(tables.POSITION, seen.ticks)
        self._set(tables.SPEED, _signed(seen.speed))
        self._set(tables.LOAD, _signed(round(seen.load * 1023)))
        self._set(tables.VOLTAGE, round(seen.voltage * 10))
        self._set(tables.TEMPERATURE, round(seen.temperature))
        self._set(tables.MOVING, int(seen.moving))
        self._set(tables.REALTIME_TICK, int(servo.time * 1000) % 32768)
        if tables.CURRENT in self.table.cells:
            self._set(tables.CURRENT, 2048 + round(seen.current / CURRENT_STEP))
        self._follow_alarm()

    def _follow_alarm(self) -> None:
        """Torque Limit reads 0 while an alarm stands, and is back once it was lifted at the servo itself."""
        alarmed = bool(self.servo.shutdown)
        if alarmed:
            self._set(tables.TORQUE_LIMIT, 0)
        elif self._alarmed and not self.get(tables.TORQUE_LIMIT):
            self._set(tables.TORQUE_LIMIT, self.get(tables.MAX_TORQUE))
        self._alarmed = alarmed

    def _set(self, cell: Cell, value: int) -> None:
        self._memory[cell.address : cell.address + cell.size] = value.to_bytes(cell.size, "little")


def _signed(value: int) -> int:
    """Sign and magnitude: clockwise values have bit 10 set."""
    magnitude = min(abs(value), SIGN - 1)
    return magnitude + SIGN if value < 0 else magnitude
