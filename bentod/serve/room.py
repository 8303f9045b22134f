"""What every method of the API works with: the inbox, and what does not change while the daemon runs."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated, Protocol

from bentod.contracts import FaultInjector
from bentod.control.groups import Group
from bentod.desk import Desk
from bentod.emg.live.lessons import Lessons
from bentod.errors import BadRequest, nearest
from bentod.frames import Frame, JointSpec, Value
from bentod.inbox import Inbox
from bentod.messages import Memo, Packed
from bentod.serve.params import Number, Text
from bentod.serve.session import Session

Joint = Annotated[str, Text("joint name")]
Joints = Annotated[str | list[str] | None, Text("one joint, a list of them, or nil for all")]
GroupName = Annotated[str, Text("group name")]
Lease = Annotated[float, Number("s", 0.05, 10, "the wish ends this long after the last call that renews it")]


@dataclass(frozen=True, slots=True)
class About:
    """What does not change while the daemon runs."""

    arm: str
    driver: str
    rate_hz: float
    joints: tuple[JointSpec, ...]
    groups: Mapping[str, tuple[str, ...]]
    emg: str  # name of the source; empty when there is none
    lease_max: float  # s
    voice: Mapping[str, Value] = field(default_factory=dict)  # [voice] of the config, for whoever speaks


class Takes(Protocol):
    """What records, one file after the other."""

    async def start(self, note: str) -> None:
        """Record into a new file. Raises Refused: the disk does not take it, or another is on its way."""
        ...

    async def stop(self) -> None:
        """End the recording, its file whole. Raises Refused: nothing is recorded, or as `start` does."""
        ...

    def describe(self) -> dict[str, Value]:
        """How the newest recording goes, or went."""
        ...


class Room:
    """The inbox, the newest frame, and names to indices. Handlers never reach the bus through it."""

    def __init__(self, inbox: Inbox, about: About) -> None:
        self.inbox = inbox
        self.about = about
        self.injector: FaultInjector | None = None
        """The arm as something to break on purpose, if it is simulated."""
        self.newest: Frame | None = None
        """The frame of the last tick; the daemon keeps it up to date."""
        self.takes: Takes | None = None
        """What records; None where nothing ever does."""
        self.lessons: Lessons | None = None
        """Where models of muscle signals are trained and kept, if they are recognised."""
        self.commanded: Callable[[str, str, Value, str], None] = lambda *_: None
        """Told of everything that a client asks of the arm: client, method, parameters, error."""
        self.sessions: Callable[[], Sequence[Session]] = tuple
        """Who is connected."""
        self._attached: set[int] = set()
        self._frames = Memo()

    def packed(self, frame: Frame) -> Packed:
        """`frame` as bytes; all who ask for the same one share them."""
        return self._frames.of(frame)

    def attach(self, session: Session) -> None:
        """See to it that the session's leases end with it."""
        if session.id not in self._attached:
            self._attached.add(session.id)
            session.on_close(lambda: self._vanish(session.id))

    def index(self, joint: str) -> int:
        """Index of a joint. Raises BadRequest: there is no such joint."""
        names = [spec.name for spec in self.about.joints]
        if joint not in names:
            raise BadRequest(f"there is no joint '{joint}'{nearest(joint, names)}", "joint")
        return names.index(joint)

    def active(self, group: Group) -> Value:
        """What a method answers that changed or moved what is selected in a group."""
        return {"active": self.about.joints[group.active].name, "together": group.together}

    def _vanish(self, session: int) -> None:
        self._attached.discard(session)
        self.inbox.post(lambda desk: _forget(desk, session))


def _forget(desk: Desk, session: int) -> None:
    desk.clients.vanish(session)
    desk.goals.let_go(session, "its client is gone")
