"""What clients ask of joints, each for as long as its lease lives."""

from collections.abc import Collection

from bentod.control.leases import Holder, Lease, Leases
from bentod.frames import Command, Wishes


class Clients:
    """The leases of all clients: one a joint, whether it was asked for by name or through a group."""

    def __init__(self) -> None:
        self._leases: Leases[int, Command] = Leases()
        self._through: dict[int, str] = {}  # the group through which a joint was asked for

    def move(self, joint: int, lease: Lease[Command], group: str = "") -> None:
        """Take or renew the lease on a joint.

        Raises:
            Refused: another client holds it.
        """
        self._leases.take(joint, lease)
        self._through[joint] = group

    def expire(self, now: float) -> None:
        """Drop what has run out (monotonic s)."""
        self._leases.expire(now)

    def vanish(self, session: int) -> None:
        """A client is gone, and its wishes with it."""
        self._leases.release(session)

    def drop(self, joints: Collection[int]) -> None:
        """Drop what is asked of these joints, so that no wish outlives a pause."""
        self._leases.drop(joints)

    def drop_group(self, group: str) -> None:
        """Drop what was asked through a group: its active joint is another one now."""
        self.drop([joint for joint, through in self._through.items() if through == group])

    def clear(self) -> None:
        """Drop everything."""
        self._leases.clear()

    def wishes(self) -> Wishes:
        """What the leases ask, by joint."""
        return {joint: lease.wish for joint, lease in self._leases}

    def holder(self, joint: int) -> Holder | None:
        """The client whose lease moves the joint; None when there is none."""
        return next((lease.holder for held, lease in self._leases if held == joint), None)
