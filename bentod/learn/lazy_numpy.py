"""One step of `bentod.learn.lazy`, in numpy: the same operations in the same order as in kernel.c."""

import numpy as np
from numpy.typing import NDArray

from bentod.contracts import Features, Vector
from bentod.learn.lazy import BEGIN, EPOCH, FORGET, ON, REACH, Lazy, Real, Step

_GREATEST = float(np.finfo(np.float64).max)

_FITS = 1 << 19
"""Bytes of the active rows of one block of GVFs: what is read, is still in the cache when it is written."""


class NumpyKernel:
    """Always there. Sums go row by row, so that the compiled kernel can give the same to the last bit."""

    name = "numpy"

    def bind(self, lazy: Lazy) -> "NumpySteps":
        """As in `Kernel`."""
        return NumpySteps(lazy)


class NumpySteps:
    """The steps of one group."""

    def __init__(self, lazy: Lazy) -> None:
        self._lazy = lazy

    def step(self, step: Step) -> bool:
        """As in `Steps`."""
        lazy = self._lazy
        rows = lazy.rows[: step.active]
        if rows.size and (rows[0] < 0 or rows[-1] >= len(lazy.c) or (rows[1:] <= rows[:-1]).any()):
            return False
        with np.errstate(over="ignore", invalid="ignore", under="ignore"):
            if step.swept > step.sweep:
                _fold(lazy, _stale(lazy, step.sweep, step.swept), step.kept)
            owing = lazy.stale[rows] != 0
            if owing.any():
                _fold(lazy, rows[owing], step.kept)
            _learn(lazy, step, rows)
            _check(lazy, step)
        lazy.active[lazy.before[: step.before]] = 0
        lazy.active[rows] = 1
        lazy.before[: step.active] = rows
        return True

    def fold(self, start: int, stop: int, kept: float) -> None:
        """As in `Steps`."""
        with np.errstate(over="ignore", invalid="ignore", under="ignore"):
            _fold(self._lazy, _stale(self._lazy, start, stop), kept)


def _learn(lazy: Lazy, step: Step, rows: Features) -> None:
    c = _total(lazy.c[rows])
    overlap = float(np.count_nonzero(lazy.active[rows]))
    folded, share, after = _turn(lazy, step, rows, c)
    s = step.s_next if step.turn == ON else 1.0
    growth = (1 - lazy.alpha * s * after) / s if lazy.online else 1 / s
    m = lazy.weights.shape[1]
    width = max(_FITS // (lazy.weights.itemsize * max(step.active, 1)), 32)
    for start in range(0, m, width):
        _block(lazy, step, rows, slice(start, start + width), (c, overlap, growth), (folded, share))
    lazy.c[rows] += growth


def _turn(lazy: Lazy, step: Step, rows: Features, c: float) -> tuple[Features, Vector, float]:
    """Take c through a turn: the rows that are folded now, what each has of D, and Σ c of the active rows."""
    if step.turn == EPOCH:
        share = lazy.c[rows]
        lazy.stale.fill(1)
        _renew(lazy, rows, step.s_next)
        return rows, share, _total(lazy.c[rows])
    if step.turn == FORGET:
        before = lazy.before[: step.before]
        share = lazy.c[before]
        lazy.c[before] = 0
        return before, share, 0.0
    return rows, lazy.c[rows], c


def _block(
    lazy: Lazy,
    step: Step,
    rows: Features,
    part: slice,
    scalars: tuple[float, float, float],
    fold: tuple[Features, Vector],
) -> None:
    weights = lazy.weights[:, part]
    found = weights[rows]
    c, overlap, growth = scalars
    if step.turn == BEGIN:
        lazy.v[part] = lazy.v_old[part] = _sum(found)
        lazy.delta[part] = np.nan
        return
    _teach(lazy, step, part, _sum(found), c, overlap)
    if step.turn != ON:
        _end(lazy, step, weights, part, *fold)
        found = weights[rows]
    if step.turn == ON or (lazy.online and step.s_next != 0):
        found -= _less(lazy, part, growth).astype(weights.dtype, copy=False)
        weights[rows] = found


def _teach(lazy: Lazy, step: Step, part: slice, summed: NDArray[Real], c: float, overlap: float) -> None:
    """δ, D and the values of φ_{t+1}."""
    v, v_old, cumulants = lazy.v[part], lazy.v_old[part], lazy.cumulants[part]
    raw = summed + c * lazy.d[part]
    change = v - v_old if lazy.online else np.zeros(1)
    arrived = raw + lazy.alpha * change * overlap if lazy.online else raw
    delta = cumulants + step.gamma * arrived - v
    taught = np.isfinite(cumulants)
    all_taught = bool(taught.all())
    error = delta if all_taught else np.where(taught, delta, 0.0)
    move = lazy.alpha * step.s * (error + change if lazy.online else error)
    lazy.d[part] += move
    lazy.v[part] = raw + c * move
    lazy.v_old[part] = lazy.v[part] if step.s_next == 0 else arrived
    lazy.delta[part] = delta if all_taught else np.where(taught, delta, np.nan)
    size = np.abs(cumulants) if all_taught else np.where(taught, np.abs(cumulants), 0.0)
    lazy.peak[part] = np.maximum(lazy.peak[part], size)


def _less(lazy: Lazy, part: slice, growth: float) -> Vector:
    """What the active rows give up: what the growth of c adds, and the correction of the next step."""
    less = growth * lazy.d[part]
    if lazy.online:
        less += lazy.alpha * (lazy.v[part] - lazy.v_old[part])
    return less


def _end(
    lazy: Lazy, step: Step, weights: NDArray[Real], part: slice, folded: Features, share: Vector
) -> None:
    """D of an epoch ends: into the rows `folded`, and kept for the others."""
    owing = share != 0 if step.turn == EPOCH else np.ones(len(share), np.bool_)
    weights[folded[owing]] += np.outer(share[owing], lazy.d[part]).astype(weights.dtype, copy=False)
    if step.turn == EPOCH:
        lazy.d_old[part] = lazy.d[part]
    lazy.d[part] = 0


def _check(lazy: Lazy, step: Step) -> None:
    """GVFs that are not finite or explode begin again."""
    bound = REACH * (step.active * lazy.base + step.horizon * lazy.peak)
    fine = np.abs(lazy.v) <= np.minimum(bound, _GREATEST)
    if fine.all():
        return
    broken = np.flatnonzero(~fine)
    lazy.weights[:, broken] = lazy.initial[broken]
    lazy.d[broken] = lazy.d_old[broken] = 0
    lazy.v[broken] = lazy.v_old[broken] = step.active * lazy.initial[broken]
    lazy.delta[broken] = np.nan
    lazy.resets[broken] += 1


def _stale(lazy: Lazy, start: int, stop: int) -> Features:
    return start + lazy.stale[start:stop].nonzero()[0]


def _fold(lazy: Lazy, rows: Features, kept: float) -> None:
    c = lazy.c[rows]
    owing = c != 0
    if owing.any():
        paid = np.outer(c[owing], lazy.d_old)
        lazy.weights[rows[owing]] += paid.astype(lazy.weights.dtype, copy=False)
    _renew(lazy, rows, kept)


def _renew(lazy: Lazy, rows: Features, kept: float) -> None:
    """Rescale c into the present epoch."""
    now = lazy.c[rows] * kept
    lazy.c[rows] = np.where(np.abs(now) < lazy.negligible, 0.0, now)
    lazy.stale[rows] = 0


def _total(c: Vector) -> float:
    """One after another; `sum` goes by pairs."""
    return float(np.add.accumulate(c)[-1]) if len(c) else 0.0


def _sum(found: NDArray[Real]) -> NDArray[Real]:
    """Row by row; a single column would be summed by pairs."""
    if found.shape[1] == 1 and len(found):
        found = np.add.accumulate(found, axis=0)[-1:]
    summed: NDArray[Real] = np.add.reduce(found, axis=0)
    return summed
