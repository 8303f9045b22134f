"""Descriptions of a few numbers, and two exact tests that assume no distribution."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

EXACT = 200_000
"""Up to so many rearrangements every one is looked at; beyond, so many are drawn."""

SEED = 20141
"""Of the draws: the same data give the same p value."""

CHUNK = 4096
"""Rearrangements looked at together."""


@dataclass(frozen=True, slots=True)
class Description:
    """Some numbers as the thesis' Table B.1 describes them."""

    n: int
    mean: float
    deviation: float  # sample standard deviation, n − 1; nan for a single number
    minimum: float
    minimum_count: int  # how often the minimum occurs
    maximum: float
    first: float  # in the order of time

    @property
    def error(self) -> float:
        """Standard error of the mean, the bars of thesis Figure 5.10."""
        return self.deviation / math.sqrt(self.n)


@dataclass(frozen=True, slots=True)
class Test:
    """What a permutation test found."""

    __test__ = False  # not one of pytest's

    difference: float  # mean of the second minus mean of the first
    p: float  # two-sided
    exact: bool  # every rearrangement was looked at
    n: int  # pairs, or numbers in both samples together


def describe(values: Sequence[float]) -> Description:
    """Describe at least one number, given in the order of time."""
    array = np.asarray(values, dtype=np.float64)
    deviation = float(array.std(ddof=1)) if len(array) > 1 else math.nan
    low = float(array.min())
    count = int((array == low).sum())
    return Description(
        len(array), float(array.mean()), deviation, low, count, float(array.max()), float(array[0])
    )


def paired(first: Sequence[float], second: Sequence[float]) -> Test:
    """Whether pairs differ: the mean of the differences under every choice of their signs.

    Fisher's randomisation test (The Design of Experiments, 1935, §21): if the conditions make no
    difference, each difference might as well have had the other sign. The smallest p that n pairs can
    give is 2^(1−n). Both have the same length, at least 1.
    """
    differences = np.asarray(second, dtype=np.float64) - np.asarray(first, dtype=np.float64)
    n = len(differences)
    exact = 2**n <= EXACT
    total = 2**n if exact else EXACT
    random = np.random.default_rng(SEED)
    extreme = 0
    for start in range(0, total, CHUNK):
        rows = np.arange(start, min(start + CHUNK, total))
        drawn = random.integers(0, 2, (len(rows), n))
        flips = (rows[:, None] >> np.arange(n)) & 1 if exact else drawn
        extreme += _as_extreme((1 - 2 * flips) @ differences, float(differences.sum()), differences)
    return Test(float(differences.mean()), _p(extreme, total, exact), exact, n)


def unpaired(first: Sequence[float], second: Sequence[float]) -> Test:
    """Whether two samples differ: the difference of their means under every way to divide the whole.

    Pitman's permutation test (J. R. Stat. Soc. Suppl. 4, 1937). Both have at least one number.
    """
    pooled = np.concatenate([np.asarray(first, dtype=np.float64), np.asarray(second, dtype=np.float64)])
    n, size = len(pooled), len(second)
    difference = float(np.mean(second) - np.mean(first))
    exact = math.comb(n, size) <= EXACT
    centred = pooled - pooled.mean()
    observed = float(centred[len(first) :].sum())  # grows with the difference of the means
    sums = _all_sums(centred, size) if exact else _drawn_sums(centred, size)
    extreme = _as_extreme(sums, observed, centred)
    return Test(difference, _p(extreme, len(sums), exact), exact, n)


def _all_sums(values: NDArray[np.float64], size: int) -> NDArray[np.float64]:
    chosen = np.array(list(combinations(range(len(values)), size)))
    sums: NDArray[np.float64] = values[chosen].sum(axis=1)
    return sums


def _drawn_sums(values: NDArray[np.float64], size: int) -> NDArray[np.float64]:
    random = np.random.default_rng(SEED)
    parts = []
    for start in range(0, EXACT, CHUNK):
        rows = np.tile(values, (min(CHUNK, EXACT - start), 1))
        parts.append(random.permuted(rows, axis=1)[:, :size].sum(axis=1))
    return np.concatenate(parts)


def _as_extreme(sums: NDArray[np.float64], observed: float, values: NDArray[np.float64]) -> int:
    """How many sums are as far from 0 as the observed one, but for the rounding of the sums."""
    rounding = 1e-12 * (1.0 + float(np.abs(values).sum()))
    return int((np.abs(sums) >= abs(observed) - rounding).sum())


def _p(extreme: int, total: int, exact: bool) -> float:
    """Drawn rearrangements do not hold the observed one, which is counted besides.

    Phipson and Smyth, Stat. Appl. Genet. Mol. Biol. 9, 2010, article 39.
    """
    return extreme / total if exact else (extreme + 1) / (total + 1)
