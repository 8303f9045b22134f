"""Random journeys of a group of GVFs, and what a group makes of them."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from hypothesis import strategies as st
from numpy.typing import NDArray

from bentod.learn.group import Group
from bentod.learn.kernel import Kernel
from bentod.learn.lazy import Algorithm, Real
from tests.learn import oracles
from tests.learn.oracles import Vector

SIZE = 14
ALPHA = 0.06  # times all features: below 1
Precision = Literal["float64", "float32"]


@dataclass(frozen=True)
class Journeys:
    """One journey through features, with a cumulant for each GVF; a row of each arrives with its φ."""

    phis: NDArray[np.bool_]  # shape (steps, features)
    rewards: NDArray[np.float64]  # shape (steps, gvfs)
    gammas: NDArray[np.float64]
    lams: NDArray[np.float64]
    initial: Vector

    def of(self, gvf: int, first: int = 0, end: int | None = None) -> oracles.Journey:
        part = slice(first + 1, end)
        phis = list(self.phis[first:end].astype(np.float64))
        rewards, gammas, lams = self.rewards[part, gvf].tolist(), self.gammas[part], self.lams[part]
        return oracles.Journey(phis, rewards, gammas.tolist(), lams.tolist(), ALPHA)

    def oracle(self, algorithm: Algorithm, gvf: int) -> oracles.Travelled:
        rule = oracles.true_online if algorithm == "true_online" else oracles.accumulating_td
        return rule(self.of(gvf), np.full(SIZE, self.initial[gvf]))


@dataclass(frozen=True)
class Seen:
    """What a group told, step by step; the last w and z."""

    predictions: NDArray[np.float64]
    deltas: NDArray[np.float64]
    weights: NDArray[np.float64]
    trace: Vector


def random_journeys(seed: int, steps: int = 60, gvfs: int | None = None) -> Journeys:
    """γ and λ constant, or other ones in each state, 0 among them; some cumulants are not observed."""
    rng = np.random.default_rng(seed)
    m = gvfs or int(rng.integers(1, 8))
    phis = rng.random((steps, SIZE)) < rng.choice([0.1, 0.4])
    rewards = rng.normal(size=(steps, m))
    rewards[rng.random(rewards.shape) < rng.choice([0, 0.1])] = np.nan
    gamma = rng.choice([0, 1e-9, 0.01, 0.5, 0.9, 0.99])
    gammas = np.full(steps, gamma) if rng.random() < 0.6 else rng.choice([0, 0.3, 0.9, 0.99], steps)
    lams = np.full(steps, rng.choice([0, 0.3, 0.9, 1])) if rng.random() < 0.8 else rng.random(steps)
    return Journeys(phis, rewards, gammas, lams, rng.normal(size=m))


def new_group(journeys: Journeys, algorithm: Algorithm, kernel: Kernel, dtype: type[Real]) -> Group:
    """On some columns of a greater array, as in a horde."""
    m = len(journeys.initial)
    columns = np.full((SIZE, m + 3), 99, dtype)[:, 2 : 2 + m]
    return Group(columns, journeys.initial, algorithm, ALPHA, kernel)


def follow(group: Group, journeys: Journeys, first: int = 0, end: int | None = None) -> Seen:
    predictions, deltas = [], []
    for t in range(first, len(journeys.phis) if end is None else end):
        arrived = np.flatnonzero(journeys.phis[t])
        predictions.append(group.step(arrived, journeys.rewards[t], journeys.gammas[t], journeys.lams[t]))
        deltas.append(group.delta.copy())
    return Seen(np.array(predictions), np.array(deltas), group.weights_now(), group.trace_now())


seeds = st.integers(0, 2**32 - 1)
algorithms: st.SearchStrategy[Algorithm] = st.sampled_from(["td", "true_online"])
"""Accumulating traces, and those of True Online TD(λ)."""
