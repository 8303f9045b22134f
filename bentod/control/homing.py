"""Going home as a goal: accepted, moving, then done or cancelled."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from bentod.frames import GoalFrame, JointSpec, JointState, Position, Wishes

ARRIVED_RAD = 0.03
"""How near to home counts as there: 20 ticks of an MX servo, above its sag under gravity."""

PATIENCE = 3.0
"""A joint may take this many times as long as its way at full homing speed needs, and a second more."""


@dataclass(frozen=True, slots=True)
class Homing:
    """One goal under way."""

    frame: GoalFrame
    targets: Mapping[int, float]  # rad, by joint
    start: Mapping[int, float]  # rad, by joint
    speed: float  # rad/s
    deadline: float  # monotonic s
    paused_before: frozenset[int]  # joints that were not released when the goal began, and will not be after

    @property
    def running(self) -> bool:
        """Whether the goal still moves the arm."""
        return self.frame.status in ("accepted", "moving")

    def wishes(self) -> Wishes:
        """Every joint to its home."""
        return {joint: Position(target, self.speed) for joint, target in self.targets.items()}

    def advanced(self, joints: Sequence[JointState], now: float) -> "Homing":
        """The goal after one more reading: further, done, or out of time."""
        left = {i: abs(joints[i].position - target) for i, target in self.targets.items()}
        whole = {i: abs(self.start[i] - target) for i, target in self.targets.items()}
        if max(left.values()) <= ARRIVED_RAD:
            return replace(self, frame=replace(self.frame, status="done", progress=1.0))
        if now > self.deadline:
            return self.cancelled(f"not there in time, {max(left.values()):.3f} rad are left")
        progress = max(0.0, 1 - max(left.values()) / max(*whole.values(), ARRIVED_RAD))
        return replace(self, frame=replace(self.frame, status="moving", progress=round(progress, 3)))

    def cancelled(self, reason: str) -> "Homing":
        """The goal given up, and why."""
        return replace(self, frame=replace(self.frame, status="cancelled", reason=reason))


def begin(
    goal: int,
    specs: Mapping[int, JointSpec],
    joints: Sequence[JointState],
    speed: float,
    now: float,
    paused: frozenset[int],
) -> Homing:
    """A goal that takes the joints of `specs` home at `speed` (rad/s) or their own maximum."""
    start = {i: joints[i].position for i in specs}
    longest = max(abs(start[i] - s.home) / min(speed, s.max_velocity) for i, s in specs.items())
    return Homing(
        frame=GoalFrame(goal, "go_home", "accepted", 0.0),
        targets={i: spec.home for i, spec in specs.items()},
        start=start,
        speed=speed,
        deadline=now + 1.0 + PATIENCE * longest,
        paused_before=paused,
    )
