"""Wishes of clients, which die with their lease or with their client."""

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from typing import Generic, TypeVar

from bentod.errors import Refused

Key = TypeVar("Key")
Wish = TypeVar("Wish")


@dataclass(frozen=True, slots=True)
class Holder:
    """Who holds a lease."""

    session: int
    client: str


@dataclass(frozen=True, slots=True)
class Lease(Generic[Wish]):
    """One wish with its end."""

    holder: Holder
    wish: Wish
    expires: float  # monotonic s


class Leases(Generic[Key, Wish]):
    """At most one lease a key (a joint, a group): who holds it keeps it until it lets go or runs out."""

    def __init__(self) -> None:
        self._leases: dict[Key, Lease[Wish]] = {}

    def take(self, key: Key, lease: Lease[Wish]) -> None:
        """Take or renew the lease on `key`.

        Raises:
            Refused: another client holds it.
        """
        held = self._leases.get(key)
        if held is not None and held.holder.session != lease.holder.session:
            raise Refused(f"'{held.holder.client}' holds it; its lease ends by itself when not renewed")
        self._leases[key] = lease

    def expire(self, now: float) -> None:
        """Drop what has run out (s)."""
        self._leases = {key: lease for key, lease in self._leases.items() if lease.expires > now}

    def release(self, session: int) -> None:
        """Drop all of one client's leases: it said so, or it vanished."""
        self._leases = {k: lease for k, lease in self._leases.items() if lease.holder.session != session}

    def drop(self, keys: Collection[Key]) -> None:
        """Drop the leases on `keys`."""
        self._leases = {key: lease for key, lease in self._leases.items() if key not in keys}

    def clear(self) -> None:
        """Drop all leases."""
        self._leases.clear()

    def __iter__(self) -> Iterator[tuple[Key, Lease[Wish]]]:
        return iter(self._leases.items())
