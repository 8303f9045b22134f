"""Joint mode's way of moving at a velocity and of stopping: one joint, no bytes."""

import math
from dataclasses import dataclass

from bentod.frames import Command, JointSpec, JointState, Position, StopReport, Velocity
from drivers.dynamixel.deadman import bounded
from drivers.dynamixel.observer import Observer
from drivers.dynamixel.reference import Course
from drivers.dynamixel.stopping import Travel, resting_place
from drivers.dynamixel.tuning import Tuning

CREEPING = 4
"""Times the slowest speed: below this a creeping joint is as good as at rest."""

LONGEST_CREEP = 1.0
"""s: who is still not slow by then is pushed about, and told where to stay."""


@dataclass(frozen=True, slots=True)
class Goal:
    """What a servo in joint mode is told."""

    position: float  # rad, within the joint's limits
    speed: float  # rad/s, above 0


class JointMotion:
    """Turns commands into goals. Only a goal has a direction; a speed has none."""

    def __init__(self, spec: JointSpec, tuning: Tuning) -> None:
        self._spec = spec
        self._tuning = tuning
        self._observer = Observer(tuning, spec.clamp(spec.home))
        self._speed = tuning.pin_speed
        self._target: float | None = None
        self._sign = 1.0
        self._moving: Goal | None = None
        self._told: float | None = None
        self._rest: Goal | None = None
        self._previous: float | None = None

    @property
    def report(self) -> StopReport | None:
        """How the last stop that has come to rest went."""
        return self._observer.report

    @property
    def dead_time(self) -> float:
        """The dead time (s) that stops count with: as calibrated, and corrected since."""
        return self._observer.dead_time.value

    def recalibrate(self, dead_time: float) -> None:
        """Start anew from a dead time (s) that was measured: what was learned before is forgotten."""
        self._observer.dead_time.recalibrate(dead_time)

    def command(
        self,
        command: Command,
        reading: JointState,
        now: float,
        trajectory: tuple[float, float] | None = None,
    ) -> Goal:
        """The goal for this tick.

        `reading.age` is the age at the time of this call, `now` (monotonic s); `trajectory` what firmware 2
        shows of its reference (rad, rad/s). A velocity or speed that is 0 or not finite, and a position that
        is not finite, stop the joint. Repeated stops keep the first one's goal; that of a creeping stop is
        found when the joint is slow.
        """
        self._observer.take(reading, now, trajectory)
        goal = self._goal(command, now)
        self._observer.ordered(goal.position, goal.speed, now)
        self._previous = self._observer.last.position
        return goal

    def pin(self, position: float) -> Goal:
        """Hold `position` (rad), approached slowly; later stops keep this goal."""
        self._rest = Goal(self._spec.clamp(position), self._tuning.pin_speed)
        self._target = self._moving = self._told = None
        self._previous = position
        self._speed = self._tuning.pin_speed
        self._observer.pinned(self._rest.position)
        return self._rest

    def lose(self) -> None:
        """Nobody knows what the joint heard, it has been silent for so long: it is held where it is found.

        The goal of a stop that it did not hear would make it jump when it is back.
        """
        self._rest = self._target = self._moving = self._told = None
        self._observer.lose()

    def _goal(self, command: Command, now: float) -> Goal:
        match command:
            case Velocity(velocity=v) if math.isfinite(v) and v != 0:
                return self._move(self._spec.maximum if v > 0 else self._spec.minimum, abs(v), now)
            case Position(position=p, speed=v) if math.isfinite(p) and math.isfinite(v) and v > 0:
                return self._move(self._spec.clamp(p), v, now)
            case _:
                return self._rest or self._stop(now)

    def _move(self, target: float, speed: float, now: float) -> Goal:
        speed = max(min(speed, self._spec.max_velocity), self._tuning.slowest)
        sign = math.copysign(1.0, target - self._observer.last.reference)
        self._observer.going(target, sign, speed, now, from_rest=self._rest is not None)
        goes_on = self._moving is not None and sign == self._sign and speed >= self._speed
        last = self._moving.position if self._moving is not None and goes_on else None
        self._target, self._sign, self._speed = target, sign, speed
        self._rest = self._told = None
        self._moving = Goal(self._bounded(target, now, last), speed)
        return self._moving

    def _bounded(self, target: float, now: float, last: float | None) -> float:
        tuning = self._tuning
        if tuning.dead_man <= 0:
            return target
        course = self._observer.course(now)
        speed = max(self._speed, abs(course.rate)) if tuning.goal_acceleration > 0 else self._speed
        goal = bounded(target, course.place, self._sign * speed, tuning, last)
        return self._spec.clamp(goal)

    def _stop(self, now: float) -> Goal:
        course = self._observer.course(now)
        if self._told is None:
            self._told = now
            self._begin_stop(course, now)
            course = self._observer.course(now)  # by the dead time that the start has told
        if self._creeps(now) and self._moving is not None:
            return Goal(self._moving.position, self._tuning.slowest)
        place = self._resting_place(course)
        self._rest = Goal(self._held(place), self._speed)
        self._moving = None
        self._observer.rests(self._rest.position, self._rest.position == course.place)
        return self._rest

    def _held(self, place: float) -> float:
        """`place` within the limits, or where the joint is: a stop pulls nobody in who is outside."""
        here = self._observer.last.position
        return min(max(place, min(self._spec.minimum, here)), max(self._spec.maximum, here))

    def _begin_stop(self, course: Course, now: float) -> None:
        last = self._observer.last
        way = last.velocity if not self._observer.still else course.place - last.reference
        if abs(way) > 0:
            self._observer.stopping(math.copysign(1.0, way), self._speed, now)

    def _creeps(self, now: float) -> bool:
        """Whether a creeping stop is still too fast to be ended; at first nothing shows yet."""
        if self._tuning.rule != "creep" or self._told is None:
            return False
        seen = self._observer.last.time - self._told
        if seen <= self._tuning.bus_time_s + self.dead_time:
            return now - self._told < LONGEST_CREEP
        fast = abs(self._observer.last.velocity) >= CREEPING * self._tuning.slowest
        return fast and now - self._told < LONGEST_CREEP

    def _resting_place(self, course: Course) -> float:
        last = self._observer.last
        # A joint that swings against its order has no travel of its own: it is the order's that must end.
        astray = self._target is not None and last.velocity * self._sign < 0
        travel = Travel(
            position=last.position,
            previous=last.position if self._previous is None else self._previous,
            velocity=0.0 if astray else last.velocity,
            reference=course.place,
            rate=course.rate,
            acceleration=self._tuning.goal_acceleration,
        )
        place = resting_place(travel, self._tuning.rule, self._tuning.slowest)
        if self._target is None:
            return place
        # The joint would have stopped at its target anyway, so no stop may lead beyond it.
        return min(place, self._target) if last.position <= self._target else max(place, self._target)
