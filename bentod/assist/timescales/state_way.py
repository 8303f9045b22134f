"""A prediction whose γ depends on the state, followed as far as has proved safe (thesis 6.3, (6.7))."""

import math
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from bentod.assist.timescales.memories import Memory, checked
from bentod.assist.timescales.outlooks import Varying
from bentod.contracts_assist import Outlook, Situation
from bentod.frames import Value

CONFIDENT = 0.5
"""C from which on it looks further ahead."""

GROWS = 10.0
"""s of confident motion from the shortest timescale to all that the prediction with a varying γ says."""

SHRINKS = 1.0
"""s of motion without confidence, in which that is lost again."""

RETREAT = 0.5
"""What is left of it after a negative reward."""

STEP = 0.1
"""The most by which what is followed changes in a tick, so that nothing jumps."""


class StateWay:
    """Starts with the shortest timescale, lengthens it as confidence grows, and retreats when it is punished.

    γ itself is learned by questions that this way asks for: `worth` predicts the reward, and γ is a logistic
    function of it.
    """

    def __init__(self, names: Sequence[str], timescales: Sequence[float], rate_hz: float) -> None:
        """`names`: of the questions with a varying γ, by joint. `timescales`: ticks, ascending."""
        self._names = tuple(names)
        self._timescales = tuple(timescales)
        self._rate_hz = rate_hz
        self._leash = 0.0
        self._followed = 0.0

    def see(self, situation: Situation) -> None:
        """A tick begins."""
        if situation.attended is not None or situation.effort != 0:
            confidence = self._confidence(situation)
            grown = 1 / GROWS if confidence >= CONFIDENT else -1 / SHRINKS  # NaN is not confident
            self._leash = min(max(self._leash + grown / self._rate_hz, 0.0), 1.0)
        self._followed = min(max(self._leash, self._followed - STEP), self._followed + STEP)

    def outlook(self, outlook: Outlook, timescale: float) -> Outlook:
        """What the assist sees, which asks for `timescale`."""
        return Varying(outlook, timescale, self._timescales, self._followed, self._names)

    def rewarded(self, reward: float) -> None:
        """Somebody was pleased (above 0), or not (below 0)."""
        if reward < 0:
            self._leash *= RETREAT

    def toggled(self) -> None:
        """Only its price counts."""

    def cut(self) -> None:
        """The assist was off: it begins with the shortest again."""
        self._leash = self._followed = 0.0

    def words(self) -> str:
        """How far is looked ahead."""
        first = f"{self._timescales[0]:g} ticks ahead"
        return f"{self._leash:.0%} of the way from {first} to what it learned"

    def told(self) -> Mapping[str, Value]:
        """The share of the way from the shortest timescale to the prediction with a varying γ."""
        return {"leash": self._leash}

    def memory(self) -> dict[str, NDArray[np.float64]]:
        """Nothing: what was learned is the questions', and how far it is safe is found out anew."""
        return {}

    def recall(self, memory: Memory) -> None:
        """Begin with the shortest. Raises ValueError: there is something in `memory`."""
        checked(memory, {})
        self.cut()

    def _confidence(self, situation: Situation) -> float:
        """The least C of the group's joints that are predicted, at any timescale; NaN: none is known."""
        told = [situation.outlook.confidence(j, t) for j in situation.joints for t in self._timescales]
        known = [confidence for confidence in told if not math.isnan(confidence)]
        return min(known, default=math.nan)
