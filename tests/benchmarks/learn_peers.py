"""True Online TD(λ) as it is usually written in numpy: one object a GVF, and all GVFs as dense matrices."""

import numpy as np
from numpy.typing import NDArray

from bentod.contracts import Features, Vector
from bentod.learn.lazy import Real
from tests.benchmarks.learn_workloads import LAM, Workload


class TrueOnline:
    """One GVF, line by line as in Sutton & Barto 2018, section 12.5, with dense w, z and φ."""

    def __init__(self, n: int, gamma: float, lam: float, alpha: float) -> None:
        self.w = np.zeros(n)
        self.z = np.zeros(n)
        self.v_old = 0.0
        self.gamma, self.lam, self.alpha = gamma, lam, alpha

    def step(self, phi: Vector, cumulant: float, phi_next: Vector) -> float:
        """Learn from a transition; the value of what it led to."""
        v, v_next = float(self.w @ phi), float(self.w @ phi_next)
        delta = cumulant + self.gamma * v_next - v
        decay = self.gamma * self.lam
        self.z = decay * self.z + (1 - self.alpha * decay * float(self.z @ phi)) * phi
        self.w += self.alpha * (delta + v - self.v_old) * self.z - self.alpha * (v - self.v_old) * phi
        self.v_old = v_next
        return v_next


class OneByOne:
    """A Python loop over GVFs."""

    def __init__(self, load: Workload) -> None:
        self.size = load.features
        self.gvfs = [
            TrueOnline(load.features, gamma, LAM, load.alpha)
            for gamma in load.gammas
            for _ in range(load.cumulants)
        ]
        self.lefts = [1 - gamma for gamma in load.gammas]
        self.phi = np.zeros(load.features)

    def step(self, features: Features, signals: NDArray[np.float64]) -> None:
        """All predictions."""
        phi = np.zeros(self.size)
        phi[features] = 1
        cumulants = [left * signal for left in self.lefts for signal in signals.tolist()]
        for gvf, cumulant in zip(self.gvfs, cumulants, strict=True):
            gvf.step(self.phi, cumulant, phi)
        self.phi = phi


class Dense:
    """W and Z of shape (GVFs, features), and every operation on all of them."""

    def __init__(self, load: Workload, dtype: type[Real] = np.float64) -> None:
        m = load.cumulants
        self.w: NDArray[Real] = np.zeros((load.gvfs, load.features), dtype)
        self.z = np.zeros_like(self.w)
        self.v_old = np.zeros(load.gvfs, dtype)
        self.gamma: NDArray[Real] = np.repeat(load.gammas, m).astype(dtype)
        self.decay = self.gamma[:, None] * dtype(LAM)
        self.alpha = dtype(load.alpha)
        self.phi: NDArray[Real] = np.zeros(load.features, dtype)

    def step(self, features: Features, signals: NDArray[np.float64]) -> None:
        """All predictions."""
        phi = np.zeros_like(self.phi)
        phi[features] = 1
        cumulants = (1 - self.gamma) * np.tile(signals, len(self.gamma) // len(signals)).astype(phi.dtype)
        v, v_next = self.w @ self.phi, self.w @ phi
        delta = cumulants + self.gamma * v_next - v
        seen = (self.z @ self.phi)[:, None]
        self.z = self.decay * self.z + (1 - self.alpha * self.decay * seen) * self.phi
        change = v - self.v_old
        self.w += (self.alpha * (delta + change))[:, None] * self.z
        self.w -= np.outer(self.alpha * change, self.phi)
        self.v_old, self.phi = v_next, phi
