"""The arm's one long-running request: begun, watched, ended, and told about at each turn."""

from collections.abc import Callable, Iterable, Mapping, Sequence

from bentod.control import homing
from bentod.control.homing import Homing
from bentod.control.modes import Modes
from bentod.frames import GoalFrame, JointSpec, JointState, Mode, Wishes


class Goals:
    """At most one goal at a time; a new one cancels the old.

    Joints that were paused when a goal began move for it all the same, undisturbed by the wearer, and are
    paused again when it ends.
    """

    def __init__(self, modes: Modes, tell: Callable[[GoalFrame], None]) -> None:
        self._modes = modes
        self._tell = tell
        self._goal: Homing | None = None
        self._count = 0

    @property
    def frame(self) -> GoalFrame | None:
        """The newest goal as it stands, ended or not."""
        return self._goal.frame if self._goal else None

    def begin(
        self, specs: Mapping[int, JointSpec], joints: Sequence[JointState], speed: float, now: float
    ) -> int:
        """Send the joints of `specs` home at `speed` (rad/s); returns the goal's number.

        Raises:
            Refused: a fault, or a joint without torque.
        """
        self._modes.may_release(specs)
        self.cancel("another goal came")
        paused = frozenset(joint for joint in specs if self._modes.of(joint) is not Mode.ACTIVE)
        self._modes.pause(specs, False)
        self._count += 1
        self._goal = homing.begin(self._count, specs, joints, speed, now, paused)
        self._tell(self._goal.frame)
        return self._count

    def advance(self, joints: Sequence[JointState], now: float) -> None:
        """Take in a reading."""
        if self._goal and self._goal.running:
            self._change(self._goal, self._goal.advanced(joints, now))

    def cancel(self, reason: str, joints: Iterable[int] | None = None) -> None:
        """End the running goal, if there is one (and if it moves any of `joints`)."""
        goal = self._goal
        if goal and goal.running and (joints is None or not goal.targets.keys().isdisjoint(joints)):
            self._change(goal, goal.cancelled(reason))

    def disturb(self, reason: str) -> None:
        """End the running goal, unless all its joints had been paused: then the wearer has no say."""
        goal = self._goal
        if goal and goal.running and not goal.paused_before >= goal.targets.keys():
            self._change(goal, goal.cancelled(reason))

    @property
    def running(self) -> bool:
        """Whether a goal moves the arm."""
        return self._goal is not None and self._goal.running

    def borrows(self, joint: int) -> bool:
        """Whether the joint is paused to all but the running goal."""
        goal = self._goal
        return goal is not None and goal.running and joint in goal.paused_before

    def wishes(self) -> Wishes:
        """What the running goal asks."""
        return self._goal.wishes() if self._goal and self._goal.running else {}

    def _change(self, old: Homing, new: Homing) -> None:
        self._goal = new
        if not new.running:
            self._modes.pause(new.paused_before, True)
        if _step(old) != _step(new):
            self._tell(new.frame)


def _step(goal: Homing) -> tuple[str, int]:
    """Progress is told in tenths: a client wants a bar, not thirty messages a second."""
    return goal.frame.status, int(goal.frame.progress * 10)
