"""The state of a lazy group told in full, w and z, which is the same for every kernel and type of weights."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from bentod.contracts import Vector
from bentod.learn.lazy import Lazy

_ROWS = 256  # folded at a time, so that a copy of many weights needs little besides
_PER_GVF = ("v", "v_old", "peak", "base")
PER_GVF = frozenset((*_PER_GVF, "weights", "resets"))
"""The entries of a group's memory whose last axis is its GVFs."""


def true_weights(lazy: Lazy, kept: float) -> NDArray[np.float64]:
    """w̃ + c D, with what stale rows owe since s was `kept`: a copy, shape (n, m)."""
    w = lazy.weights.astype(np.float64)
    owed = np.where(lazy.stale, lazy.c, 0)
    c = np.where(lazy.stale, lazy.c * kept, lazy.c)
    for start in range(0, len(c), _ROWS):
        part = slice(start, start + _ROWS)
        w[part] += np.outer(owed[part], lazy.d_old) + np.outer(c[part], lazy.d)
    return w


def true_trace(lazy: Lazy, s: float, kept: float) -> Vector:
    """The trace z = s c, shape (n,)."""
    z: Vector = s * np.where(lazy.stale, lazy.c * kept, lazy.c)
    return z


def written(
    lazy: Lazy, w: NDArray[np.float64], z: Vector, before: int, reach: tuple[float, float, bool]
) -> dict[str, NDArray[np.float64]]:
    """The memory of a group; `reach`: steps learned from, greatest γ, and whether φ_t is remembered."""
    memory: dict[str, NDArray[np.float64]] = {name: getattr(lazy, name).copy() for name in _PER_GVF}
    memory |= {"weights": w, "trace": z, "reach": np.array(reach, dtype=np.float64)}
    memory["features"] = lazy.before[:before].astype(np.float64)
    memory["resets"] = lazy.resets.astype(np.float64)
    return memory


def read(lazy: Lazy, memory: Mapping[str, NDArray[np.float64]]) -> tuple[int, Vector]:
    """Become what `memory` told, with s = 1 and D = 0; returns how many features are active, and `reach`.

    Raises:
        ValueError: it does not fit; nothing has changed.
    """
    n, m = lazy.weights.shape
    shapes = {"weights": (n, m), "trace": (n,), "reach": (3,), "resets": (m,)} | dict.fromkeys(_PER_GVF, (m,))
    for name, shape in shapes.items():
        if name not in memory or memory[name].shape != shape:
            found = memory[name].shape if name in memory else "none"
            raise ValueError(f"A group of this size has {name} of shape {shape}, not {found}.")
    features = _features(memory.get("features", np.array([-1.0])), n)
    lazy.weights[:] = memory["weights"]
    lazy.c[:] = memory["trace"]
    for name in (*_PER_GVF, "resets"):
        getattr(lazy, name)[:] = memory[name]
    for zero in (lazy.stale, lazy.active, lazy.d, lazy.d_old):
        zero.fill(0)
    lazy.delta.fill(np.nan)
    lazy.before[: len(features)] = features
    lazy.active[features] = 1
    return len(features), memory["reach"]


def take_over(lazy: Lazy, other: Lazy, mine: Sequence[int], theirs: Sequence[int]) -> None:
    """Become what `other` is, to the last bit: the GVFs `mine` as its `theirs`; of the rest nothing changes.

    Raises:
        ValueError: other features, another algorithm, α or type of weights.
    """
    same = (lazy.alpha, lazy.online, lazy.weights.dtype, lazy.c.shape)
    if same != (other.alpha, other.online, other.weights.dtype, other.c.shape):
        raise ValueError("A group goes on only where one was that learns likewise, from as many features.")
    for name in ("c", "stale", "active", "before"):
        getattr(lazy, name)[:] = getattr(other, name)
    for name in ("weights", "d", "d_old", "delta", "resets", *_PER_GVF):
        getattr(lazy, name)[..., list(mine)] = getattr(other, name)[..., list(theirs)]


def _features(told: NDArray[np.float64], n: int) -> NDArray[np.intp]:
    if told.ndim != 1 or not np.isfinite(told).all():
        raise ValueError("The active features of a group are a list of whole numbers.")
    features = told.astype(np.intp)
    if features.size and (features[0] < 0 or features[-1] >= n or (np.diff(features) <= 0).any()):
        raise ValueError(f"The active features of a group of this size ascend within 0..{n - 1}.")
    return features
