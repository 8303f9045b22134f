"""How one joint moves and stops: commands in radians to motions of its motor, in turns.

A controller that keeps a velocity needs no estimate of where the joint will stop. A stop is a velocity of
0, kept until the joint is at rest, and then the position that it rests at. Velocity 0 alone would let a
loaded joint creep, since it forgets every displacement; the position alone would pull the joint back by
the way that it made since it was read.
"""

import math
from dataclasses import dataclass

from bentod.frames import Command, JointSpec, Position, Stop, StopReport, Velocity
from drivers.can.codec import Bounds, Estimate, Go, Motion, Rest, Spin
from drivers.can.options import Hardware, Options

TURN = 2 * math.pi

PATIENCE = 1.0
"""s after which a joint that was told to stop is held wherever it is: something moves it."""

SETTLED = 0.25
"""s of being held after which a stop has come to rest, and is reported."""

RULE = "velocity"
"""How a stop is made, as reports name it."""


@dataclass(frozen=True, slots=True)
class Sample:
    """Where the joint was."""

    position: float  # rad
    velocity: float  # rad/s
    time: float  # monotonic s, when the frame arrived


class Gear:
    """Between the joint's radians and the motor's turns."""

    def __init__(self, spec: JointSpec, hardware: Hardware) -> None:
        self._per_radian = hardware.gear_ratio / TURN
        self._offset = hardware.offset_rad
        self.sign = math.copysign(1.0, hardware.gear_ratio)
        fastest = hardware.velocity_limit_rad_s or 1.5 * spec.max_velocity
        self.bounds = Bounds(
            velocity=abs(self.rate(fastest)),
            acceleration=abs(self.rate(hardware.acceleration_rad_s2)),
            current=hardware.current_limit_a,
        )

    def turns(self, position: float) -> float:
        """Of the motor at `position` (rad)."""
        return (position - self._offset) * self._per_radian

    def rate(self, velocity: float) -> float:
        """Turns/s of the motor at `velocity` (rad/s); for accelerations too."""
        return velocity * self._per_radian

    def sample(self, estimate: Estimate, time: float) -> Sample:
        """The joint as the motor is estimated at `time` (monotonic s)."""
        return Sample(
            position=self._offset + estimate.position / self._per_radian,
            velocity=estimate.velocity / self._per_radian,
            time=time,
        )


class JointMotion:
    """What one joint is up to."""

    def __init__(self, spec: JointSpec, hardware: Hardware, options: Options, period: float) -> None:
        """`period`: s between ticks."""
        self.gear = Gear(spec, hardware)
        self.stopped: StopReport | None = None
        """The last stop that came to rest."""
        self._spec = spec
        self._hardware = hardware
        self._slow = options.rest_rad_s
        self._reaction = 2 * period + options.stale_after_s
        self._braking: Braking | None = None
        self._held: float | None = None

    def pin(self, position: float) -> Rest:
        """Forget what was, and hold `position` (rad)."""
        self._braking, self._held = None, position
        return Rest(self.gear.turns(position))

    def command(self, command: Command, sample: Sample, now: float) -> Motion:
        """What the motor is told, the joint having been at `sample` and `now` being monotonic s."""
        match command:
            case Stop():
                return self._stop(sample, now)
            case Velocity(velocity):
                self._braking = self._held = None
                return self._velocity(velocity, sample)
            case Position(position, speed):
                self._braking = self._held = None
                return self._go(position, speed)

    def watch(self, sample: Sample) -> None:
        """Follow a stop until it has come to rest."""
        if self._braking is not None:
            report = self._braking.follow(sample)
            self.stopped = report or self.stopped
            self._braking = None if report else self._braking

    def _stop(self, sample: Sample, now: float) -> Motion:
        if self._held is None:
            if self._braking is None:
                self._braking = Braking(sample, now, self._slow)
            if not self._braking.rests(sample, now):
                return Spin(0.0)
            self._held = self._spec.clamp(sample.position)
            self._braking.held_at = now
        return Rest(self.gear.turns(self._held))

    def _velocity(self, velocity: float, sample: Sample) -> Motion:
        limit = self._spec.maximum if velocity > 0 else self._spec.minimum
        left = (limit - sample.position) * math.copysign(1.0, velocity)
        speed = max(abs(velocity), abs(sample.velocity))
        need = speed**2 / (2 * self._hardware.acceleration_rad_s2) + speed * self._reaction
        if self._hardware.bounded or left <= need:
            return self._go(limit, abs(velocity))
        return Spin(self.gear.rate(velocity))

    def _go(self, position: float, speed: float) -> Go:
        return Go(self.gear.turns(position), abs(self.gear.rate(speed)))


class Braking:
    """One stop, from the first time it was told to the report of how it went."""

    def __init__(self, sample: Sample, now: float, slow: float) -> None:
        self.held_at = math.inf  # monotonic s
        self._began = now
        self._from = sample.position
        self._sign = math.copysign(1.0, sample.velocity)
        self._moved = abs(sample.velocity) > slow
        self._farthest = 0.0
        self._slow = slow

    def rests(self, sample: Sample, now: float) -> bool:
        """Whether a sample from after the stop shows no motion, or patience is at its end."""
        return (sample.time > self._began and abs(sample.velocity) <= self._slow) or (
            now > self._began + PATIENCE
        )

    def follow(self, sample: Sample) -> StopReport | None:
        """The report, once the joint has been held for a while; none if it did not move at all."""
        way = (sample.position - self._from) * self._sign
        self._farthest = max(self._farthest, way)
        if not self._moved or sample.time < self.held_at + SETTLED:
            return None
        return StopReport(RULE, self._began, way, self._farthest - way)
