"""Rows of features: what training asks of them, their scale, and sums that do not depend on company."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bentod.emg.recognition import Table
from bentod.errors import ConfigError, SnapshotError

LEAST_ROWS = 2
"""Of a class: with one there is no scatter."""

_PIECE = 8192
"""Numbers in one product of vectors: OpenBLAS shares out more than 10 000 among threads."""

Arrays = Mapping[str, NDArray[np.float64]]
Codes = NDArray[np.intp]
"""Place of each row's label among the labels, shape (rows,)."""


def classes(table: Table, labels: Sequence[str]) -> tuple[tuple[str, ...], Codes]:
    """The labels that there are, in order of the alphabet, and which each row has.

    Raises:
        ConfigError: there are fewer than two, one has too few rows, or a number is not finite.
    """
    if table.ndim != 2 or len(table) != len(labels):
        raise ConfigError(f"{len(labels)} labels were given for a table of shape {table.shape}")
    bad = np.argwhere(~np.isfinite(table))
    if bad.size:
        raise ConfigError(f"column {bad[0][1]} of training row {bad[0][0]} is not a finite number")
    found, codes, counts = np.unique(np.asarray(labels, np.str_), return_inverse=True, return_counts=True)
    if len(found) < 2:
        told = f"'{found[0]}' is the only one" if len(found) else "there is none"
        raise ConfigError(f"a classifier needs rows of two classes or more; {told}")
    if counts.min() < LEAST_ROWS:
        few = found[int(np.argmin(counts))]
        raise ConfigError(f"the class '{few}' has {counts.min()} rows; it needs {LEAST_ROWS} or more")
    return tuple(str(label) for label in found), codes.astype(np.intp)


def products(matrix: Table, table: Table) -> Table:
    """Product of each row of `table`, (rows, n), with each of `matrix`, (m, n); shape (rows, m).

    One product of vectors after the other, each the same whatever else is computed: as a product of matrices
    BLAS would choose another order of sums, and threads, for several rows at once.
    """
    if matrix.shape[1] <= _PIECE:
        found: Table = np.vecdot(matrix, table[:, None, :])
        return found
    return products(matrix[:, :_PIECE], table[:, :_PIECE]) + products(matrix[:, _PIECE:], table[:, _PIECE:])


def squares(matrix: Table, row: NDArray[np.float64]) -> NDArray[np.float64]:
    """Square of the distance of `row`, shape (n,), from each row of `matrix`, shape (m,)."""
    apart = matrix - row
    found: NDArray[np.float64] = np.einsum("ij,ij->i", apart, apart)
    return found


def softmax(scores: Table) -> Table:
    """Shares that add up to 1, of the scores in each row."""
    # For the few classes of one window plain Python takes a third of the time that array operations take.
    return np.array([_shares(row) for row in scores.tolist()]).reshape(scores.shape)


def _shares(scores: list[float]) -> list[float]:
    most = max(scores)
    grown = [math.exp(score - most) for score in scores]
    total = sum(grown)
    return [share / total for share in grown]


@dataclass(frozen=True, slots=True)
class Scale:
    """Brings every column to mean 0 and standard deviation 1 in training; a constant one to 0."""

    mean: NDArray[np.float64]  # shape (columns,)
    deviation: NDArray[np.float64]  # shape (columns,), above 0

    @classmethod
    def of(cls, table: Table) -> "Scale":
        """That of training rows."""
        deviation = table.std(axis=0)
        mean = table.mean(axis=0)
        deviation[deviation <= 1e-12 * np.abs(mean)] = 1.0  # constant but for rounding
        return cls(mean, deviation)

    def scaled(self, rows: Table) -> Table:
        """Rows in standard deviations from the mean."""
        return (rows - self.mean) / self.deviation

    def arrays(self) -> dict[str, NDArray[np.float64]]:
        """As it is kept in a model file."""
        return {"mean": self.mean, "deviation": self.deviation}

    @classmethod
    def restored(cls, arrays: Arrays) -> "Scale":
        """From what `arrays` told. Raises SnapshotError: it is not that of a scale."""
        mean, deviation = wanted(arrays, mean=1, deviation=1)
        fitting("mean", mean, deviation.shape)
        if not (deviation > 0).all():
            raise SnapshotError("a deviation in it is not above 0")
        return cls(mean, deviation)


def wanted(arrays: Arrays, **dimensions: int) -> list[NDArray[np.float64]]:
    """The arrays of these names. Raises SnapshotError: one is missing, of other dimensions or not finite."""
    found = []
    for name, number in dimensions.items():
        array = arrays.get(name)
        if array is None:
            raise SnapshotError(f"the array '{name}' is missing")
        if array.ndim != number or array.dtype != np.float64 or not np.isfinite(array).all():
            raise SnapshotError(
                f"the array '{name}' is {array.dtype} of shape {array.shape}; "
                f"it must be finite float64 of {number} dimensions"
            )
        found.append(array)
    return found


def fitting(name: str, array: NDArray[np.float64], shape: tuple[int, ...]) -> None:
    """Raises SnapshotError: `array` is not of that shape."""
    if array.shape != shape:
        raise SnapshotError(f"the array '{name}' is of shape {array.shape}; what goes with it needs {shape}")
