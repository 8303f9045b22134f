"""TIDBD(λ): TD(λ) with a step size for each feature, learned on line.

Kearney, Veeriah, Travnik, Sutton & Pilarski, "TIDBD: Adapting temporal-difference step-sizes through
stochastic meta-descent", 2018; the form for semi-gradient TD. For each feature i, with the meta step
size θ (option `theta`):

    δ_t = R_{t+1} + γ w_tᵀφ_{t+1} − w_tᵀφ_t
    β_i ← β_i + θ δ_t φ_i h_i
    α_i ← exp β_i
    z_i ← γλ z_i + φ_i
    w_i ← w_i + α_i δ_t z_i
    h_i ← h_i [1 − α_i φ_i z_i]⁺ + α_i δ_t z_i

h_i is a memory of how w_i was changed lately: where errors keep their sign the step size grows, where
they turn about it falls. θ multiplies δ², so its right size depends on the unit of the cumulant
(Autostep's does not).

Beyond the paper, because step sizes that grow unwatched diverge: where a step would change the
prediction that it learns from by more than its error, Σ α_i z_i φ_i > 1, all of the step is divided by
that sum; and α_i stays within 1e-20 and 1e20.
"""

import math
from collections.abc import Mapping
from typing import ClassVar

import numpy as np

from bentod.contracts import Arrival, LearnerSettings, Vector
from bentod.learn.algorithms.linear import Linear, dot
from bentod.learn.algorithms.options import Option

_FURTHEST = math.log(1e20)


class TIDBD(Linear):
    """TIDBD(λ) with accumulating traces; `step_size` is where each feature's begins."""

    OPTIONS: ClassVar[Mapping[str, Option]] = {"theta": Option(0.01, 0.0, 1000.0)}

    def __init__(self, settings: LearnerSettings) -> None:
        super().__init__(settings)
        self.theta = self.parameters["theta"]
        self.beta = self._keep("log_step_sizes", math.log(self.alpha))
        self.z = self._keep("trace", passing=True)
        self.h = self._keep("h")

    def _learn(self, phi: Vector, arrival: Arrival, delta: float, change: float) -> None:
        self.beta += self.theta * delta * self.phi * self.h
        np.clip(self.beta, -_FURTHEST, _FURTHEST, out=self.beta)
        alpha = np.exp(self.beta)
        self.z += self.phi
        step = alpha * self.z
        step /= max(1.0, dot(step, self.phi))
        self.w += delta * step
        self.h *= np.maximum(0.0, 1 - step * self.phi)
        self.h += delta * step
        self._fade(arrival, self.z)
