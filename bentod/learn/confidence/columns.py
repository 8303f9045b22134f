"""What is estimated for many GVFs at once: arrays with one column a GVF, kept, put back, cut and grown."""

from collections.abc import Mapping
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Column: TypeAlias = tuple[tuple[int, ...], float]
"""The shape before the last axis, which is the GVFs, and the value that all begins with."""


class Columns:
    """The arrays of an estimator of `count` GVFs: its `own` have a column for each, `shared` have none."""

    def __init__(
        self,
        count: int,
        own: Mapping[str, Column],
        shared: Mapping[str, NDArray[np.float64]] | None = None,
    ) -> None:
        self._starts = {name: start for name, (_, start) in own.items()}
        self._own = {name: np.full((*shape, count), start) for name, (shape, start) in own.items()}
        self._shared = dict(shared or {})
        self.count = count
        """Number of GVFs."""

    @property
    def own(self) -> frozenset[str]:
        """The entries of `memory` that have a column for each GVF."""
        return frozenset(self._own)

    def memory(self) -> dict[str, NDArray[np.float64]]:
        """Copies of all that has been learned, by name."""
        return {name: array.copy() for name, array in (self._own | self._shared).items()}

    def recall(self, memory: Mapping[str, NDArray[np.float64]]) -> None:
        """Become what `memory` told.

        Raises:
            ValueError: it is not that of such an estimator for as many GVFs; nothing has changed then.
        """
        check(memory, {name: array.shape for name, array in (self._own | self._shared).items()})
        if spoilt := [name for name in self._shared if not np.isfinite(memory[name]).all()]:
            raise ValueError(f"'{spoilt[0]}' must be finite.")
        for kept in (self._own, self._shared):
            for name, array in kept.items():
                array[...] = memory[name]

    def take(self, columns: NDArray[np.intp]) -> None:
        """Go on with these GVFs only, in this order."""
        self._own = {name: array[..., columns].copy() for name, array in self._own.items()}
        self.count = len(columns)

    def grow(self, count: int) -> None:
        """Take on `count` more GVFs, of which nothing is known, behind the others."""
        self._own = {name: extended(array, count, self._starts[name]) for name, array in self._own.items()}
        self.count += count

    def forget(self, columns: NDArray[np.intp]) -> None:
        """Begin anew with these GVFs, e.g. because their learners did."""
        for name, array in self._own.items():
            array[..., columns] = self._starts[name]


def extended(array: NDArray[np.float64], count: int, start: float) -> NDArray[np.float64]:
    """The array with `count` more columns that hold `start`."""
    return np.concatenate([array, np.full((*array.shape[:-1], count), start)], axis=-1)


def check(memory: Mapping[str, NDArray[np.float64]], shapes: Mapping[str, tuple[int, ...]]) -> None:
    """Raises ValueError: other names than those of `shapes`, or an array of another shape."""
    if memory.keys() != shapes.keys():
        raise ValueError(f"This estimator remembers {sorted(shapes)}, but was told {sorted(memory)}.")
    for name, shape in shapes.items():
        if memory[name].shape != shape:
            raise ValueError(f"'{name}' has the shape {memory[name].shape}, but should have {shape}.")
