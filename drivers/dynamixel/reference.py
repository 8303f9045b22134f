"""Where a servo's own reference is: the point that its position loop follows, and that no register shows.

In joint mode a servo moves its reference towards the goal at Moving Speed, ramped by Goal Acceleration, and
a P loop pulls the joint after it. What is written takes effect one dead time after it arrives. So there are
always orders in flight, and the reference goes on by them for a while whatever is written now.

Manual: https://emanual.robotis.com/docs/en/dxl/mx/mx-28/#moving-speed and #goal-acceleration.
"""

import math
from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass

LAG_AT_FULL_LOAD = math.radians(11.33)
"""rad: 1 / (0.158 P) at P = 32, the law measured in Rhoban's bam, `bam/dynamixel/actuator.py`."""

P_GAIN_OF_LAG = 32
"""The P gain at which `LAG_AT_FULL_LOAD` holds; also the MX default."""

STEP = 0.002
"""s: of the integration of a ramp."""

KEPT = 1.0
"""s: no order is in flight for longer, and no reading is extrapolated for longer."""


@dataclass(frozen=True, slots=True)
class Order:
    """What a servo was told."""

    time: float  # monotonic s, when it arrived at the servo
    goal: float  # rad
    speed: float  # rad/s, above 0


@dataclass(frozen=True, slots=True)
class Course:
    """The reference at one moment."""

    place: float  # rad
    rate: float  # rad/s, signed


def lag(load: float, p_gain: float) -> float:
    """By how much (rad, signed) the reference leads the measured position.

    A proportional position loop holds an output of `load` only with an error of `load` / Kp.
    """
    return LAG_AT_FULL_LOAD * load * P_GAIN_OF_LAG / p_gain


def coast(velocity: float, acceleration: float) -> float:
    """Distance (rad, signed) that the servo's profile needs to slow down: v² / 2a, 0 without a profile."""
    if acceleration <= 0:
        return 0.0
    return math.copysign(velocity**2 / (2 * acceleration), velocity)


def follow(course: Course, order: Order, seconds: float, acceleration: float) -> Course:
    """The reference `seconds` later.

    Without Goal Acceleration it goes at Moving Speed and stands at the goal. With it, the profile is
    v ≤ Moving Speed, v ≤ √(2a · distance), dv ≤ a · dt; the square root is what makes it slow down in time.
    """
    if acceleration <= 0:
        left, most = order.goal - course.place, order.speed * seconds
        if abs(left) <= most:
            return Course(order.goal, 0.0)
        return Course(course.place + math.copysign(most, left), math.copysign(order.speed, left))
    place, rate = course.place, course.rate
    count = math.ceil(seconds / STEP)
    for _ in range(count):
        left = order.goal - place
        wanted = math.copysign(min(order.speed, math.sqrt(2 * acceleration * abs(left))), left)
        change = acceleration * seconds / count
        rate += min(max(wanted - rate, -change), change)
        place += rate * seconds / count
    return Course(place, rate)


class Flight:
    """The orders that a servo was given lately."""

    def __init__(self) -> None:
        self._orders: deque[Order] = deque()

    def __len__(self) -> int:
        return len(self._orders)

    def note(self, order: Order) -> None:
        """An order that is being sent; a repetition is none."""
        orders = self._orders
        if orders and (orders[-1].goal, orders[-1].speed) == (order.goal, order.speed):
            return
        orders.append(order)
        while len(orders) > 1 and orders[1].time < order.time - KEPT:
            orders.popleft()

    def carry(
        self, course: Course, since: float, until: float, dead_time: float, acceleration: float
    ) -> Course:
        """The reference at `until`, from `course` at `since` (monotonic s): each order in its own time."""
        for order, begin, end in self._spans(dead_time):
            begin, end = max(begin, since), min(end, until)
            if end > begin:
                course = follow(course, order, end - begin, acceleration)
        return course

    def _spans(self, dead_time: float) -> Iterator[tuple[Order, float, float]]:
        """Each order, and from when to when it was or will be obeyed."""
        orders = self._orders
        for number, order in enumerate(orders):
            last = number == len(orders) - 1
            yield order, order.time + dead_time, math.inf if last else orders[number + 1].time + dead_time
