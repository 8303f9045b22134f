"""How a wish for one joint is cut to what the joint may do where it is: pure, one joint, one moment."""

import math
from dataclasses import dataclass

from bentod.frames import JointSpec, Position, Velocity

CRAWL = 0.05
"""Rad/s at which a joint arrives at a limit: four times the slowest speed of an MX servo."""

NEAR = 0.005
"""Rad from its goal within which a position is as good as reached: one step of an AX's sensor."""

LEAST_SHARE = 0.2
"""Share of its top speed that a joint keeps until it is hot: enough to bring it down to rest."""

FALLEN = 0.9
"""Share of its bound below which a load must fall before the joint may go on against it."""


@dataclass(frozen=True, slots=True)
class Aim:
    """A wish on its way through the limits."""

    velocity: float  # rad/s, signed
    goal: float | None = None  # rad, where it is to end, if it names a place
    limited: str = ""  # the last limit that changed it

    def slowed(self, speed: float, limit: str) -> "Aim":
        """At no more than `speed` (rad/s, 0 or more), because of `limit`."""
        if abs(self.velocity) <= speed:
            return self
        return Aim(math.copysign(speed, self.velocity), self.goal, limit)


def aim(wish: Velocity | Position, spec: JointSpec, position: float, heading: float, change: float) -> Aim:
    """What `wish` asks of a joint at `position` (rad), within its position and velocity limits.

    A place is approached as slowly as it must be to arrive there at rest, which counts as no limit. `heading`
    (rad/s): how it was sent last, which is the direction of a joint that is there. `change` (rad/s): by how
    much its velocity may change in this tick. Velocities that are not finite or 0 come out as 0.
    """
    match wish:
        case Velocity(velocity=velocity):
            if not math.isfinite(velocity):
                return Aim(0.0, limited="not finite")
            return Aim(velocity).slowed(spec.max_velocity, "velocity")
        case Position(position=place, speed=speed):
            if not (math.isfinite(place) and math.isfinite(speed)):
                return Aim(0.0, limited="not finite")
            if speed <= 0:
                return Aim(0.0, limited="velocity")
            goal = spec.clamp(place)
            way = goal - position
            inside = Aim(speed, goal, "" if goal == place else "position")
            allowed = inside.slowed(spec.max_velocity, "velocity")
            arriving = min(allowed.velocity, _approach(abs(way), spec, change))
            return Aim(math.copysign(arriving, way or heading), goal, allowed.limited)


def share_of_speed(spec: JointSpec, temperature: float) -> float:
    """Share of its top speed (LEAST_SHARE to 1) that a joint has at a temperature (degrees Celsius)."""
    warm, hot = spec.bounds.warm, spec.bounds.hot
    if not temperature > warm:
        return 1.0
    return max(LEAST_SHARE, 1 - (1 - LEAST_SHARE) * (temperature - warm) / (hot - warm))


def room(spec: JointSpec, position: float, velocity: float) -> float:
    """Rad to the limit that `velocity` leads to; negative beyond it."""
    return spec.maximum - position if velocity > 0 else position - spec.minimum


def speed_towards_limit(spec: JointSpec, left: float, period: float) -> float:
    """The greatest speed v (rad/s) to keep for a period T (s), `left` rad before a limit.

    v·T + (v² − crawl²) / 2b = left, so that there is room to brake afterwards. The deceleration b is what
    brings top speed down within the soft zone, or, where the joint may not brake so hard, all that it may:
    then it begins to slow down before the zone.
    """
    bounds = spec.bounds
    crawl = min(CRAWL, spec.max_velocity)
    braking = bounds.acceleration
    if bounds.soft_zone > 0:
        braking = min(braking, spec.max_velocity**2 / (2 * bounds.soft_zone))
    change = braking * period
    return max(crawl, math.sqrt(change**2 + crawl**2 + 2 * braking * max(left, 0.0)) - change)


def loaded(before: int, load: float, bound: float) -> int:
    """The direction (-1, 1, or 0: neither) in which a joint pushes against more than its bound.

    Once it does, the load must fall to `FALLEN` of the bound: at the bound itself it would start and stop
    with every reading. A load that is not known changes nothing.
    """
    if abs(load) > bound:
        return 1 if load > 0 else -1
    if abs(load) < FALLEN * bound or load * before < 0:
        return 0
    return before


def _approach(way: float, spec: JointSpec, change: float) -> float:
    """The greatest speed (rad/s) at `way` rad before a goal: v² = 2·a·way, and near it a crawl.

    The crawl is so slow that a joint that is read on either side of its goal in turn needs no ramp.
    """
    crawl = min(CRAWL, change / 2)
    return max(crawl, math.sqrt(2 * spec.bounds.acceleration * max(way - NEAR, 0.0)))
