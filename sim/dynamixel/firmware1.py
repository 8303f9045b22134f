"""Servos that speak protocol 1.0 only: MX with firmware 1, and AX."""

from collections.abc import Mapping

from sim.dynamixel import tables1
from sim.dynamixel.cells import Cell, Refusal, Table
from sim.dynamixel.device import TICKS_PER_S, Device
from sim.servo import STIFFNESS, Servo, Setting
from sim.servo_models import MX_SCALE

SIGN = 1024
"""Bit 10 of speed and load: clockwise."""

ACCELERATION_STEP = 8.583 * MX_SCALE.tick * 4096 / 360
"""rad/s² of one step of Goal Acceleration."""

CURRENT_STEP = 0.0045
"""A of one step of the current register."""


class Firmware1(Device):
    """An MX.

    Assumed, since the manual is silent: EEPROM with torque on and read-only registers answer with a range
    error; a goal write switches torque on (lerobot#3585).
    """

    def __init__(self, table: Table, servo: Servo, provisioned: Mapping[Cell, int]) -> None:
        self._alarmed = False
        super().__init__(table, servo, provisioned)

    @property
    def protocol(self) -> int:
        """Protocol 1.0."""
        return 1

    def alert(self) -> bool:
        """Protocol 1.0 has none."""
        return False

    def _judge_value(self, cell: Cell, value: int) -> Refusal:
        refusal = super()._judge_value(cell, value)
        lowest, highest = self.get(tables1.CW_LIMIT), self.get(tables1.CCW_LIMIT)
        if cell.address == tables1.GOAL.address and refusal is Refusal.NONE:
            return Refusal.NONE if lowest <= value <= highest else Refusal.LIMIT
        return refusal

    def _arms(self, cell: Cell) -> bool:
        """Whether a write to `cell` switches torque on."""
        return cell.address == tables1.GOAL.address

    def _written(self, cells: tuple[Cell, ...]) -> None:
        if any(self._arms(cell) for cell in cells):
            self._set(tables1.TORQUE_ENABLE, 1)
        if tables1.TORQUE_LIMIT in cells and self.get(tables1.TORQUE_LIMIT):
            self.servo.restore()

    def _stiffness(self) -> float:
        return STIFFNESS * self.get(tables1.P_GAIN) / tables1.P_GAIN.initial

    def _setting(self) -> Setting:
        scale = self.servo.model.scale
        return Setting(
            goal=scale.angle(self.get(tables1.GOAL)),
            speed=self.get(tables1.MOVING_SPEED) % SIGN * scale.speed,
            torque_on=bool(self.get(tables1.TORQUE_ENABLE)),
            acceleration=self._acceleration(),
            torque_limit=min(self.get(tables1.TORQUE_LIMIT), self.get(tables1.MAX_TORQUE)) / 1023,
            stiffness=self._stiffness(),
        )

    def _acceleration(self) -> float:
        return self.get(tables1.GOAL_ACCELERATION) * ACCELERATION_STEP

    def _boot(self) -> None:
        super()._boot()
        self._set(tables1.TORQUE_LIMIT, self.get(tables1.MAX_TORQUE))
        self.servo.temperature_limit = float(self.get(tables1.TEMPERATURE_LIMIT))
        limits = self.get(tables1.LOWEST_VOLTAGE), self.get(tables1.HIGHEST_VOLTAGE)
        self.servo.voltage_limits = (limits[0] / 10, limits[1] / 10)
        self._alarmed = False

    def _show(self) -> None:
        seen = self.servo.sense()
        self._set(tables1.POSITION, seen.ticks)
        self._set(tables1.SPEED, _signed(seen.speed))
        self._set(tables1.LOAD, _signed(round(seen.load * 1023)))
        self._set(tables1.VOLTAGE, round(seen.voltage * 10))
        self._set(tables1.TEMPERATURE, round(seen.temperature))
        self._set(tables1.MOVING, int(seen.moving))
        if self.table.has(tables1.REALTIME_TICK):
            self._set(tables1.REALTIME_TICK, int(self.servo.time * TICKS_PER_S) % 32768)
        if self.table.has(tables1.CURRENT):
            self._set(tables1.CURRENT, 2048 + round(seen.current / CURRENT_STEP))
        self._follow_alarm()

    def _follow_alarm(self) -> None:
        """Torque Limit reads 0 while an alarm stands, and is back once it was lifted at the servo itself."""
        alarmed = bool(self.servo.shutdown)
        if alarmed:
            self._set(tables1.TORQUE_LIMIT, 0)
        elif self._alarmed and not self.get(tables1.TORQUE_LIMIT):
            self._set(tables1.TORQUE_LIMIT, self.get(tables1.MAX_TORQUE))
        self._alarmed = alarmed


class Ax(Firmware1):
    """An AX: compliance slopes instead of gains, no acceleration, and armed by a speed too (pyluos#59)."""

    def _arms(self, cell: Cell) -> bool:
        return cell.address in (tables1.GOAL.address, tables1.MOVING_SPEED.address)

    def _stiffness(self) -> float:
        """Full duty at an error of Compliance Slope; the mean of both directions."""
        slope = (self.get(tables1.CW_SLOPE) + self.get(tables1.CCW_SLOPE)) / 2
        return 1 / (slope * self.servo.model.scale.tick)

    def _acceleration(self) -> float:
        return 0.0


def _signed(value: int) -> int:
    """Sign and magnitude: clockwise values have bit 10 set."""
    magnitude = min(abs(value), SIGN - 1)
    return magnitude + SIGN if value < 0 else magnitude
