"""How wrong a GVF was in states like this one, and how lately: U and C of thesis 6.1.1.

    ζ_{t+1} = ζ_t + η (|δ_t|/Range − ζ_tᵀφ_t) φ_t + σ (ζ_0 − ζ_t)                                  (6.5)
    U = ζᵀφ,      C = 1 − U                                                                        (6.3)

**Normalised features.** (6.4) begins with ζ_0 = 1/k, k the number of active features, for U = 1. k varies
where tiles are hashed. So U is the *mean* of ζ over the active features here, ζ_0 = 1, and every active
feature moves by η times the error, which takes away the share η of it whatever k is. With a constant k this
is (6.5) with ζ/k for ζ and η/k for its η. It keeps U = 1 where nothing is known, and U = 0 possible
everywhere.

**Range.** Given, or the span of the cumulant so far. Of the cumulants that the learner learns from, scaled
if they are: a learner that always says the same, anything that the signal has been, has the error δ = R −
(1 − γ) p, and so at most one span of R, however it is scaled. Divided by the span of a signal θ with R = (1
− γ) θ (as in 6.1.1) it would be at most 1 − γ, 0.05 for a timescale of 20, and a learner that knows nothing
would look sure. |δ|/Range counts as 1 at most: more than uncertain is not to be had, and a span that is
still small must not spoil ζ. Until a signal has moved nothing is learned, and U stays 1.

**Laziness.** Let x = ζ − ζ_0, and e_t the error. (6.5) is x_{t+1} = (1 − σ) x_t + η e_t on active features,
and (1 − σ) x_t elsewhere. With the scale g_t = (1 − σ)^t, x = g y has y_{t+1} = y_t + η e_t / g_{t+1} on
active features, and nothing else changes: decay costs nothing. With the sum d_t = Σ_{i<t} η e_i / g_{i+1}
the rows y of active features are kept as y − d, which is constant for as long as they stay active. So a
tick costs

    k U = Σ_{active} x + k = g (Σ_{active} (y − d) + k d) + k,

one number a GVF, and the rows of those features that have just become active (− d) or inactive (+ d). The
sum over active rows is kept up to date; its rounding errors are in units of g and die with it. When g gets
small, a factor for each *row* notes what y has to be multiplied with when it is next used: no row is
touched for it.

**Defaults.** η = 0.1 averages over about ten ticks in a state, a third of a second. σ = 2.5e-5 halves what
is known of a state in 27,700 ticks, 15 minutes of use: a pause over a cup of coffee costs some confidence,
a change of task most of it. The two are at balance, C half of what it could be, where a state is visited
once in η/σ = 4,000 ticks (2 min).
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from bentod.contracts import Features
from bentod.learn.confidence.columns import Column
from bentod.learn.confidence.spans import Spans

_LEAST = {np.dtype(np.float64): 1e-100, np.dtype(np.float32): 1e-15}
"""The scale below which rows get a new one: so that y, at most 1/g, stays far from what its type can hold."""


class Uncertainty(Spans):
    """Of GVFs over `size` binary features. `ranges`: shape (m,), unit of the cumulant; NaN: its span so far.

    `eta`: η, the share of an error that one tick takes away. `sigma`: σ per tick, below η. `precision` is
    that of ζ, which takes as many weights as the GVFs have.
    """

    def __init__(
        self,
        size: int,
        ranges: NDArray[np.float64],
        eta: float = 0.1,
        sigma: float = 2.5e-5,
        precision: type[np.float64] | type[np.float32] = np.float64,
    ) -> None:
        if not 0 <= sigma < eta <= 1:
            raise ValueError(f"σ must be 0 or more, below η, and η up to 1, not σ = {sigma}, η = {eta}.")
        own: dict[str, Column] = {"sum": ((), 0.0), "drift": ((), 0.0)}
        shared = {"active": np.zeros(size), "factors": np.ones(size), "scale": np.ones(1)}
        super().__init__(ranges, own, shared)
        self._eta, self._sigma = eta, sigma
        self._rows: NDArray[np.floating] = np.zeros((size, len(ranges)), dtype=precision)
        self._features = np.empty(0, dtype=np.intp)

    def step(
        self,
        before: Features | None,
        delta: NDArray[np.float64],
        now: Features,
        cumulants: NDArray[np.float64],
        ticks: int = 1,
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """U and C at the features `now`, after δ of the transition to there from `before`; shape (m,) each.

        `before` None, or a δ that is NaN: nothing is learned from it, but what is known ages. `cumulants`:
        R as learned. `ticks`: since the last step; when they are several, R is of them all, and no measure
        of its span.
        """
        if ticks == 1:
            self.widen(cumulants)
        error: NDArray[np.float64] | None = None
        if before is not None:
            self._activate(before)
            error = self.share(delta) - self.value
        self._age(ticks)
        if error is not None:
            self._own["drift"] += np.where(np.isfinite(error), self._eta / self._scale * error, 0)
        self._activate(now)
        u = self.value
        return u, np.minimum(1 - u, 1)

    @property
    def value(self) -> NDArray[np.float64]:
        """U at the features of the last step, shape (m,); 1 before the first."""
        k = max(len(self._features), 1)
        u: NDArray[np.float64] = 1 + self._scale * (self._own["sum"] / k + self._own["drift"])
        return u

    @property
    def zeta(self) -> NDArray[np.float64]:
        """ζ, shape (size, m): 1 in the beginning."""
        y = self._rows * self._shared["factors"][:, None]
        y[self._features] += self._own["drift"]
        zeta: NDArray[np.float64] = 1 + self._scale * y
        return zeta

    @property
    def own(self) -> frozenset[str]:
        """The entries of `memory` that have a column for each GVF."""
        return super().own | {"rows"}

    def memory(self) -> dict[str, NDArray[np.float64]]:
        """Copies of all that has been learned, by name; `rows` is not ζ, but what it is made of."""
        return super().memory() | {"rows": self._rows.astype(np.float64)}

    def recall(self, memory: Mapping[str, NDArray[np.float64]]) -> None:
        """Become what `memory` told. Raises ValueError: it is not that of such an estimator."""
        rows = memory.get("rows", np.empty(0))
        if rows.shape != self._rows.shape:
            raise ValueError(f"'rows' has the shape {rows.shape}, but should have {self._rows.shape}.")
        super().recall({name: array for name, array in memory.items() if name != "rows"})
        self._rows = rows.astype(self._rows.dtype)
        self._features = np.flatnonzero(self._shared["active"])

    def take(self, columns: NDArray[np.intp]) -> None:
        """Go on with these GVFs only, in this order."""
        super().take(columns)
        self._rows = self._rows[:, columns].copy()

    def grow(self, count: int, ranges: NDArray[np.float64] | float = np.nan) -> None:
        """Take on `count` more GVFs with these ranges, behind the others."""
        super().grow(count, ranges)
        rows = np.zeros((len(self._rows), count), dtype=self._rows.dtype)
        self._rows = np.concatenate([self._rows, rows], axis=1)

    def forget(self, columns: NDArray[np.intp]) -> None:
        """Begin anew with these GVFs: nothing is certain any more."""
        super().forget(columns)
        self._rows[:, columns] = 0

    @property
    def _scale(self) -> float:
        return float(self._shared["scale"][0])

    def _age(self, ticks: int) -> None:
        scale = self._shared["scale"]
        scale *= (1 - self._sigma) ** ticks
        if scale[0] < _LEAST[self._rows.dtype]:
            self._rescale()

    def _rescale(self) -> None:
        """Begin with a scale of 1 again. Active rows, which have a common `drift`, are converted at once."""
        active = self._features
        self._activate(np.empty(0, dtype=np.intp))
        self._shared["factors"] *= self._scale
        self._own["sum"].fill(0)  # what rounding left in it is in the old units
        self._own["drift"].fill(0)
        self._shared["scale"].fill(1)
        self._activate(active)

    def _activate(self, features: Features) -> None:
        """Let these be the active features, whose rows are without `drift`, and the only ones in `sum`."""
        if features is self._features or np.array_equal(features, self._features):
            return
        active, factors, total = self._shared["active"], self._shared["factors"], self._own["sum"]
        drift = self._own["drift"].astype(self._rows.dtype)
        new = features[active[features] == 0]
        active[features] = 2
        old = self._features[active[self._features] == 1]
        rows = self._rows.take(old, axis=0)
        total -= rows.sum(axis=0, dtype=np.float64)
        rows += drift
        self._rows[old] = rows
        rows = self._rows.take(new, axis=0)
        if (factors[new] != 1).any():
            rows *= factors[new, None].astype(rows.dtype)
            factors[new] = 1
        rows -= drift
        total += rows.sum(axis=0, dtype=np.float64)
        self._rows[new] = rows
        active[old] = 0
        active[features] = 1
        self._features = features
