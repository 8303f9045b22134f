"""Joints made of servo models alone: the driver's way of moving and stopping, without its bytes."""

import random
from collections.abc import Sequence
from dataclasses import replace

from bentod.contracts import ArmConfig, Clock
from bentod.errors import BusError
from bentod.frames import Command, Freshness, JointSpec, JointState, State
from drivers.dynamixel.motion import Goal, JointMotion
from drivers.dynamixel.options import Options as BusOptions
from drivers.dynamixel.options import parse_hardware, tuning, with_dead_man
from drivers.dynamixel.tables import ALARM_SHUTDOWN
from sim.arm import GONE, Arm
from sim.options import Options
from sim.servo import STIFFNESS, Servo, Setting
from sim.servo_models import MX2_SCALE

P_GAIN = 32
"""Register of firmware 1, in which `Tuning` counts, at the stiffness `STIFFNESS`."""

LETTING_GO = 0.1
"""s, more than a servo's dead time."""


class PlainJoint:
    """One servo as a joint."""

    def __init__(self, spec: JointSpec, servo: Servo, options: BusOptions) -> None:
        self.spec = spec
        self.torque = False
        self._servo = servo
        self._tuning = tuning(options, parse_hardware(spec))
        self._motion = JointMotion(spec, self._tuning)
        self._lost_after = options.lost_after_s
        self._boots = servo.boots
        self._trajectory: tuple[float, float] | None = None

    @property
    def answers(self) -> bool:
        """Whether the servo hears and replies."""
        return self._servo.answers

    def sample(self) -> JointState:
        """What the servo says now."""
        servo = self._servo
        self._notice_power_cut()
        seen = servo.sense()
        scale = servo.model.scale
        if scale is MX2_SCALE:  # only firmware 2 shows where its profile is
            self._trajectory = (servo.reference, servo.rate)
        return JointState(
            position=scale.angle(seen.ticks),
            velocity=seen.speed * scale.speed,
            load=seen.load,
            voltage=seen.voltage,
            temperature=seen.temperature,
            age=0.0,
            freshness=Freshness.FRESH,
            errors=servo.errors() + ((ALARM_SHUTDOWN,) if servo.shutdown else ()),
            stop=self._motion.report,
            shut_down=bool(servo.shutdown),
        )

    def place(self) -> float:
        """Where it is (rad), of three readings the middle one: one alone may be a glitch."""
        return sorted(self.sample().position for _ in range(3))[1]

    def aged(self, state: JointState, age: float) -> JointState:
        """The last sample, `age` (s) later and without an answer since."""
        lost = age > self._lost_after
        return replace(state, age=age, freshness=Freshness.LOST if lost else Freshness.STALE)

    def command(self, command: Command, state: JointState, now: float) -> None:
        """Tell the servo, if its torque is on and it hears."""
        if self.torque and self.answers:
            self._tell(self._motion.command(command, state, now, self._trajectory))

    def set_torque(self, on: bool, position: float) -> None:
        """Bring the torque to `on`, pinned at `position` (rad)."""
        self.torque = on
        self._tell(self._motion.pin(position))

    def let_go(self) -> None:
        """Before an alarm is lifted: what it was told last must not move it then."""
        if self.answers and self._servo.shutdown:
            self.set_torque(False, self._servo.position)

    def clear(self) -> str:
        """Lift its alarm; what is in the way, a sentence, empty when nothing is."""
        if not self.answers:
            return f"Joint {self.spec.name} does not answer."
        self._servo.restore()
        errors = self.sample().errors
        return f"Joint {self.spec.name} still reports {', '.join(errors)}." if errors else ""

    def _notice_power_cut(self) -> None:
        """A servo that was without power has come back limp."""
        if self._servo.boots != self._boots:
            self._boots = self._servo.boots
            self.torque = False

    def _tell(self, goal: Goal) -> None:
        scale = self._servo.model.scale
        self._servo.tell(
            Setting(
                goal=scale.angle(scale.ticks(goal.position)),
                speed=max(round(goal.speed / scale.speed), 1) * scale.speed,
                torque_on=self.torque,
                acceleration=self._tuning.goal_acceleration,
                stiffness=STIFFNESS * self._tuning.p_gain / P_GAIN,
            )
        )


class PlainJoints:
    """The `Joints` contract over an arm, with time, quantisation and faults but without a bus."""

    def __init__(self, arm: Arm, config: ArmConfig, options: Options, clock: Clock) -> None:
        self._arm = arm
        self._clock = clock
        self._random = random.Random(f"{options.seed}/plain")
        driven = with_dead_man(options, config.period)
        self._joints = [
            PlainJoint(spec, servo, driven) for spec, servo in zip(config.joints, arm.servos, strict=True)
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
                joint.command(command, replace(state, age=now - time), now)

    async def set_torque(self, on: Sequence[bool]) -> None:
        """See `bentod.contracts.Joints`."""
        self._arm.advance(self._clock.now())
        silent = []
        for joint, wanted in zip(self._joints, on, strict=True):
            if not self._reaches(joint):
                silent.append(joint.spec.name)
            elif joint.torque is not wanted:
                joint.set_torque(wanted, joint.place())
        if silent:
            raise BusError(f"Torque not confirmed by {', '.join(silent)}: no reply.")

    def torque(self) -> tuple[bool, ...]:
        """See `bentod.contracts.Joints`."""
        return tuple(joint.torque for joint in self._joints)

    async def clear_errors(self, joints: Sequence[int]) -> tuple[str, ...]:
        """See `bentod.contracts.Joints`; a servo that had shut down is limp afterwards."""
        if not self._arm.plugged:
            return (GONE,)
        chosen = [self._joints[joint] for joint in joints]
        self._arm.advance(self._clock.now())
        for joint in chosen:
            joint.let_go()
        await self._clock.sleep_until(self._clock.now() + LETTING_GO)
        self._arm.advance(self._clock.now())
        return tuple(sentence for joint in chosen if (sentence := joint.clear()))

    def _reaches(self, joint: PlainJoint) -> bool:
        return self._arm.plugged and joint.answers
