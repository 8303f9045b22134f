"""What is known of one joint between two readings: its reference, its dead time, how its stops went."""

import math

from bentod.frames import JointState, StopReport
from drivers.dynamixel.correction import DeadTime, Sample, StartWatch, StopWatch
from drivers.dynamixel.reference import Course, Flight, Order, lag
from drivers.dynamixel.tuning import Tuning

SAME = 1e-4
"""s: readings that are closer than this are one."""

BLOCKED = 0.4
"""Share of the greatest load at which a joint that stands still is held by something; more of it for 10 s
makes a servo shut down (manual of brachIOplexus). Nothing is extrapolated then: a stop adds no push."""

PATIENCE = 3.0
"""s after which a joint that still moves is not at the end of its stop but pushed about."""

ARRIVING = 10
"""Position ticks: a reference so near to its target may stand there already; its start is then unknown."""


class Observer:
    """Follows one joint by its readings and by the orders it was given."""

    def __init__(self, tuning: Tuning, position: float) -> None:
        """`position`: rad, where the joint is taken to be until it is read."""
        self.dead_time = DeadTime(tuning.dead_time_s, tuning.learning)
        self.last = Sample(-math.inf, position, 0.0, 0.0, position, 0.0)
        self.report: StopReport | None = None
        """How the last stop that has come to rest went."""
        self._tuning = tuning
        self._flight = Flight()
        self._start: StartWatch | None = None
        self._stop: StopWatch | None = None

    @property
    def still(self) -> bool:
        """Whether the joint was read at rest; what is below two steps of the speed sensor is its noise."""
        return abs(self.last.velocity) < 2 * self._tuning.slowest

    def take(self, reading: JointState, now: float, trajectory: tuple[float, float] | None) -> None:
        """Note what was read; see `JointMotion.command`. What is not a number is not a reading."""
        time = now - min(reading.age, self._tuning.longest_age_s)
        reference, rate = trajectory or (
            reading.position + lag(reading.load, self._tuning.p_gain),
            reading.velocity,
        )
        sample = Sample(time, reading.position, reading.velocity, reading.load, reference, rate)
        if not sample.sound():
            return
        new = time > self.last.time + SAME
        self.last = sample
        if new:
            self._watch(now)

    def ordered(self, goal: float, speed: float, now: float) -> None:
        """Note what the servo is being told (rad, rad/s): the speed in the steps that it has."""
        step = self._tuning.slowest
        rounded = max(round(speed / step), 1) * step
        self._flight.note(Order(now + self._tuning.bus_time_s, goal, rounded))

    def pinned(self, goal: float) -> None:
        """Forget all motion: the joint holds `goal` (rad)."""
        self._flight = Flight()
        self._flight.note(Order(-math.inf, goal, self._tuning.pin_speed))
        self._start = self._stop = None

    def lose(self) -> None:
        """Forget all orders: nobody knows which of them the servo heard."""
        self._flight = Flight()
        self._start = self._stop = None

    def course(self, now: float) -> Course:
        """The reference when what is sent at `now` (monotonic s) takes effect.

        Whatever is ordered, the reference obeys the earlier orders until then.
        """
        last, tuning = self.last, self._tuning
        if self.still and abs(last.load) > BLOCKED:
            return Course(last.reference, 0.0)
        until = now + tuning.bus_time_s + self.dead_time.value
        since = max(last.time, now - tuning.longest_age_s)
        if not self._flight:  # it was found in motion: all that is known is how fast
            return Course(last.reference + last.velocity * (until - since), last.velocity)
        known = Course(last.reference, last.rate)
        return self._flight.carry(known, since, until, self.dead_time.value, tuning.goal_acceleration)

    def going(self, target: float, sign: float, speed: float, now: float, from_rest: bool) -> None:
        """The joint is being sent to `target` (rad), at `speed` (rad/s), in the direction of `sign`.

        A start from rest tells the dead time as long as it keeps its direction, if nothing ramps it.
        """
        ramped = self._tuning.goal_acceleration > 0
        if from_rest and self._stop is None and self.still and not ramped:
            self._start = StartWatch(self.last.reference, sign, self._tuning.tick)
        self._stop = None
        start = self._start
        if start is None:
            return
        if start.sign != sign or abs(target - self.last.reference) < ARRIVING * self._tuning.tick:
            self._start = None
        else:
            start.order(now + self._tuning.bus_time_s, speed)

    def stopping(self, sign: float, speed: float, now: float) -> None:
        """The joint, which moves in the direction of `sign` at `speed` (rad/s), is told to stop."""
        if self._start is not None:
            self._observe(self._start.told())
        tuning = self._tuning
        self._stop = StopWatch(tuning.rule, now, self.last.position, sign, speed, tuning.slowest, tuning.tick)

    def rests(self, goal: float, estimated: bool) -> None:
        """The stop's goal (rad) is known; `estimated`: it is where the reference was expected to be."""
        if self._stop is not None:
            self._stop.goal = goal
            self._stop.estimated = estimated

    def _watch(self, now: float) -> None:
        if self._start is not None:
            self._observe(self._start.see(self.last))
        if self._stop is None:
            return
        report = self._stop.see(self.last)
        if report is not None:
            self.report = report
            late = self._stop.lateness()
            self._observe(self.dead_time.value + late if late else None)
        if report is not None or now - self._stop.time > PATIENCE:
            self._stop = None

    def _observe(self, dead_time: float | None) -> None:
        if dead_time is not None:
            self.dead_time.observe(dead_time)
            self._start = None
