"""Joint mode's way of moving at a velocity and of stopping: one joint, no bytes."""

import math
from dataclasses import dataclass

from bentod.frames import Command, JointSpec, JointState, Position, Velocity
from drivers.dynamixel.stopping import StopRule, Travel, resting_place


@dataclass(frozen=True, slots=True)
class Tuning:
    """How a servo behaves, and how it is to be stopped."""

    dead_time_s: float = 0.017  # from the arrival of a command to its effect (T_cmd)
    bus_time_s: float = 0.002  # from the decision to the arrival of the command (T_bus)
    longest_age_s: float = 0.5  # beyond this age of a reading its velocity is no longer extrapolated
    p_gain: float = 32.0  # P gain register
    goal_acceleration: float = 0.0  # rad/s², 0: unlimited
    rule: StopRule = "full"
    slowest: float = math.radians(0.684)  # rad/s, the least speed the servo can be given
    pin_speed: float = math.radians(5 * 0.684)  # rad/s, when a joint is pinned where it is


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
        self._speed = tuning.pin_speed
        self._target: float | None = None
        self._rest: Goal | None = None
        self._previous: float | None = None

    def command(self, command: Command, reading: JointState) -> Goal:
        """The goal for this tick.

        `reading.age` is the age at the time of this call. A velocity or speed that is 0 or not finite,
        and a position that is not finite, stop the joint. Repeated stops keep the first one's goal.
        """
        goal = self._goal(command, reading)
        self._previous = reading.position
        return goal

    def pin(self, position: float) -> Goal:
        """Hold `position` (rad), approached slowly; later stops keep this goal."""
        self._rest = Goal(self._spec.clamp(position), self._tuning.pin_speed)
        self._target = None
        self._previous = position
        self._speed = self._tuning.pin_speed
        return self._rest

    def _goal(self, command: Command, reading: JointState) -> Goal:
        match command:
            case Velocity(velocity=v) if math.isfinite(v) and v != 0:
                return self._move(self._spec.maximum if v > 0 else self._spec.minimum, abs(v))
            case Position(position=p, speed=v) if math.isfinite(p) and math.isfinite(v) and v > 0:
                return self._move(self._spec.clamp(p), v)
            case _:
                return self._stop(reading)

    def _move(self, target: float, speed: float) -> Goal:
        self._rest = None
        self._target = target
        self._speed = max(min(speed, self._spec.max_velocity), self._tuning.slowest)
        return Goal(target, self._speed)

    def _stop(self, reading: JointState) -> Goal:
        if self._rest is None:
            self._rest = Goal(self._spec.clamp(self._resting_place(reading)), self._speed)
        return self._rest

    def _resting_place(self, reading: JointState) -> float:
        place = resting_place(self._travel(reading), self._tuning.rule, self._tuning.slowest)
        if self._target is None:
            return place
        # The joint would have stopped at its target anyway, so no stop may lead beyond it.
        if reading.position <= self._target:
            return min(place, self._target)
        return max(place, self._target)

    def _travel(self, reading: JointState) -> Travel:
        tuning = self._tuning
        age = min(reading.age, tuning.longest_age_s)
        return Travel(
            position=reading.position,
            previous=reading.position if self._previous is None else self._previous,
            velocity=reading.velocity,
            load=reading.load,
            delay=age + tuning.bus_time_s + tuning.dead_time_s,
            p_gain=tuning.p_gain,
            acceleration=tuning.goal_acceleration,
        )
