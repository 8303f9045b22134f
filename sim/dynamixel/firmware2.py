"""MX servos with firmware 2, which speak protocol 2.0, or 1.0 over the same table if told so."""

from math import pi

from sim.dynamixel import tables2
from sim.dynamixel.cells import Cell, Refusal
from sim.dynamixel.device import TICKS_PER_S, Device
from sim.servo import Reading, Setting

ACCELERATION_STEP = 214.577 * 2 * pi / 3600
"""rad/s² of one step of Profile Acceleration: 214.577 rev/min²."""

STIFFNESS_STEP = 4096 / (2 * pi) / 128 / 885
"""Duty per rad of one step of Position P Gain: KpP = gain / 128, from ticks to PWM of 885
(https://emanual.robotis.com/docs/en/dxl/mx/mx-28-2/#position-pid-gain); 850 is as firmware 1 at 31."""

CURRENT_STEP = 0.00336
"""A."""

WATCHDOG_STEP = 0.02
"""s."""

POSITION_MODE, EXTENDED_POSITION_MODE = 3, 4
FARTHEST = 1_048_575
"""Greatest goal of the extended position mode."""

ERROR_BITS = {"Input Voltage Error": 0b1, "Overheating Error": 0b100, "Overload Error": 0b10_0000}
"""Of Hardware Error Status."""


class Firmware2(Device):
    """An MX. Modelled are the position modes; in any other it stays limp.

    Assumed: a goal in the table survives torque off, and torque on goes there; torque on is refused while an
    alarm stands; a reboot is the only way out of one.
    """

    whole = True

    @property
    def protocol(self) -> int:
        """As Protocol Type says."""
        return self.get(tables2.PROTOCOL_TYPE)

    def alert(self) -> bool:
        """Whether Hardware Error Status says anything, which it does until a reboot."""
        self._notice_boot()
        self._follow_alarm()
        return self.get(tables2.HARDWARE_ERROR) != 0

    def _judge_value(self, cell: Cell, value: int) -> Refusal:
        refusal = super()._judge_value(cell, value)
        if refusal is not Refusal.NONE:
            return refusal
        if self.servo.tripped and (cell.address in tables2.GOALS or (cell is tables2.WATCHDOG and value)):
            return Refusal.RANGE  # https://emanual.robotis.com/docs/en/dxl/x/xm430-w210/#bus-watchdog
        if cell is tables2.GOAL and not self._lowest() <= value <= self._highest():
            return Refusal.LIMIT
        if cell is tables2.TORQUE_ENABLE and value and self.servo.shutdown:
            return Refusal.ACCESS
        return Refusal.NONE

    def _lowest(self) -> int:
        return -FARTHEST if self._extended() else self.get(tables2.LOWEST_POSITION)

    def _highest(self) -> int:
        return FARTHEST if self._extended() else self.get(tables2.HIGHEST_POSITION)

    def _extended(self) -> bool:
        return self.get(tables2.OPERATING_MODE) == EXTENDED_POSITION_MODE

    def _written(self, cells: tuple[Cell, ...]) -> None:
        if tables2.WATCHDOG in cells:
            self.servo.watch(self.get(tables2.WATCHDOG) * WATCHDOG_STEP)

    def _setting(self) -> Setting:
        scale = self.servo.model.scale
        positioning = self.get(tables2.OPERATING_MODE) in (POSITION_MODE, EXTENDED_POSITION_MODE)
        pwm = min(self.get(tables2.PWM_LIMIT), abs(self.get(tables2.GOAL_PWM)))
        return Setting(
            goal=scale.angle(self.get(tables2.GOAL)),
            speed=self.get(tables2.PROFILE_VELOCITY) * scale.speed,
            torque_on=bool(self.get(tables2.TORQUE_ENABLE)) and positioning,
            acceleration=self.get(tables2.PROFILE_ACCELERATION) * ACCELERATION_STEP,
            torque_limit=pwm / 885,
            stiffness=self.get(tables2.P_GAIN) * STIFFNESS_STEP,
        )

    def _boot(self) -> None:
        super()._boot()
        self._set(tables2.GOAL_PWM, self.get(tables2.PWM_LIMIT))
        self.servo.temperature_limit = float(self.get(tables2.TEMPERATURE_LIMIT))
        limits = self.get(tables2.LOWEST_VOLTAGE), self.get(tables2.HIGHEST_VOLTAGE)
        self.servo.voltage_limits = (limits[0] / 10, limits[1] / 10)

    def _show(self) -> None:
        servo = self.servo
        seen = servo.sense()
        scale = servo.model.scale
        self._set(tables2.POSITION, seen.ticks)
        self._set(tables2.VELOCITY, seen.speed)
        self._set(tables2.POSITION_TRAJECTORY, scale.ticks(servo.reference))
        self._set(tables2.VELOCITY_TRAJECTORY, round(servo.rate / scale.speed))
        self._set(tables2.PWM, round(servo.duty * 885))
        self._set(tables2.LOAD_OR_CURRENT, self._load(seen))
        self._set(tables2.VOLTAGE, round(seen.voltage * 10))
        self._set(tables2.TEMPERATURE, round(seen.temperature))
        self._set(tables2.MOVING, int(seen.moving))
        self._set(tables2.REALTIME_TICK, int(servo.time * TICKS_PER_S) % 32768)
        self._follow_alarm()

    def _load(self, seen: Reading) -> int:
        """MX-28: load in 0.1 %; the others: current."""
        if self.table.has(tables2.GOAL_CURRENT):
            return round(seen.current / CURRENT_STEP)
        return round(seen.load * 1000)

    def _follow_alarm(self) -> None:
        """Keep what went wrong until the next reboot."""
        for complaint in self.servo.errors():
            error = self.get(tables2.HARDWARE_ERROR) | ERROR_BITS[complaint]
            self._set(tables2.HARDWARE_ERROR, error)
        if self.servo.shutdown and self.get(tables2.TORQUE_ENABLE):
            self._set(tables2.TORQUE_ENABLE, 0)
            self._tell()
        if self.servo.tripped and self.get(tables2.WATCHDOG) != -1:
            self._set(tables2.WATCHDOG, -1)
            self._set(tables2.GOAL, self.get(tables2.POSITION_TRAJECTORY))
            self._told = self._setting()
