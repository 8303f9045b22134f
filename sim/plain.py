"""Joints made of servo models alone: the driver's way of moving and stopping, without its bytes."""

import random
from collections.abc import Sequence
from dataclasses import replace

from bentod.contracts import ArmConfig, Clock
from bentod.errors import BusError
from bentod.frames import Command, Freshness, JointSpec, JointState, State
from drivers.dynamixel.motion import Goal, JointMotion
from drivers.dynamixel.options import parse_hardware, tuning
from drivers.dynamixel.tables import ALARM_SHUTDOWN
from sim.arm import GONE, Arm
from sim.options import Options
from sim.servo import CENTRE, SPEED_STEP, TICK, Servo, Setting


class PlainJoint:
    """One servo as a joint."""

    def __init__(self, spec: JointSpec, servo: Servo, options: Options) -> None:
        self.spec = spec
        self.torque = False
        self._servo = servo
        self._hardware = parse_hardware(spec)
        self._motion = JointMotion(spec, tuning(options, self._hardware))
        self._lost_after = options.lost_after_s
        self._boots = servo.boots

    @property
    def answers(self) -> bool:
        """Whether the servo hears and replies."""
        return self._servo.answers

    def sample(self) -> JointState:
        """What the servo says now."""
        servo = self._servo
        self._notice_power_cut()
        seen = servo.sense()
        return JointState(
            position=(seen.ticks - CENTRE) * TICK,
            velocity=seen.speed * SPEED_STEP,
            load=seen.load,
            voltage=seen.voltage,
            temperature=seen.temperature,
            age=0.0,
            freshness=Freshness.FRESH,
            errors=servo.errors() + ((ALARM_SHUTDOWN,) if servo.shutdown else ()),
        )

    def aged(self, state: JointState, age: float) -> JointState:
        """The last sample, `age` (s) later and without an answer since."""
        lost = age > self._lost_after
        return replace(state, age=age, freshness=Freshness.LOST if lost else Freshness.STALE)

    def command(self, command: Command, state: JointState) -> None:
        """Tell the servo, if its torque is on and it hears."""
        if self.torque and self.answers:
            self._tell(self._motion.command(command, state))

    def set_torque(self, on: bool, position: float) -> None:
        """Bring the torque to `on`, pinned at `position` (rad)."""
        self.torque = on
        self._tell(self._motion.pin(position))

    def _notice_power_cut(self) -> None:
        """A servo that was without power has come back limp."""
        if self._servo.boots != self._boots:
            self._boots = self._servo.boots
            self.torque = False

    def _tell(self, goal: Goal) -> None:
        self._servo.tell(
            Setting(
                goal=round(goal.position / TICK) * TICK,
                speed=max(round(goal.speed / SPEED_STEP), 1) * SPEED_STEP,
                torque_on=self.torque,
                acceleration=self._hardware.goal_acceleration_rad_s2,
                p_gain=self._hardware.p_gain,
            )
        )


class PlainJoints:
    """The `Joints` contract over an arm, with time, quantisation and faults but without a bus."""

    def __init__(self, arm: Arm, config: ArmConfig, options: Options, clock: Clock) -> None:
        self._arm = arm
        self._clock = clock
        self._random = random.Random(f"{options.seed}/plain")
        self._joints = [
            PlainJoint(spec, servo, options) for spec, servo in zip(config.joints, arm.servos, strict=True)
        ]
        self._states = [joint.sample() for joint in self._joints]
        self._times = [clock.now()] * len(self._joints)

    async def read(self) -> State:
        """See `bentod.contracts.Joints`."""
        now = self._clock.now()
        self._arm.advance(now)
        for i, joint in enumerate(self._joints):
            if self._reaches(joint) and self._random.random() >= self._arm.noise:
                self._states[i], self._times[i] = joint.sample(), now
            else:
                self._states[i] = joint.aged(self._states[i], now - self._times[i])
        return State(now, tuple(self._states), "" if self._arm.plugged else GONE)

    async def write(self, commands: Sequence[Command | None]) -> None:
        """See `bentod.contracts.Joints`."""
        now = self._clock.now()
        self._arm.advance(now)
        for joint, command, state, time in zip(
            self._joints, commands, self._states, self._times, strict=True
        ):
            if command is not None and self._arm.plugged:
                joint.command(command, replace(state, age=now - time))

    async def set_torque(self, on: Sequence[bool]) -> None:
        """See `bentod.contracts.Joints`."""
        self._arm.advance(self._clock.now())
        silent = []
        for joint, wanted in zip(self._joints, on, strict=True):
            if not self._reaches(joint):
                silent.append(joint.spec.name)
            elif joint.torque is not wanted:
                joint.set_torque(wanted, joint.sample().position)
        if silent:
            raise BusError(f"Torque not confirmed by {', '.join(silent)}: no reply.")

    def torque(self) -> tuple[bool, ...]:
        """See `bentod.contracts.Joints`."""
        return tuple(joint.torque for joint in self._joints)

    def _reaches(self, joint: PlainJoint) -> bool:
        return self._arm.plugged and joint.answers
