"""Who drives a group of joints when several want to: two operators at once interfere (thesis A.1.3)."""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field

REST = 0.3
"""s at rest after which whoever drives a group has left it to others."""


@dataclass(frozen=True, slots=True)
class Asked:
    """What one operator asks in one tick."""

    efforts: Mapping[str, float]  # by group, -1..1; a group that is absent is not asked for anything
    toggles: Sequence[str] = ()  # groups, once for each toggle
    toggles_back: Sequence[str] = ()  # the same, to the joint before
    tense: Collection[str] = ()  # groups for which they are not at rest, be it that they ask for nothing
    moves: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    """Of groups that have no active joint for them: by joint, the share of its speed that effort 1 asks."""


@dataclass(slots=True)
class _Seat:
    """Who drives one group."""

    driver: str = ""
    effort: float = 0.0  # -1..1, the driver's
    left: float = 0.0  # monotonic s, when the driver was last seen not at rest
    suspended: set[str] = field(default_factory=set)  # must be seen at rest before they may drive


class Operators:
    """One operator a group at a time.

    Among equals, whoever comes first drives until at rest for `REST`. A client with a lease on the active
    joint is stronger and takes the group at once; so does one that switches it to another joint. Whoever asks
    for a group that is not theirs is suspended, toggles included, until seen at rest once: when the
    other has gone, nothing jumps to what they happen to ask for. So is everybody when joints are released.
    """

    def __init__(self, groups: Collection[str], names: Collection[str]) -> None:
        self._seats = {group: _Seat() for group in groups}
        self._names = frozenset(names)

    def decide(self, asked: Mapping[str, Asked], taken: Collection[str], now: float) -> dict[str, Asked]:
        """What of `asked`, by operator in the order of their names, holds now (monotonic s).

        `taken`: groups on whose active joint a client has a lease.
        """
        allowed = {
            name: [
                [group for group in groups if self._may_toggle(group, name, taken)]
                for groups in (one.toggles, one.toggles_back)
            ]
            for name, one in asked.items()
        }
        for group, seat in self._seats.items():
            efforts = {name: one.efforts[group] for name, one in asked.items() if group in one.efforts}
            resting = {name for name, effort in efforts.items() if effort == 0}
            seat.suspended -= {name for name in resting if group not in asked[name].tense}
            numbers = {name: effort for name, effort in efforts.items() if not math.isnan(effort)}
            _decide(seat, numbers, group in taken, now)
        return {name: Asked(self._efforts(name), on, back) for name, (on, back) in allowed.items()}

    def suspend(self, group: str) -> None:
        """Somebody changed what the group may do: all operators must be seen at rest before they drive it."""
        self._seats[group].suspended |= self._names
        self._seats[group].driver = ""

    def suspend_all(self) -> None:
        """The same for every group."""
        for group in self._seats:
            self.suspend(group)

    def driver(self, group: str) -> str:
        """The operator that drives the group; empty when none does."""
        return self._seats[group].driver

    def effort(self, group: str) -> float:
        """What the operator that drives the group asks, -1..1."""
        return self._seats[group].effort if self._seats[group].driver else 0.0

    def _may_toggle(self, group: str, name: str, taken: Collection[str]) -> bool:
        seat = self._seats[group]
        return seat.driver in ("", name) and name not in seat.suspended and group not in taken

    def _efforts(self, name: str) -> dict[str, float]:
        return {group: seat.effort for group, seat in self._seats.items() if seat.driver == name}


def _decide(seat: _Seat, efforts: Mapping[str, float], taken: bool, now: float) -> None:
    """Decide who drives; `taken`: a client does."""
    asking = [name for name, effort in efforts.items() if effort]
    if taken or (seat.driver not in asking and now - seat.left >= REST):
        seat.driver = ""
    free = [name for name in asking if name not in seat.suspended]
    if not seat.driver and free and not taken:
        seat.driver = free[0]
    if seat.driver in asking:
        seat.left = now
    seat.effort = efforts.get(seat.driver, 0.0)
    seat.suspended |= set(asking) - {seat.driver}
