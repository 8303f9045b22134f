"""What the learning engine is measured with: many predictions from smoothly changing tile codes."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import cycle

import numpy as np
from numpy.typing import NDArray

from bentod.contracts import Features
from bentod.learn.group import Group
from bentod.learn.kernel import Kernel
from bentod.learn.lazy import Real

LAM = 0.9
STEP_SIZE = 0.1  # α times the number of active features


@dataclass(frozen=True, slots=True)
class Workload:
    """How many of what; the GVFs are all pairs of a cumulant and a γ."""

    name: str
    cumulants: int
    gammas: Sequence[float]
    features: int
    active: int  # one of them a bias
    changing: int  # features a step

    @property
    def gvfs(self) -> int:
        """How many predictions."""
        return self.cumulants * len(self.gammas)

    @property
    def alpha(self) -> float:
        """The step size of one weight."""
        return STEP_SIZE / self.active

    def stream(self, steps: int = 400) -> "Stream":
        """Tilings that lie side by side; at each step `changing` of them, at random, move to another tile."""
        rng = np.random.default_rng(6)
        edges = np.linspace(0, self.features - 1, self.active).astype(np.intp)
        starts, widths = edges[:-1], np.diff(edges)
        tiles = rng.integers(0, widths)
        phis = []
        for _ in range(steps):
            moved = rng.choice(len(widths), self.changing, replace=False)
            tiles[moved] = (tiles[moved] + rng.integers(1, widths[moved])) % widths[moved]
            phis.append(np.append(starts + tiles, self.features - 1))
        phases = rng.uniform(0, 2 * np.pi, self.cumulants)
        speeds = rng.uniform(0.01, 0.3, self.cumulants)
        signals = np.sin(np.arange(steps)[:, None] * speeds + phases)
        return Stream(phis, signals + 0.1 * rng.normal(size=signals.shape))


@dataclass(frozen=True, slots=True)
class Stream:
    """Active features and cumulants, step by step."""

    phis: Sequence[Features]
    signals: NDArray[np.float64]  # shape (steps, cumulants)

    def __iter__(self) -> Iterator[tuple[Features, NDArray[np.float64]]]:
        """For ever."""
        return cycle(zip(self.phis, self.signals, strict=True))


NEXTING = Workload("nexting", 540, (0.0, 0.8, 0.95, 0.9875), 6065, 457, 131)
"""After Modayil, White and Sutton, "Multi-timescale nexting in a reinforcement learning robot"."""

MANY = Workload("many", 5000, (0.0, 0.8, 0.95, 0.9875), 2049, 101, 23)
ARM = Workload("arm", 40, (0.95,), 2049, 101, 23)
ARM_AT_FOUR = Workload("arm, 4 timescales", 10, (0.5, 0.8, 0.95, 0.99), 2049, 101, 23)


class Engine:
    """Groups over one array of weights, as the horde has them."""

    def __init__(self, load: Workload, kernel: Kernel, dtype: type[Real] = np.float64) -> None:
        m = load.cumulants
        self.weights = np.zeros((load.features, load.gvfs), dtype)
        self.groups = [
            Group(self.weights[:, m * g : m * (g + 1)], np.zeros(m), "true_online", load.alpha, kernel)
            for g in range(len(load.gammas))
        ]
        self._gammas = load.gammas
        self._lefts = [1 - gamma for gamma in load.gammas]

    def step(self, phi: Features, signals: NDArray[np.float64]) -> None:
        """All predictions."""
        for group, gamma, left in zip(self.groups, self._gammas, self._lefts, strict=True):
            group.step(phi, left * signals, gamma, LAM)
