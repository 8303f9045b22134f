"""Sarsa(λ) with linear function approximation, over decisions that last several ticks.

Sutton & Barto, "Reinforcement Learning" (1998), section 8.4, with replacing traces that are cleared for the
actions not taken (Singh & Sutton 1996); a decision that lasts n ticks is discounted by γ^n, as an option is
(Sutton, Precup & Singh 1999, section 3):

    δ = R + γ^n Q(s', a') − Q(s, a)        w ← w + α δ e        e ← γ^n λ e, then 1 where (s', a') is active

Greedy with probability 1 − ε. As long as no reward has come there is nothing to find out, and nothing is
tried.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bentod.assist.timescales.dice import Dice
from bentod.assist.timescales.memories import Memory, checked
from bentod.contracts import Features

LARGEST = 1e3
"""Of a weight and of a decision's reward, either way: whatever is rewarded, all stays finite."""


@dataclass(frozen=True, slots=True)
class SarsaSettings:
    """α is divided by the number of active features: below 1 no update overshoots."""

    step_size: float = 0.3
    lam: float = 0.7
    epsilon: float = 0.05


class Sarsa:
    """Chooses one of a few actions; of equally good ones that which is nearest to `preferred`."""

    def __init__(
        self,
        features: int,
        active: int,
        actions: int,
        preferred: int,
        seed: int,
        settings: SarsaSettings = SarsaSettings(),
    ) -> None:
        """`features`: how many there are; `active`: how many of them at once, at most."""
        self.w: NDArray[np.float64] = np.zeros((actions, features))
        """Weights, shape (actions, features)."""
        self._alpha = settings.step_size / active
        self._settings = settings
        self._order = sorted(range(actions), key=lambda action: (abs(action - preferred), action))
        self._dice = Dice(seed)
        self._taught = False
        self._e: NDArray[np.float64] = np.zeros((actions, features))
        self._q: float | None = None

    def values(self, features: Features) -> NDArray[np.float64]:
        """Q of each action, shape (actions,)."""
        found: NDArray[np.float64] = self.w[:, features].sum(axis=1)
        return found

    def step(self, features: Features, reward: float, discount: float) -> int:
        """The next action, after `reward` for the last one, whose ticks are worth `discount` = γ^n."""
        reward = min(max(reward, -LARGEST), LARGEST)
        self._taught = self._taught or reward != 0
        action = self._act(features)
        if self._q is not None:
            self._learn(reward + discount * float(self.w[action, features].sum()) - self._q)
        self._e *= discount * self._settings.lam
        self._e[:, features] = 0.0
        self._e[action, features] = 1.0
        self._q = float(self.w[action, features].sum())
        return action

    def cut(self) -> None:
        """What comes next has nothing to do with what came before."""
        self._e[:] = 0.0
        self._q = None

    def memory(self) -> dict[str, NDArray[np.float64]]:
        """Copies of what was learned."""
        state = np.array([self._dice.thrown, float(self._taught)], dtype=np.float64)
        return {"w": self.w.copy(), "state": state}

    def recall(self, memory: Memory) -> None:
        """Go on with it. Raises ValueError: it does not fit."""
        found = checked(memory, {"w": self.w.shape, "state": (2,)})
        self._dice.recall(float(found["state"][0]))
        self._taught = bool(found["state"][1])
        self.w = np.clip(found["w"], -LARGEST, LARGEST)
        self.cut()

    def _learn(self, delta: float) -> None:
        self.w += self._alpha * delta * self._e
        np.clip(self.w, -LARGEST, LARGEST, out=self.w)

    def _act(self, features: Features) -> int:
        explores = self._dice.uniform() < self._settings.epsilon
        any_other = self._dice.below(len(self.w))
        if explores and self._taught:
            return any_other
        q = self.values(features)
        return max(self._order, key=lambda action: float(q[action]))  # the first of equals
