"""Who must keep asking for a goal so that it goes on, and until when."""

from dataclasses import dataclass, replace

from bentod.control.leases import Holder, Lease


@dataclass(frozen=True, slots=True)
class Hold:
    """How a client asks for a goal that ends with it."""

    holder: Holder
    lease: float  # s
    goal: int | None = None  # number of the one that is meant; None: this may begin one


@dataclass(frozen=True, slots=True)
class Grip:
    """A client's hold on a goal. It outlives a goal that was cancelled, until the client has let go of it."""

    goal: int
    lease: Lease[frozenset[int]]  # on the joints that it sends home


class Grips:
    """At most one a client: the goal that it last asked for with a lease."""

    def __init__(self) -> None:
        self._grips: dict[int, Grip] = {}

    def take(self, goal: int, lease: Lease[frozenset[int]]) -> None:
        """Hold a goal that has just begun."""
        self._grips[lease.holder.session] = Grip(goal, lease)

    def renew(self, lease: Lease[frozenset[int]]) -> Grip | None:
        """What the same client holds of the same joints, for as long as `lease`; None if it does not."""
        session = lease.holder.session
        grip = self._grips.get(session)
        if grip is None or grip.lease.wish != lease.wish:
            return None
        self._grips[session] = replace(grip, lease=lease)
        return grip

    def expire(self, now: float) -> list[Grip]:
        """Drop and return what has run out (monotonic s)."""
        ended = [grip for grip in self._grips.values() if grip.lease.expires <= now]
        for grip in ended:
            del self._grips[grip.lease.holder.session]
        return ended

    def release(self, session: int) -> Grip | None:
        """Drop and return what a client holds: it said so, or it vanished."""
        return self._grips.pop(session, None)
