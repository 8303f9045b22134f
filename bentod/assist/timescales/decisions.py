"""When to choose a timescale anew, and what the last choice was worth."""

HOLD = 0.5
"""s of motion for which a choice holds at least, unless the operator toggles."""

LONGEST = 3.0
"""s of motion after which it is chosen anew even in mid-motion."""

HORIZON = 3.0
"""s of motion, over which rewards count for what was chosen before them."""


class Decisions:
    """Counts only the ticks in which the operator moves: a rest, however long, changes nothing.

    A choice is made as a motion begins, after a toggle or once the last one held for a while. What the
    toggles in between cost is the last choice's.
    """

    def __init__(self, rate_hz: float) -> None:
        self._gamma = 1 - 1 / max(HORIZON * rate_hz, 1.0)
        self._hold = HOLD * rate_hz
        self._longest = LONGEST * rate_hz
        self.begin()

    def begin(self) -> None:
        """Nothing has been chosen yet."""
        self._ticks = 0
        self._discount = 1.0
        self._reward = 0.0
        self._rested = True
        self._toggled = True

    def rewarded(self, reward: float) -> None:
        """Somebody was pleased (above 0) or not with the last choice."""
        self._reward += self._discount * reward

    def toggled(self) -> None:
        """The operator has selected another joint."""
        self._toggled = True

    def due(self, moves: bool) -> bool:
        """Whether to choose in this tick; once a tick. `moves`: whether the operator does."""
        if not moves:
            self._rested = True
            return False
        fresh, self._rested = self._rested, False
        free = self._toggled or self._ticks >= self._hold
        self._ticks += 1
        self._discount *= self._gamma
        return (fresh and free) or self._ticks > self._longest

    def take(self) -> tuple[float, float]:
        """What the last choice earned, and γ^n of the n ticks that it lasted; another one begins."""
        earned, discount = self._reward, self._discount
        self._ticks, self._discount, self._reward, self._toggled = 0, 1.0, 0.0, False
        return earned, discount
