"""The way that a group of joints has come, as far as it is remembered: to be gone back along."""

from collections import deque
from collections.abc import Sequence
from typing import TypeAlias

Posture: TypeAlias = tuple[float, ...]
"""rad, of the joints of a group in its order."""

SPACING = 0.02
"""rad that some joint must have moved before a posture is remembered; 20 ticks of an MX at its slowest."""
REACH = 0.05
"""rad within which a remembered posture counts as reached: corners are cut by no more than that."""
LEAP = 0.25
"""rad that no joint moves between two ticks (7 rad/s at 30 Hz); what lies between is not known to be free."""
MOST = 2048
"""Postures; 41 rad of the way at least."""


class Path:
    """Postures in the order in which they were left. The oldest are forgotten first."""

    def __init__(self) -> None:
        self._postures: deque[Posture] = deque(maxlen=MOST)

    def __len__(self) -> int:
        return len(self._postures)

    def note(self, posture: Posture) -> None:
        """The joints are at `posture` in this tick. After a leap the way begins anew."""
        far = self._way_to(posture)
        if far > LEAP:
            self._postures.clear()
        if far >= SPACING or not self._postures:
            self._postures.append(posture)

    def back(self, posture: Posture) -> Posture | None:
        """Where to go next from `posture` to go back; None: this is as far as the way is remembered.

        What has been reached is forgotten.
        """
        if self._way_to(posture) > LEAP:
            self._postures.clear()
        while self._postures and self._reached(posture):
            self._postures.pop()
        return self._postures[-1] if self._postures else None

    def _reached(self, posture: Posture) -> bool:
        far = self._way_to(posture)
        before = _distance(self._postures[-2], posture) if len(self._postures) > 1 else far + 1
        return far < REACH or before <= far

    def _way_to(self, posture: Posture) -> float:
        return _distance(self._postures[-1], posture) if self._postures else 0.0


def _distance(one: Sequence[float], other: Sequence[float]) -> float:
    """What the joint with the longest way has to go, rad."""
    return max((abs(a - b) for a, b in zip(one, other, strict=True)), default=0.0)
