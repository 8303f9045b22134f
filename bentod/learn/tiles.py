"""Tile coding: a point in the unit cube becomes a few active binary features out of many.

`tilings` grids of tiles `width` wide lie over the cube, each displaced a little further than the one before
(Sutton & Barto 1998, section 8.3.2). The displacements are asymmetric (Parks & Militzer 1991): tiling i is
shifted along dimension j by i·d_j / tilings of a tile, where d is the sequence of odd numbers 1, 3, 5, … as
in Sutton's tiles software, without those that share a divisor with the number of tilings: with 100 tilings
a shift of 5 would put five tilings on the same edge, and the resolution along that dimension would be 20.

A tile is hashed into `memory` features. With c the tile's integer coordinates in tiling i,

    feature = mix(i·K_0 + Σ_j c_j·K_{j+1} mod 2^64) mod memory,   K_m = mix((m + 1)·0x9E3779B97F4A7C15) | 1

where `mix` is the finaliser of SplitMix64 (Steele, Lea & Flood 2014). Learned weights mean nothing under
another hash, so this one never changes.

Collisions: the active features are a *set*. Two tiles that fall on the same feature activate it once, so the
number of active features varies a little from point to point (100 tilings in 2,048: 97.6 on average) and is
never more than the number of tilings.
"""

import math
from collections.abc import Sequence
from itertools import count, islice

import numpy as np
from numpy.typing import NDArray

from bentod.contracts import Features

_GOLDEN = 0x9E3779B97F4A7C15
_ROUNDING = 1e-9  # 21 / 0.7 is a little above 30 in floating point; 1.0 must not get a tile for it


class TileCoder:
    """Tilings over the unit cube of `dimensions` dimensions; stateless once built."""

    def __init__(self, dimensions: int, tilings: int = 100, width: float = 1.0, memory: int = 2048) -> None:
        if min(dimensions, tilings, memory) < 1 or not 0 < width <= 1:
            raise ValueError(
                "Tile coding needs at least 1 dimension, tiling and feature, and a width above 0 up to 1, "
                f"not {dimensions}, {tilings}, {memory} and {width}."
            )
        self.dimensions = dimensions
        self.tilings = tilings
        self.memory = memory
        self._scale = tilings / width
        self._last = math.ceil(self._scale - _ROUNDING) - 1
        tiling = np.arange(tilings, dtype=np.int64)
        self._shifts = np.outer(tiling, _displacements(dimensions, tilings))
        keys = _mix(np.arange(1, dimensions + 2, dtype=np.uint64) * np.uint64(_GOLDEN)) | np.uint64(1)
        self._salts = tiling.astype(np.uint64) * keys[0]
        self._keys = keys[1:]

    def encode(self, inputs: Sequence[float]) -> Features:
        """Indices of the active features, 0..memory − 1. `inputs`: 0..1, one a dimension, clamped.

        1.0 lies in the same tiles as the values just below it.

        Raises:
            ValueError: an input is not a finite number, or there are too few or too many of them.
        """
        if len(inputs) != self.dimensions or not all(map(math.isfinite, inputs)):
            raise ValueError(f"Tile coding takes {self.dimensions} finite numbers, not {list(inputs)}.")
        steps = [min(int(max(x, 0.0) * self._scale), self._last) if x < 1 else self._last for x in inputs]
        coordinates = (np.array(steps, dtype=np.int64) + self._shifts) // self.tilings
        hashed = _mix(coordinates.view(np.uint64) @ self._keys + self._salts)
        return _unique((hashed % np.uint64(self.memory)).astype(np.intp))


def _displacements(dimensions: int, tilings: int) -> list[int]:
    odd = (d for d in count(1, 2) if math.gcd(d, tilings) == 1)
    return list(islice(odd, dimensions))


def _mix(z: NDArray[np.uint64]) -> NDArray[np.uint64]:
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return z ^ (z >> np.uint64(31))


def _unique(indices: NDArray[np.intp]) -> Features:
    """Like `np.unique`, which takes several times as long for so few."""
    indices.sort()
    first = np.empty(len(indices), dtype=np.bool_)
    first[0] = True
    np.not_equal(indices[1:], indices[:-1], out=first[1:])
    return indices[first]
