"""Answers that somebody else begins with, and of which only the error is learned (thesis 4.6.1).

The answer is v̂(s) = a(s) + wᵀφ(s), a being the adviser's. Then

    δ = R + γ v̂(s′) − v̂(s) = (R + γ a(s′) − a(s)) + γ wᵀφ(s′) − wᵀφ(s),

so that any algorithm learns w from a cumulant R + γ a(s′) − a(s), as it would from R alone: potential-based
shaping (Ng, Harada & Russell, ICML 1999), which is the same as values that begin at a (Wiewiora, "Potential-
Based Shaping and Q-Value Initialization are Equivalent", JAIR 2003).
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from bentod.contracts import Vector
from bentod.learn.confidence.columns import check


class Guesses:
    """Of `count` questions that are learned in one go, what was guessed in the step before."""

    def __init__(self, count: int) -> None:
        self.count = count
        self._before: Vector = np.full(count, np.nan)

    def shaped(self, rewards: Vector, gamma: float, now: Vector) -> Vector:
        """The cumulants to learn from; then `now`, the guesses of this step, are those of the step before."""
        found: Vector = rewards + gamma * now - self._before
        self._before = now.copy()
        return found

    def memory(self) -> dict[str, NDArray[np.float64]]:
        """What was guessed last."""
        return {"before": self._before.copy()}

    def recall(self, memory: Mapping[str, NDArray[np.float64]]) -> None:
        """Remember it again. Raises ValueError: it is not that of as many questions."""
        check(memory, {"before": self._before.shape})
        self._before = memory["before"].copy()
