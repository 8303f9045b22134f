"""Tile coding: a point in the unit cube becomes a few active binary features out of many.

`tilings` grids of tiles lie over the cube, each displaced a little further than the one before (Sutton &
Barto 1998, section 8.3.2); a tile is `width` wide, in every dimension or as said for each. The displacements
are asymmetric (Parks & Militzer 1991): tiling i is shifted along dimension j by i·d_j / tilings of a tile,
where d is the sequence of odd numbers 1, 3, 5, … as in Sutton's tiles software, without those that share a
divisor with the number of tilings: with 100 tilings a shift of 5 would put five tilings on the same edge, and
the resolution along that dimension would be 20.

**Hashed**: a tile is hashed into `memory` features. With c the tile's integer coordinates in tiling i,

    feature = mix(i·K_0 + Σ_j c_j·K_{j+1} mod 2^64) mod memory,   K_m = mix((m + 1)·0x9E3779B97F4A7C15) | 1

where `mix` is the finaliser of SplitMix64 (Steele, Lea & Flood 2014). Learned weights mean nothing under
another hash, so this one never changes. Collisions: the active features are a *set*. Two tiles that fall on
the same feature activate it once, so the number of active features varies a little from point to point (100
tilings in 2,048: 97.6 on average) and is never more than the number of tilings.

**Exact** (`memory` 0): each tile has a feature of its own, and exactly `tilings` are active. Shifts are then
taken modulo a tile, so that a tiling reaches at most one tile beyond the cube, and has

    ⌈1 / width⌉ + 1

tiles along a dimension, whatever its shift. This is how the thesis (4.5.2) counts: 3 tilings of width 0.5 and
6 of width 0.17 are 3·3 + 6·7 = 51 features for one signal, 3·3² + 6·7² = 321 for two. Features are in the
order of tilings, then of coordinates, the last one running fastest; some at the far edge may never be active.
"""

import math
from collections.abc import Sequence
from itertools import count, islice

import numpy as np
from numpy.typing import NDArray

from bentod.contracts import Features

LARGEST = 1 << 24
"""Features that a coding may have."""

_GOLDEN = 0x9E3779B97F4A7C15
_SHIFTS = (np.uint64(30), np.uint64(27), np.uint64(31))
_FACTORS = (np.uint64(0xBF58476D1CE4E5B9), np.uint64(0x94D049BB133111EB))
_ROUNDING = 1e-9  # 21 / 0.7 is a little above 30 in floating point; 1.0 must not get a tile for it


class TileCoder:
    """Tilings over the unit cube of `dimensions` dimensions; stateless once built."""

    def __init__(
        self,
        dimensions: int,
        tilings: int = 100,
        width: float | Sequence[float] = 1.0,
        memory: int = 2048,
    ) -> None:
        widths = [width] * dimensions if isinstance(width, int | float) else list(width)
        if min(dimensions, tilings, memory + 1) < 1 or not all(0 < w <= 1 for w in widths):
            raise ValueError(
                "Tile coding needs at least 1 dimension and 1 tiling, memory of at least 0, and a width "
                f"above 0 up to 1, not {dimensions}, {tilings}, {memory} and {width}."
            )
        if len(widths) != dimensions:
            raise ValueError(f"{dimensions} dimensions need as many widths of a tile, not {len(widths)}.")
        self.dimensions = dimensions
        self.tilings = tilings
        self.widths = tuple(float(w) for w in widths)
        self.memory = memory
        self._scale = np.array([tilings / w for w in widths])
        self._last = np.ceil(self._scale - _ROUNDING) - 1
        tiling = np.arange(tilings, dtype=np.int64)
        self._shifts = np.outer(tiling, _displacements(dimensions, tilings))
        keys = _mix(np.arange(1, dimensions + 2, dtype=np.uint64) * np.uint64(_GOLDEN)) | np.uint64(1)
        self._salts = tiling.astype(np.uint64) * keys[0]
        self._keys = keys[1:]
        self._modulus = np.uint64(memory)
        self.size = memory or self._lay_out(tiling)
        """Number of features."""

    def encode(self, inputs: Sequence[float]) -> Features:
        """Indices of the active features, 0..size − 1. `inputs`: 0..1, one a dimension, clamped.

        1.0 lies in the same tiles as the values just below it.

        Raises:
            ValueError: an input is not a finite number, or there are too few or too many of them.
        """
        if len(inputs) != self.dimensions or not all(map(math.isfinite, inputs)):
            raise ValueError(f"Tile coding takes {self.dimensions} finite numbers, not {list(inputs)}.")
        return unique(self.indices(np.array([inputs], dtype=np.float64)).ravel())

    def indices(self, points: NDArray[np.float64]) -> NDArray[np.intp]:
        """The feature of each tiling, for several points at once, shape (points, tilings); may repeat.

        `points`: finite, shape (points, dimensions), clamped to 0..1.
        """
        # Not np.clip, which takes three times as long for so few.
        inside = np.maximum(np.minimum(points, 1.0), 0.0)
        finest = np.minimum(inside * self._scale, self._last).astype(np.int64)
        coordinates = finest[:, None, :] + self._shifts
        coordinates //= self.tilings
        if not self.memory:
            features: NDArray[np.intp] = (coordinates @ self._strides + self._first).astype(np.intp)
            return features
        hashed = coordinates.view(np.uint64) @ self._keys
        hashed += self._salts
        _mix(hashed)
        hashed %= self._modulus
        features = hashed.astype(np.intp)
        return features

    def _lay_out(self, tiling: NDArray[np.int64]) -> int:
        """Give each tile a feature; how many there are."""
        self._shifts %= self.tilings
        counts = [math.ceil(1 / w - _ROUNDING) + 1 for w in self.widths]
        tiles = math.prod(counts)
        if tiles * self.tilings > LARGEST:
            raise ValueError(
                f"{self.tilings} tilings of {tiles} tiles are more than {LARGEST} features: give them memory."
            )
        strides = [math.prod(counts[j + 1 :]) for j in range(self.dimensions)]
        self._strides = np.array(strides, dtype=np.int64)
        self._first = tiling * tiles
        return tiles * self.tilings


def _displacements(dimensions: int, tilings: int) -> list[int]:
    odd = (d for d in count(1, 2) if math.gcd(d, tilings) == 1)
    return list(islice(odd, dimensions))


def _mix(z: NDArray[np.uint64]) -> NDArray[np.uint64]:
    """In place, because new memory costs more than the arithmetic."""
    z ^= z >> _SHIFTS[0]
    z *= _FACTORS[0]
    z ^= z >> _SHIFTS[1]
    z *= _FACTORS[1]
    z ^= z >> _SHIFTS[2]
    return z


def unique(indices: NDArray[np.intp]) -> Features:
    """Like `np.unique`, which takes several times as long for so few; sorts `indices` in place."""
    indices.sort()
    first = np.empty(len(indices), dtype=np.bool_)
    first[0] = True
    np.not_equal(indices[1:], indices[:-1], out=first[1:])
    return indices[first]
