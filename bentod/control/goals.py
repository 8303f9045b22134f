"""The arm's one long-running request: begun, watched, ended, and told about at each turn."""

from collections.abc import Callable, Iterable, Mapping, Sequence

from bentod.control import homing
from bentod.control.grips import Grip, Grips
from bentod.control.homing import Homing
from bentod.control.leases import Lease
from bentod.control.modes import Modes
from bentod.errors import Refused
from bentod.frames import GoalFrame, JointSpec, JointState, Mode, Wishes


class Goals:
    """At most one goal at a time; a new one cancels the old.

    Joints that were paused when a goal began move for it all the same, undisturbed by the wearer, and are
    paused again when it ends.

    A goal may be leased: its client renews it by asking again, and it ends when that client falls silent or
    is gone. One that was cancelled does not begin anew by being renewed, or a stop would undo itself as long
    as somebody holds a button: the client must let go first.
    """

    def __init__(self, modes: Modes, tell: Callable[[GoalFrame], None]) -> None:
        self._modes = modes
        self._tell = tell
        self._goal: Homing | None = None
        self._grips = Grips()
        self._count = 0

    @property
    def frame(self) -> GoalFrame | None:
        """The newest goal as it stands, ended or not."""
        return self._goal.frame if self._goal else None

    def begin(
        self,
        specs: Mapping[int, JointSpec],
        joints: Sequence[JointState],
        speed: float,
        now: float,
        lease: Lease[frozenset[int]] | None = None,
    ) -> int:
        """Send the joints of `specs` home at `speed` (rad/s); returns the goal's number.

        It ends with its `lease`, if it has one and that is not renewed.

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
        if lease:
            self._grips.take(self._count, lease)
        return self._count

    def renew(self, lease: Lease[frozenset[int]], number: int | None = None) -> int | None:
        """Keep the goal that the same client holds of the same joints for as long as `lease`.

        Returns its number, also when it is done already; None: these joints are not held. `number`: of the
        goal that is meant, and no other.

        Raises:
            Refused: it was cancelled, and the client has not let go since; or it is not the one meant.
        """
        grip, goal = self._grips.renew(lease), self._goal
        if number is not None and (grip is None or grip.goal != number):
            raise Refused(f"goal {number} is not held any more, and asking for it does not begin another")
        if grip is None:
            return None
        cause = goal.frame.reason if goal and goal.frame.id == grip.goal else "another goal came"
        if cause:
            raise Refused(f"goal {grip.goal} was cancelled ({cause}): let go before you ask for it again")
        return grip.goal

    def let_go(self, session: int, why: str) -> None:
        """A client holds no goal any more: it said so, or it vanished."""
        if grip := self._grips.release(session):
            self._cancel_held(grip, why)

    def advance(self, joints: Sequence[JointState], now: float) -> None:
        """Take in a reading, at a time (monotonic s) when leases may have run out."""
        for grip in self._grips.expire(now):
            self._cancel_held(grip, "its lease ran out")
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

    def _cancel_held(self, grip: Grip, why: str) -> None:
        if self._goal and self._goal.frame.id == grip.goal:
            self.cancel(why)

    def _change(self, old: Homing, new: Homing) -> None:
        self._goal = new
        if not new.running:
            self._modes.pause(new.paused_before, True)
        if _step(old) != _step(new):
            self._tell(new.frame)


def _step(goal: Homing) -> tuple[str, int]:
    """Progress is told in tenths: a client wants a bar, not thirty messages a second."""
    return goal.frame.status, int(goal.frame.progress * 10)
