"""U and C of thesis 6.1.1 over features that are any real numbers, for the few GVFs that have such.

As in `bentod.learn.confidence.uncertainty`, but with every element touched in every tick, as (6.5) is
printed. Let x = ζ − ζ_0. No ζ_0 has ζ_0ᵀφ = 1 for all φ, so (6.4) is read as what it is for: U = 1 + xᵀφ,
and x = 0 at first. An error is shared out by φ/|φ|² (NLMS), so that η is the share of it that one tick
takes away, as for binary features.
"""

import numpy as np
from numpy.typing import NDArray

from bentod.contracts import Vector
from bentod.learn.confidence.spans import Spans


class RealUncertainty(Spans):
    """Of GVFs over `size` features; the other parameters are those of `Uncertainty`."""

    def __init__(
        self, size: int, ranges: NDArray[np.float64], eta: float = 0.1, sigma: float = 2.5e-5
    ) -> None:
        if not 0 <= sigma < eta <= 1:
            raise ValueError(f"σ must be 0 or more, below η, and η up to 1, not σ = {sigma}, η = {eta}.")
        super().__init__(ranges, {"x": ((size,), 0.0)}, {})
        self._eta, self._sigma = eta, sigma

    def step(
        self,
        before: Vector | None,
        delta: NDArray[np.float64],
        now: Vector,
        cumulants: NDArray[np.float64],
        ticks: int = 1,
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """U and C at the features `now`, shape (size,), as `Uncertainty.step` tells them."""
        if ticks == 1:
            self.widen(cumulants)
        x = self._own["x"]
        learned: NDArray[np.float64] | None = None
        if before is not None and (length := float((before * before).sum())) > 0:
            error = self.share(delta) - self._at(before)
            step = self._eta * np.where(np.isfinite(error), error, 0)
            learned = np.multiply.outer(before / length, step)
        x *= (1 - self._sigma) ** ticks
        if learned is not None:
            x += learned
        u = self._at(now)
        return u, np.minimum(1 - u, 1)

    def _at(self, phi: Vector) -> NDArray[np.float64]:
        u: NDArray[np.float64] = 1 + (phi[:, None] * self._own["x"]).sum(axis=0)
        return u
