"""Autostep for TD(λ): step sizes learned on line, with a meta step size that fits cumulants of any unit.

Mahmood, Sutton, Degris & Pilarski, "Tuning-free step-size adaptation", ICASSP 2012, carried to TD as in
Günther, Ady, Kearney, Dawson & Pilarski, "Examining the use of temporal-difference incremental
delta-bar-delta for real-world predictive knowledge architectures", 2020; here in the form for
semi-gradient TD, as in `tidbd`. For each feature i, with the options `theta` (μ of the first paper) and
`tau` (steps):

    δ_t = R_{t+1} + γ w_tᵀφ_{t+1} − w_tᵀφ_t
    z_i ← γλ z_i + φ_i
    η_i ← max(|δ_t φ_i h_i|, η_i + (1/τ) α_i φ_i z_i (|δ_t φ_i h_i| − η_i))
    β_i ← β_i + θ δ_t φ_i h_i / η_i                                                 where η_i > 0
    M   = max(1, Σ_i α_i z_i (φ_i − γ φ'_i)),   α_i = exp β_i
    β_i ← β_i − ln M
    w_i ← w_i + α_i δ_t z_i
    h_i ← h_i [1 − α_i φ_i z_i]⁺ + α_i δ_t z_i

η_i is about the greatest |δ φ_i h_i| of late, so a step size changes by a factor of exp θ at most. M is
the share of the error that the step would take away, as in Dabney & Barto, "Adaptive step-size for
online temporal difference learning", AAAI 2012: never more than the whole. φ_t is in z before M is
taken, because w moves along that z.
"""

import math
from collections.abc import Mapping
from typing import ClassVar

import numpy as np

from bentod.contracts import Arrival, LearnerSettings, Vector
from bentod.learn.algorithms.linear import Linear, dot
from bentod.learn.algorithms.options import Option

_FURTHEST = math.log(1e20)


class Autostep(Linear):
    """Autostep for TD(λ); `step_size` is where each feature's begins."""

    OPTIONS: ClassVar[Mapping[str, Option]] = {
        "theta": Option(0.01, 0.0, 1.0),
        "tau": Option(1e4, 1.0, 1e9),
    }

    def __init__(self, settings: LearnerSettings) -> None:
        super().__init__(settings)
        self.theta, self.tau = self.parameters["theta"], self.parameters["tau"]
        self.beta = self._keep("log_step_sizes", math.log(self.alpha))
        self.eta = self._keep("normaliser")
        self.z = self._keep("trace", passing=True)
        self.h = self._keep("h")

    def _learn(self, phi: Vector, arrival: Arrival, delta: float, change: float) -> None:
        self.z += self.phi
        self._adapt(delta * self.phi * self.h)
        share = dot(np.exp(self.beta) * self.z, self.phi - arrival.gamma * phi)
        self.beta -= math.log(max(1.0, share)) if math.isfinite(share) else 0.0
        np.clip(self.beta, -_FURTHEST, _FURTHEST, out=self.beta)
        step = np.exp(self.beta) * self.z
        self.w += delta * step
        self.h *= np.maximum(0.0, 1 - step * self.phi)
        self.h += delta * step
        self._fade(arrival, self.z)

    def _adapt(self, gradient: Vector) -> None:
        """Bring η and β up to date; `gradient` is δ_t φ_i h_i."""
        size = np.abs(gradient)
        pace = np.exp(self.beta) * self.phi * self.z / self.tau
        np.maximum(size, self.eta + pace * (size - self.eta), out=self.eta)
        self.beta += self.theta * np.divide(gradient, self.eta, out=np.zeros_like(size), where=self.eta > 0)
