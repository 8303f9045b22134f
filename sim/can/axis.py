"""One simulated ODrive axis: what it does with a frame, and what it sends by itself."""

from collections.abc import Callable
from math import pi

from sim.can import frames
from sim.can.motor import Control, Motor, Shape

IDLE, CLOSED_LOOP = 1, 8

UNDER_VOLTAGE = 0x200
CURRENT_LIMIT = 0x1000
MOTOR_HOT = 0x2000
WATCHDOG = 0x1000000
ESTOP = 0x2000000
"""Bits of ODrive.Error."""

FED_BY = (frames.SET_AXIS_STATE, frames.INPUT_POS, frames.INPUT_VEL)
"""What feeds the watchdog. Firmware 0.5.6 takes any frame to the node; what 0.6 takes besides the inputs
is not published, so no more than these are counted on."""


class SimAxis:
    """A controller, its motor, and everything that can be broken about them."""

    def __init__(
        self, node: int, ratio: float, offset: float, motor: Motor, watchdog: float, celsius: float
    ) -> None:
        """`ratio`: turns of the motor for one of the joint; `watchdog`: s, 0 for none."""
        self.node = node
        self.motor = motor
        self.errors = 0
        self.reason = 0
        self.causes: set[int] = set()
        """Errors whose cause is there."""
        self.powered = True
        self.silent = False
        self.beating = True
        """Whether the heartbeat is sent."""
        self.supply = 12.0
        self.celsius = celsius
        self._ratio = ratio
        self._offset = offset
        self._watchdog = watchdog
        self._fed = 0.0

    @property
    def answers(self) -> bool:
        """Whether it hears and speaks."""
        return self.powered and not self.silent

    def step(self, dt: float) -> None:
        """Advance by `dt` (s)."""
        self._fed += dt
        if self.motor.driven and self._watchdog and self._fed > self._watchdog:
            self.disarm(WATCHDOG)
        self.motor.step(dt)

    def disarm(self, reason: int) -> None:
        """Let the motor go because of an error."""
        if self.motor.driven:
            self.motor.drive(False)
            self.reason |= reason
        self.errors |= reason

    def power(self, on: bool) -> None:
        """Cut the supply, or switch it on: all but the position is then forgotten."""
        self.motor.drive(False)
        self.powered = on
        self.errors = self.reason = 0
        self.motor.settings = type(self.motor.settings)(position=self.motor.position)

    def hear(self, command: int, data: bytes, remote: bool) -> tuple[int, bytes] | None:
        """Obey a frame; the answer, command and data, if it asks for one."""
        if remote:
            reply = _REPLIES.get(command)
            return (command, reply(self)) if reply else None
        known = _DEEDS.get(command)
        if known is None:
            return None
        layout, deed = known
        values = layout.unpack(data)
        if values is not None:
            if layout in FED_BY:
                self._fed = 0.0
            deed(self, values)
        return None

    def heartbeat(self) -> bytes:
        """Sent every 100 ms."""
        state = CLOSED_LOOP if self.motor.driven else IDLE
        return frames.HEARTBEAT.pack(Axis_Error=self.errors, Axis_State=state)

    def estimates(self) -> bytes:
        """Sent every 10 ms."""
        return frames.ENCODER_ESTIMATES.pack(
            Pos_Estimate=(self.motor.position - self._offset) / self._radians,
            Vel_Estimate=self.motor.velocity / self._radians,
        )

    @property
    def _radians(self) -> float:
        """Of the joint for one turn of the motor."""
        return 2 * pi / self._ratio

    def _report_errors(self) -> bytes:
        return frames.GET_ERROR.pack(Active_Errors=self.errors, Disarm_Reason=self.reason)

    def _report_current(self) -> bytes:
        amperes = self.motor.current if self._ratio > 0 else -self.motor.current
        return frames.IQ.pack(Iq_Setpoint=amperes, Iq_Measured=amperes)

    def _report_supply(self) -> bytes:
        return frames.BUS_VOLTAGE_CURRENT.pack(Bus_Voltage=self.supply)

    def _report_heat(self) -> bytes:
        return frames.TEMPERATURE.pack(FET_Temperature=self.celsius, Motor_Temperature=self.celsius)

    def _set_state(self, values: dict[str, float]) -> None:
        state = values["Axis_Requested_State"]
        if state == CLOSED_LOOP and not self.errors:
            self.reason = 0
            self.motor.drive(True)
        elif state == IDLE:
            self.motor.drive(False)

    def _set_mode(self, values: dict[str, float]) -> None:
        control, shape = int(values["Control_Mode"]), int(values["Input_Mode"])
        if control in set(Control) and shape in set(Shape):
            self.motor.settings.control, self.motor.settings.shape = control, shape
            self.motor.hold_trajectory()

    def _set_position(self, values: dict[str, float]) -> None:
        settings = self.motor.settings
        settings.position = self._offset + values["Input_Pos"] * self._radians
        settings.velocity = values["Vel_FF"] / 1000 * self._radians

    def _set_velocity(self, values: dict[str, float]) -> None:
        self.motor.settings.velocity = values["Input_Vel"] * self._radians

    def _set_limits(self, values: dict[str, float]) -> None:
        self.motor.settings.velocity_limit = values["Velocity_Limit"] * abs(self._radians)
        self.motor.settings.current_limit = values["Current_Limit"]

    def _set_trap_speed(self, values: dict[str, float]) -> None:
        self.motor.settings.trap_speed = values["Traj_Vel_Limit"] * abs(self._radians)

    def _set_trap_acceleration(self, values: dict[str, float]) -> None:
        least = min(values["Traj_Accel_Limit"], values["Traj_Decel_Limit"])
        self.motor.settings.trap_acceleration = least * abs(self._radians)

    def _clear(self, values: dict[str, float]) -> None:
        self.errors = self.reason = 0
        for cause in self.causes:
            self.errors |= cause

    def _estop(self, values: dict[str, float]) -> None:
        self.disarm(ESTOP)


_DEEDS: dict[int, tuple[frames.Layout, Callable[[SimAxis, dict[str, float]], None]]] = {
    layout.command: (layout, deed)
    for layout, deed in (
        (frames.ESTOP, SimAxis._estop),
        (frames.SET_AXIS_STATE, SimAxis._set_state),
        (frames.CONTROLLER_MODE, SimAxis._set_mode),
        (frames.INPUT_POS, SimAxis._set_position),
        (frames.INPUT_VEL, SimAxis._set_velocity),
        (frames.LIMITS, SimAxis._set_limits),
        (frames.TRAJ_VEL_LIMIT, SimAxis._set_trap_speed),
        (frames.TRAJ_ACCEL_LIMITS, SimAxis._set_trap_acceleration),
        (frames.CLEAR_ERRORS, SimAxis._clear),
    )
}

_REPLIES: dict[int, Callable[[SimAxis], bytes]] = {
    frames.GET_ERROR.command: SimAxis._report_errors,
    frames.IQ.command: SimAxis._report_current,
    frames.BUS_VOLTAGE_CURRENT.command: SimAxis._report_supply,
    frames.TEMPERATURE.command: SimAxis._report_heat,
    frames.ENCODER_ESTIMATES.command: SimAxis.estimates,
}
