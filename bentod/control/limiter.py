"""The last stage before the bus: nothing leaves that is not a number within every limit of the joint."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from bentod.control.arbiter import Decision
from bentod.control.health import Ladder
from bentod.control.limits import Aim, aim, loaded, room, share_of_speed, speed_towards_limit
from bentod.frames import Command, JointSpec, JointState, Position, State, Stop, Velocity

LEAST = 0.001
"""Rad/s below which a joint is stopped instead: a twelfth of what an MX servo can do. Some servos take a
speed that rounds to 0 for no bound at all."""


@dataclass(frozen=True, slots=True)
class Sent:
    """What leaves for one joint."""

    command: Command | None
    velocity: float = 0.0  # rad/s, signed
    limited: str = ""  # the limit that made it differ from what was asked


class JointLimiter:
    """One joint's limits, and what they must remember: how fast it was sent, and what it pushed against.

    The velocity sent never changes by more than the joint's acceleration allows, whoever asked before and
    whoever asks now: so no hand-over is felt. A stop is the exception. It passes at once, whether pause,
    fault or a dead source is behind it or only that nobody asks any more: drivers know how to stop a joint
    without a jolt, and a wearer who lets go means it. After a stop the velocity starts from 0. Who asks for
    the other way means a stop first: a joint that is slow to turn would go on the old way all the while.
    """

    def __init__(self, spec: JointSpec) -> None:
        self._spec = spec
        self._velocity = 0.0
        self._loaded = 0

    def step(self, command: Command | None, reading: JointState, elapsed: float) -> Sent:
        """What to send now, `elapsed` (s) after the last call."""
        self._loaded = loaded(self._loaded, reading.load, self._spec.bounds.load)
        sent = self._limited(command, reading, elapsed)
        self._velocity = sent.velocity
        return sent

    def reset(self) -> None:
        """The joint was stopped by other means."""
        self._velocity = 0.0

    def _limited(self, command: Command | None, reading: JointState, elapsed: float) -> Sent:
        if command is None or isinstance(command, Stop):
            return Sent(command)
        if not math.isfinite(reading.position):
            return Sent(Stop(), limited="stale")
        change = self._spec.bounds.acceleration * elapsed
        wanted = aim(command, self._spec, reading.position, self._velocity, change)
        if wanted.velocity == 0 and wanted.goal is None:
            return Sent(Stop(), limited=wanted.limited)
        share = share_of_speed(self._spec, reading.temperature)
        allowed = self._softened(wanted.slowed(share * self._spec.max_velocity, "warm"), reading, elapsed)
        return self._gated(allowed, self._ramped(allowed, change), reading)

    def _softened(self, wanted: Aim, reading: JointState, elapsed: float) -> Aim:
        """Slower towards a limit, as near as the joint will be to it when it is next told."""
        ahead = max(math.copysign(self._velocity, self._velocity * wanted.velocity), 0.0) * elapsed
        left = room(self._spec, reading.position, wanted.velocity) - ahead
        return wanted.slowed(speed_towards_limit(self._spec, left, elapsed), "soft zone")

    def _ramped(self, wanted: Aim, change: float) -> float:
        ramped = min(max(wanted.velocity, self._velocity - change), self._velocity + change)
        return 0.0 if ramped * wanted.velocity < 0 else ramped

    def _gated(self, wanted: Aim, velocity: float, reading: JointState) -> Sent:
        """The command that does `velocity` (rad/s), unless a limit or a load is in the way."""
        limited = wanted.limited if velocity == wanted.velocity else "acceleration"
        if velocity * self._loaded > 0:
            return Sent(Stop(), limited="load")
        if abs(velocity) < LEAST:
            return Sent(Stop(), velocity, limited or "too slow")
        if wanted.goal is not None and velocity * wanted.velocity > 0:
            return Sent(Position(wanted.goal, abs(velocity)), velocity, limited)
        if room(self._spec, reading.position, velocity) <= 0:
            return Sent(Stop(), limited="position")
        return Sent(Velocity(velocity), velocity, limited)


class Limiter:
    """The limits of all joints."""

    def __init__(self, specs: Sequence[JointSpec], ladder: Ladder) -> None:
        self.limited: tuple[str, ...] = ("",) * len(specs)
        """By joint, which limit made what was sent last differ from what was asked; empty if none did."""
        self._ladder = ladder
        self._joints = [JointLimiter(spec) for spec in specs]
        self._time: float | None = None

    def limit(self, decided: Sequence[Decision], state: State, longest: float) -> list[Command | None]:
        """What is sent, and nothing that moves a joint whose reading is too old.

        `longest`: s, the most time that counts as passed since the last call; a pause is no run-up.
        """
        elapsed = 0.0 if self._time is None else min(max(state.time - self._time, 0.0), longest)
        self._time = state.time
        old = self._ladder.too_old_to_move(state)
        sent = [
            self._step(joint, decision.command, joint in old, state.joints[joint], elapsed)
            for joint, decision in enumerate(decided)
        ]
        self.limited = tuple(one.limited for one in sent)
        return [one.command for one in sent]

    def reset(self) -> None:
        """Every joint was stopped by other means."""
        for joint in self._joints:
            joint.reset()

    def _step(
        self, joint: int, command: Command | None, stale: bool, reading: JointState, elapsed: float
    ) -> Sent:
        if stale and isinstance(command, Velocity | Position):
            self._joints[joint].step(Stop(), reading, elapsed)
            return Sent(Stop(), limited="stale")
        return self._joints[joint].step(command, reading, elapsed)
