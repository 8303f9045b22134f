"""GTD(λ): off-policy learning that does not diverge, with a second set of weights.

Maei, "Gradient temporal-difference learning algorithms" (PhD thesis, Alberta 2011), as used by Sutton,
Modayil et al., "Horde", AAMAS 2011. With ρ_t the ratio of the policies' probabilities of what was done:

    δ_t     = R_{t+1} + γ_{t+1} w_tᵀφ_{t+1} − w_tᵀφ_t
    e_t     = ρ_t (γ_t λ_t e_{t−1} + φ_t)
    w_{t+1} = w_t + α [δ_t e_t − γ_{t+1} (1 − λ_{t+1}) (e_tᵀh_t) φ_{t+1}]
    h_{t+1} = h_t + β [δ_t e_t − (h_tᵀφ_t) φ_t]

h estimates E[φφᵀ]⁻¹ E[δe], and w descends the projected Bellman error. β = η α, with the option `eta`:
the larger, the sooner h follows, and the noisier it is. ρ may be any number from 0 on, and on policy it
is 1. α|φ|² and β|φ|² are kept to 1 at most.
"""

from collections.abc import Mapping
from typing import ClassVar

from bentod.contracts import Arrival, LearnerSettings, Vector
from bentod.learn.algorithms.linear import FixedStep, dot
from bentod.learn.algorithms.options import Option


class GTD(FixedStep):
    """GTD(λ)."""

    OPTIONS: ClassVar[Mapping[str, Option]] = {"eta": Option(1.0, 0.0, 1000.0)}

    def __init__(self, settings: LearnerSettings) -> None:
        super().__init__(settings)
        self.eta = self.parameters["eta"]
        self.e = self._keep("trace", passing=True)
        self.h = self._keep("secondary")

    def _learn(self, phi: Vector, arrival: Arrival, delta: float, change: float) -> None:
        alpha = min(self._alpha(self.phi), self._alpha(phi))
        beta = min(self.eta * alpha, 1 / max(dot(self.phi, self.phi), 1e-300))
        self.e += self.phi
        self.e *= arrival.rho
        bootstrap = arrival.gamma * (1 - arrival.lam) * dot(self.e, self.h)
        self.w += alpha * (delta * self.e - bootstrap * phi)
        self.h += beta * (delta * self.e - dot(self.h, self.phi) * self.phi)
        self._fade(arrival, self.e)
