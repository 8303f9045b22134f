"""Timescales that are chosen or blended by what was rewarded: Sarsa, and an actor-critic (thesis 6.3)."""

import math
from collections.abc import Mapping, Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from bentod.assist.timescales.actor_critic import ActorCritic
from bentod.assist.timescales.decisions import Decisions
from bentod.assist.timescales.gaussian import weights
from bentod.assist.timescales.memories import Memory
from bentod.assist.timescales.outlooks import Blend
from bentod.assist.timescales.postures import Postures
from bentod.assist.timescales.sarsa import Sarsa
from bentod.contracts import Features
from bentod.contracts_assist import Outlook, Situation
from bentod.frames import Value

FADE = 10
"""Ticks from one choice to the next: what is followed moves over, and does not jump."""

WIDEST, NARROWEST, FIGURE = 1.0, 0.1, 0.3
"""Of the Gaussian's standard deviation, in spans of γ: its bounds, and that of Fig. 6.1."""


class Picker(Protocol):
    """Says how much each timescale counts, and learns from what came of it."""

    def pick(self, features: Features, reward: float, discount: float) -> NDArray[np.float64]:
        """Shares of the timescales, 1 in all, after `reward` for the last ones and γ^n = `discount`."""
        ...

    def cut(self) -> None:
        """What comes next has nothing to do with what came before."""
        ...

    def memory(self) -> dict[str, NDArray[np.float64]]:
        """Copies of what was learned."""
        ...

    def recall(self, memory: Memory) -> None:
        """Go on with it. Raises ValueError: it does not fit."""
        ...


class OneOf(Sarsa):
    """All of one timescale, which Sarsa(λ) picks."""

    def pick(self, features: Features, reward: float, discount: float) -> NDArray[np.float64]:
        """As in `Picker`."""
        shares = np.zeros(len(self.w))
        shares[self.step(features, reward, discount)] = 1.0
        return shares


class Gaussian(ActorCritic):
    """A Gaussian over γ, whose mean and standard deviation an actor-critic finds.

    It chooses two numbers in 0..1: the mean, from the least γ to the greatest; and the logarithm of the
    standard deviation, from a tenth of that span to all of it.
    """

    def __init__(self, features: int, active: int, gammas: Sequence[float], first: float, seed: int) -> None:
        """`first`: γ at which the mean begins."""
        self._gammas = tuple(gammas)
        self._low, self._span = min(gammas), max(gammas) - min(gammas)
        narrow = math.log(FIGURE / NARROWEST) / math.log(WIDEST / NARROWEST)
        super().__init__(features, active, ((first - self._low) / self._span, narrow), seed)

    def pick(self, features: Features, reward: float, discount: float) -> NDArray[np.float64]:
        """As in `Picker`."""
        mean, spread = self.step(features, reward, discount).tolist()
        sd = NARROWEST * (WIDEST / NARROWEST) ** spread
        return weights(self._gammas, self._low + mean * self._span, sd * self._span)


class LearnedWay:
    """Follows what a picker picks, at the moments that `Decisions` finds."""

    def __init__(
        self, postures: Postures, picker: Picker, timescales: Sequence[float], first: float, rate_hz: float
    ) -> None:
        """`first`: the timescale (ticks) that is followed at first."""
        self._postures = postures
        self._picker = picker
        self._timescales = tuple(timescales)
        self._decisions = Decisions(rate_hz)
        self._chosen = np.array([float(t == first) for t in timescales])
        self._followed = self._chosen
        self._fading = 0

    def see(self, situation: Situation) -> None:
        """A tick begins."""
        moves = situation.attended is not None or situation.effort != 0
        if self._decisions.due(moves and self._postures.sees(situation)):
            features = self._postures.features(situation)
            self._chosen = self._picker.pick(features, *self._decisions.take())
            self._fading = FADE
        if self._fading:
            self._followed = self._followed + (self._chosen - self._followed) / self._fading
            self._fading -= 1

    def outlook(self, outlook: Outlook, timescale: float) -> Outlook:
        """What the assist sees, which asks for `timescale`."""
        return Blend(outlook, timescale, self._timescales, self._followed.tolist())

    def rewarded(self, reward: float) -> None:
        """Somebody was pleased (above 0) or not (below 0)."""
        self._decisions.rewarded(reward)

    def toggled(self) -> None:
        """The operator has selected another joint."""
        self._decisions.toggled()

    def cut(self) -> None:
        """The assist was off."""
        self._decisions.begin()
        self._picker.cut()

    def words(self) -> str:
        """How far is looked ahead."""
        best = int(np.argmax(self._chosen))
        if self._chosen[best] == 1:
            return f"{self._timescales[best]:g} ticks ahead, as it learned to"
        return f"about {self._mean():.3g} ticks ahead, as it learned to"

    def told(self) -> Mapping[str, Value]:
        """The shares of the timescales (ticks)."""
        shares = zip(self._timescales, self._chosen.tolist(), strict=True)
        return {f"{timescale:g}": share for timescale, share in shares}

    def memory(self) -> dict[str, NDArray[np.float64]]:
        """Copies of what was learned."""
        return self._picker.memory()

    def recall(self, memory: Memory) -> None:
        """Go on with it. Raises ValueError: it does not fit."""
        self._picker.recall(memory)

    def _mean(self) -> float:
        gamma = float(np.dot(self._chosen, [1 - 1 / t for t in self._timescales]))
        return 1 / (1 - gamma)
