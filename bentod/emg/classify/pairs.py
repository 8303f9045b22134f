"""Support vector machines, one for each pair of classes, and how pairs become probabilities; NumPy only."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from bentod.emg.classify.rows import Arrays, Codes, Scale, fitting, products, softmax, squares, wanted
from bentod.emg.recognition import Table


def coupled(decisions: Table, count: int, slope: float) -> Table:
    """Probabilities of `count` classes, shape (rows, count), from decisions about each pair of them.

    `decisions`: shape (rows, pairs), pairs in the order 0:1, 0:2, … 1:2, …; above 0 for the first of a pair.
    The logistic of `slope` times a decision is the chance of the first within its pair, and a class is as
    likely as the product of its chances. So a class counts for little once one other beats it clearly,
    however clearly it beats the rest, which is what a vote among pairs is for, but without its steps.
    """
    inclined = slope * decisions
    first = -np.logaddexp(0.0, -inclined)  # logarithm of the chance of the first of a pair
    chances = np.concatenate([first, first - inclined], axis=1)
    return softmax(products(_takes_part(count), chances))


@cache
def _takes_part(count: int) -> Table:
    """1 where a class is the first of a pair, then where it is the second; shape (count, 2 · pairs)."""
    members = np.stack(np.triu_indices(count, 1)).reshape(-1)
    part: Table = (np.arange(count)[:, None] == members).astype(np.float64)
    return part


_SLOPES = 2.0 ** np.arange(-4.0, 6.25, 0.25)


def calibrated(decisions: Table, codes: Codes, count: int) -> float:
    """The slope with which decisions about rows that were held out tell best how sure they are.

    The least cross entropy, against targets that are not quite sure themselves (Platt 1999, 2.2): else what
    happens to be told apart without an error would never be doubted again.
    """
    rows = np.bincount(codes, minlength=count)[codes]
    doubt = 1.0 / (rows + 2.0)
    targets = np.repeat((doubt / (count - 1))[:, None], count, axis=1)
    targets[np.arange(len(codes)), codes] = 1.0 - doubt
    losses = [
        -np.sum(targets * np.log(np.maximum(coupled(decisions, count, slope), 1e-300))) for slope in _SLOPES
    ]
    return float(_SLOPES[int(np.argmin(losses))])


@dataclass(frozen=True, slots=True)
class Machine:
    """The decisions: linear in the columns, or in likenesses to support vectors."""

    scale: Scale
    weights: NDArray[np.float64]  # shape (pairs, columns) if linear, else (pairs, vectors)
    bias: NDArray[np.float64]  # shape (pairs,)
    vectors: Table | None = None  # standardised, shape (vectors, columns); None: linear
    gamma: float = 0.0  # of the likeness exp(-gamma |x - v|²)

    def decisions(self, table: Table) -> Table:
        """About each pair, shape (rows, pairs); above 0 for the first of it."""
        rows = self.scale.scaled(table)
        if self.vectors is not None:
            apart = [squares(self.vectors, row) for row in rows]
            rows = np.exp(-self.gamma * np.array(apart).reshape(len(rows), len(self.vectors)))
        return products(self.weights, rows) + self.bias

    def arrays(self) -> dict[str, NDArray[np.float64]]:
        """As they are kept in a model file."""
        kept = {**self.scale.arrays(), "weights": self.weights, "bias": self.bias}
        if self.vectors is None:
            return kept
        return {**kept, "vectors": self.vectors, "gamma": np.array([self.gamma])}


class Pairs:
    """Probabilities from a machine for each pair of classes."""

    def __init__(self, labels: tuple[str, ...], machine: Machine, slope: float) -> None:
        """`slope`: see `coupled`."""
        self.labels = labels
        self._machine, self._slope = machine, slope

    def decisions(self, table: Table) -> Table:
        """See `Machine.decisions`."""
        return self._machine.decisions(table)

    def probabilities(self, table: Table) -> Table:
        """See `Classifier`."""
        return coupled(self.decisions(table), len(self.labels), self._slope)

    def arrays(self) -> Mapping[str, NDArray[np.float64]]:
        """Scale, weights, support vectors and slope."""
        return {**self._machine.arrays(), "slope": np.array([self._slope])}


def restore_linear(labels: tuple[str, ...], arrays: Arrays) -> Pairs:
    """What `arrays` told. Raises SnapshotError: it is not that of such a classifier."""
    weights, bias, slope = _common(labels, arrays)
    scale = Scale.restored(arrays)
    fitting("mean", scale.mean, (weights.shape[1],))
    return Pairs(labels, Machine(scale, weights, bias), slope)


def restore_kernel(labels: tuple[str, ...], arrays: Arrays) -> Pairs:
    """What `arrays` told. Raises SnapshotError: it is not that of such a classifier."""
    weights, bias, slope = _common(labels, arrays)
    vectors, gamma = wanted(arrays, vectors=2, gamma=1)
    scale = Scale.restored(arrays)
    fitting("mean", scale.mean, (vectors.shape[1],))
    fitting("weights", weights, (len(bias), len(vectors)))
    fitting("gamma", gamma, (1,))
    return Pairs(labels, Machine(scale, weights, bias, vectors, float(gamma[0])), slope)


def _common(
    labels: tuple[str, ...], arrays: Arrays
) -> tuple[NDArray[np.float64], NDArray[np.float64], float]:
    weights, bias, slope = wanted(arrays, weights=2, bias=1, slope=1)
    pairs = len(labels) * (len(labels) - 1) // 2
    fitting("weights", weights, (pairs, weights.shape[1]))
    fitting("bias", bias, (pairs,))
    fitting("slope", slope, (1,))
    return weights, bias, float(slope[0])
