"""What a joint's own motions tell about its dead time, and how each of its stops went.

Two things can be seen without disturbing the arm, both in the reference r = p + e_lag, which the load makes
visible and from which gravity and friction cancel, so that both directions count alike:

* A start. The reference leaves its rest one dead time after the order arrived. Whatever speeds were ordered
  since, the way it has gone by a reading tells how many s of orders it has obeyed, and the s that are
  missing are the dead time. This shows a dead time that is believed too short and one that is too long.
* A stop. A reference seen beyond the goal of the stop was caught up with too late: the dead time is longer
  than believed by at least that way / speed. A stop by a dead time that is too long is perfectly quiet (the
  reference was on its way to that goal anyway), so stops alone could never correct it.

The bounce of the joint itself is reported and not learned from: a loop that is not well damped swings even
if its reference stands still, and no choice of the goal changes that.
"""

import math
import statistics
from collections import deque
from dataclasses import dataclass, field

from bentod.frames import StopReport

LONGEST_DEAD_TIME = 0.1
"""s; the longest that Smith & Jivraj measured on AX-12+ is 50 ms (forum.robotis.com)."""

MEMORY = 9
"""Observations that count: after more than half of them nothing is left of an earlier truth."""

WEIGHT_OF_CALIBRATION = 2
"""Observations that the calibrated value is worth: one that is wild, as after a lost order, has no effect."""

RESOLUTION = 0.009
"""s: at speeds so low that a position tick takes longer (an MX: 10 degrees/s) nothing is learned."""

TICKS_AWAY = 4.5
"""Position ticks: a reference that is seen so far from a place is not there (an MX: 0.4 degrees)."""

START = 0.5
"""s from the first order, in which readings count: later, an error of the servo's speed weighs more."""

READINGS_OF_START = 5
"""Readings that make one observation, their median."""

GREATEST_LOAD = 0.8
"""Share: above this the output may be limited, and the lag is more than the load tells."""

STILL = 3
"""New readings without motion that make a rest."""


class DeadTime:
    """The dead time of one joint: as calibrated, slowly corrected by what was observed."""

    def __init__(self, calibrated: float, learning: bool) -> None:
        """`calibrated`: s."""
        self._calibrated = calibrated
        self._learning = learning
        self._observed: deque[float] = deque(maxlen=MEMORY)
        self.value = calibrated
        """s, 0 to `LONGEST_DEAD_TIME` once anything was observed."""

    def observe(self, seconds: float) -> None:
        """Take an observation into the median, which forgets outliers instead of averaging them in."""
        if not self._learning or not math.isfinite(seconds):
            return
        self._observed.append(min(max(seconds, 0.0), LONGEST_DEAD_TIME))
        # What was calibrated gives way to what is seen: it is gone once the memory is full.
        weight = min(WEIGHT_OF_CALIBRATION, MEMORY - len(self._observed))
        prior = min(self._calibrated, LONGEST_DEAD_TIME)
        self.value = statistics.median([*self._observed, *[prior] * weight])

    def recalibrate(self, calibrated: float) -> None:
        """Begin anew from `calibrated` (s)."""
        self._calibrated = self.value = calibrated
        self._observed.clear()


@dataclass(frozen=True, slots=True)
class Sample:
    """One reading of a joint."""

    time: float  # monotonic s, when it was sampled
    position: float  # rad
    velocity: float  # rad/s
    load: float  # -1..1
    reference: float  # rad, as position and load tell it, or the servo itself
    rate: float  # rad/s, of the reference, as well as it is known

    def sound(self) -> bool:
        """Whether all of it is a number."""
        values = (self.time, self.position, self.velocity, self.load, self.reference, self.rate)
        return all(map(math.isfinite, values))


class StartWatch:
    """One motion from rest in one direction, followed until it has told its dead time."""

    def __init__(self, rest: float, sign: float, tick: float) -> None:
        """`rest`: the reference (rad) before it; `sign`: 1.0 or -1.0, its direction; `tick`: rad."""
        self.sign = sign
        self._tick = tick
        self._rest = rest
        self._orders: list[tuple[float, float]] = []
        self._found: list[float] = []

    def order(self, time: float, speed: float) -> None:
        """A speed (rad/s, above 0) that arrives at the servo at `time` (monotonic s)."""
        self._orders.append((time, speed))

    def see(self, sample: Sample) -> float | None:
        """The dead time (s), once there are enough readings to tell it; None before, and after."""
        way = self.sign * (sample.reference - self._rest)
        if not self._tells(sample, way):
            return None
        obeyed = self._obeyed(way)
        if obeyed is not None:
            self._found.append(sample.time - obeyed)
        return statistics.median(self._found) if len(self._found) == READINGS_OF_START else None

    def told(self) -> float | None:
        """The dead time (s) by what was seen so far, None if nothing was."""
        return statistics.median(self._found) if self._found else None

    def _tells(self, sample: Sample, way: float) -> bool:
        if not self._orders or len(self._found) >= READINGS_OF_START or abs(sample.load) > GREATEST_LOAD:
            return False
        return way >= TICKS_AWAY * self._tick and sample.time - self._orders[0][0] <= START

    def _obeyed(self, way: float) -> float | None:
        """Until when (monotonic s) orders must have been obeyed at once to come `way` (rad) far."""
        ends = [time for time, _ in self._orders[1:]] + [math.inf]
        for (begin, speed), end in zip(self._orders, ends, strict=True):
            if way <= speed * (end - begin):
                return begin + way / speed if self._tick <= RESOLUTION * speed else None
            way -= speed * (end - begin)
        return None


@dataclass(slots=True)
class StopWatch:
    """One stop, followed until the joint is at rest."""

    rule: str
    time: float  # monotonic s, when it was told to stop
    start: float  # rad, where it was read at that moment
    sign: float  # 1.0 or -1.0, its direction
    speed: float  # rad/s, above 0, that it was last ordered
    slowest: float  # rad/s; what is below twice that is no motion
    tick: float  # rad
    goal: float | None = None  # rad, once it is known
    estimated: bool = False  # whether the goal is where the reference was expected to be
    _beyond: float = field(default=0.0)
    _peak: float = field(default=0.0)
    _still: int = field(default=0)

    def see(self, sample: Sample) -> StopReport | None:
        """The report, once the joint is at rest."""
        way = self.sign * (sample.position - self.start)
        self._peak = max(self._peak, way)
        if self.goal is None or sample.time <= self.time:
            return None
        if abs(sample.load) <= GREATEST_LOAD:
            self._beyond = max(self._beyond, self.sign * (sample.reference - self.goal))
        moves = abs(sample.velocity) >= 2 * self.slowest
        self._still = 0 if moves else self._still + 1
        if self._still < STILL:
            return None
        return StopReport(self.rule, self.time, way, max(self._peak - way, 0.0))

    def lateness(self) -> float:
        """S by which the dead time is at least longer than this stop believed; 0 if nothing shows."""
        visible = self.tick <= RESOLUTION * self.speed and self._beyond >= TICKS_AWAY * self.tick
        if not (visible and self.estimated):
            return 0.0
        return self._beyond / self.speed
