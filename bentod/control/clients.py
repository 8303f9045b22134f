"""What clients ask of joints, each for as long as its lease lives."""

from collections.abc import Collection
from dataclasses import dataclass

from bentod.control.leases import Holder, Lease, Leases
from bentod.frames import Command, Wishes


@dataclass(frozen=True, slots=True)
class Push:
    """What a client asks of all joints of a group at once."""

    effort: float  # -1..1
    joints: tuple[int, ...]


class Clients:
    """The leases of all clients: one a joint, whether it was asked for by name or through a group.

    A group of which all joints are selected at once is pushed as a whole, on a lease of its own.
    """

    def __init__(self) -> None:
        self._leases: Leases[int, Command] = Leases()
        self._pushes: Leases[str, Push] = Leases()
        self._through: dict[int, str] = {}  # the group through which a joint was asked for

    def move(self, joint: int, lease: Lease[Command], group: str = "") -> None:
        """Take or renew the lease on a joint.

        Raises:
            Refused: another client holds it.
        """
        self._leases.take(joint, lease)
        self._through[joint] = group

    def push(self, group: str, lease: Lease[Push]) -> None:
        """Take or renew the lease on all joints of a group at once. Raises as `move` does."""
        self._pushes.take(group, lease)

    def expire(self, now: float) -> None:
        """Drop what has run out (monotonic s)."""
        self._leases.expire(now)
        self._pushes.expire(now)

    def vanish(self, session: int) -> None:
        """A client is gone, and its wishes with it."""
        self._leases.release(session)
        self._pushes.release(session)

    def drop(self, joints: Collection[int]) -> None:
        """Drop what is asked of these joints, so that no wish outlives a pause."""
        self._leases.drop(joints)
        pushed = [group for group, lease in self._pushes if not set(joints).isdisjoint(lease.wish.joints)]
        self._pushes.drop(pushed)

    def drop_group(self, group: str) -> None:
        """Drop what was asked through a group: something else in it is selected now."""
        self._leases.drop([joint for joint, through in self._through.items() if through == group])
        self._pushes.drop([group])

    def clear(self) -> None:
        """Drop everything."""
        self._leases.clear()
        self._pushes.clear()

    def wishes(self) -> Wishes:
        """What the leases ask, by joint."""
        return {joint: lease.wish for joint, lease in self._leases}

    def holder(self, joint: int) -> Holder | None:
        """The client whose lease moves the joint; None when there is none."""
        return next((lease.holder for held, lease in self._leases if held == joint), None)

    def pusher(self, group: str) -> Lease[Push] | None:
        """Who pushes all joints of a group at once, and how; None when nobody does."""
        return next((lease for pushed, lease in self._pushes if pushed == group), None)
