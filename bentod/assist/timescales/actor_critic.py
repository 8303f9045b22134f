"""Continuous actor-critic with eligibility traces, over decisions that last several ticks.

Degris, Pilarski & Sutton, "Model-free reinforcement learning with continuous action in practice", ACC 2012:
a normal policy a ~ N(μ(s), σ(s)) for each action, linear in the features x, μ = u_μ·x and σ = exp(u_σ·x);
one critic. The gradients are scaled by σ², as there after Williams (1992), so that none grows as σ shrinks:

    δ = R + γ^n v·x' − v·x              e_v ← γ^n λ e_v + x,    v ← v + α_v δ e_v
    e_μ ← γ^n λ e_μ + (a − μ) x         u_μ ← u_μ + α_u δ e_μ
    e_σ ← γ^n λ e_σ + ((a − μ)² − σ²) x / σ_0²    u_σ ← u_σ + α_u δ e_σ

σ_0 stands where the policy began. μ stays in 0..1 and σ within its bounds; δ is bounded, and the weights, so
that no reward makes a jump or drives a parameter so far beyond its bound that it could not come back soon.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bentod.assist.timescales.dice import Dice
from bentod.assist.timescales.memories import Memory, checked
from bentod.contracts import Features

MOST_DELTA = 10.0
"""Of |δ|; the price of a toggle is about 1."""

FARTHEST = 1.5
"""How far all active features together may move a parameter from where it began."""

LARGEST = 1e3
"""Of the critic's weights and of a decision's reward, either way."""


@dataclass(frozen=True, slots=True)
class ActorCriticSettings:
    """Step sizes are divided by the number of active features."""

    critic: float = 0.3
    actor: float = 0.3
    lam: float = 0.5
    sigma: float = 0.2  # of the policy at first
    least: float = 0.05
    most: float = 0.3


class ActorCritic:
    """Chooses several numbers between 0 and 1."""

    def __init__(
        self,
        features: int,
        active: int,
        first: tuple[float, ...],
        seed: int,
        settings: ActorCriticSettings = ActorCriticSettings(),
    ) -> None:
        """`first`: what is chosen before anything is learned, shape (actions,), 0..1."""
        self.settings = settings
        self._first = np.array(first, dtype=np.float64)
        self._active = active
        self._dice = Dice(seed)
        self._taught = False
        shape = (2, len(first), features)  # of μ, then of ln σ
        self.u: NDArray[np.float64] = np.zeros(shape)
        self.v: NDArray[np.float64] = np.zeros(features)
        self._eu: NDArray[np.float64] = np.zeros(shape)
        self._ev: NDArray[np.float64] = np.zeros(features)
        self._value: float | None = None

    def policy(self, features: Features) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """μ and σ of each action, shape (actions,) each."""
        offset = self.u[:, :, features].sum(axis=2)
        mu = np.clip(self._first + offset[0], 0.0, 1.0)
        sigma = np.clip(self.settings.sigma * np.exp(offset[1]), self.settings.least, self.settings.most)
        return mu, sigma

    def step(self, features: Features, reward: float, discount: float) -> NDArray[np.float64]:
        """The next actions, after `reward` for the last ones, whose ticks are worth `discount` = γ^n."""
        reward = min(max(reward, -LARGEST), LARGEST)
        self._taught = self._taught or reward != 0
        if self._value is not None:
            self._learn(reward + discount * float(self.v[features].sum()) - self._value)
        self._value = float(self.v[features].sum())
        mu, sigma = self.policy(features)
        tried = np.array([self._dice.normal() for _ in mu])
        explored = mu + sigma * tried * self._taught
        self._remember(features, discount * self.settings.lam, explored - mu, sigma)
        actions: NDArray[np.float64] = np.clip(explored, 0.0, 1.0)
        return actions

    def cut(self) -> None:
        """What comes next has nothing to do with what came before."""
        self._eu[:] = 0.0
        self._ev[:] = 0.0
        self._value = None

    def memory(self) -> dict[str, NDArray[np.float64]]:
        """Copies of what was learned."""
        state = np.array([self._dice.thrown, float(self._taught)], dtype=np.float64)
        return {"u": self.u.copy(), "v": self.v.copy(), "state": state}

    def recall(self, memory: Memory) -> None:
        """Go on with it. Raises ValueError: it does not fit."""
        found = checked(memory, {"u": self.u.shape, "v": self.v.shape, "state": (2,)})
        self._dice.recall(float(found["state"][0]))
        self._taught = bool(found["state"][1])
        self.u, self.v = found["u"], found["v"]
        self._bound()
        self.cut()

    def _learn(self, delta: float) -> None:
        delta = min(max(delta, -MOST_DELTA), MOST_DELTA)
        self.v += self.settings.critic / self._active * delta * self._ev
        self.u += self.settings.actor / self._active * delta * self._eu
        self._bound()

    def _bound(self) -> None:
        each = FARTHEST / self._active
        np.clip(self.u, -each, each, out=self.u)
        np.clip(self.v, -LARGEST, LARGEST, out=self.v)

    def _remember(
        self, features: Features, decay: float, error: NDArray[np.float64], sigma: NDArray[np.float64]
    ) -> None:
        self._ev *= decay
        self._eu *= decay
        self._ev[features] += 1.0
        if self._taught:
            spread = (np.square(error) - np.square(sigma)) / self.settings.sigma**2
            self._eu[0][:, features] += error[:, None]
            self._eu[1][:, features] += spread[:, None]
