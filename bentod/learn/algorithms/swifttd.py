"""SwiftTD: True Online TD(λ) with a learned step size for each feature, and a bound on all of them together.

Javed, Sharifnassab & Sutton, "SwiftTD: A fast and robust algorithm for temporal difference learning",
Reinforcement Learning Journal 2, 2024. In the state S_t, with features φ and α_i = exp β_i:

    v_δ = (w_t − w_{t−1})ᵀφ,   T = zᵀφ,   E = max(η, Σ_i α_i φ_i²)
    zδ_i ← (η/E) α_i φ_i
    z_i  ← z_i + zδ_i (1 − T)
    p_i  ← p_i + ĥ_i φ_i
    z̄_i  ← z̄_i + zδ_i (1 − T − z̄_i φ_i)
    h̃_i  = h_i − ĥ_i φ_i (z_i − zδ_i) − h_i zδ_i φ_i
    where E > η and φ_i ≠ 0:   h_i, ĥ_i, h̃_i, z̄_i ← 0   and   β_i ← β_i + φ_i² ln ε

and once S_{t+1} has been reached:

    δ'   = R_{t+1} + γ w_tᵀφ_{t+1} − w_{t−1}ᵀφ_t
    w_i  ← w_i + δ' z_i − zδ_i v_δ
    β_i  ← β_i + (θ/α_i) (δ' − v_δ) p_i,   kept within ln η_min and ln η
    ĥ_i, h_i ← h_i, h̃_i + δ' z̄_i − zδ_i v_δ
    z, p, z̄ ← γλ z, γλ p, γλ z̄

* With θ = 0 and no bound this is (5.2)–(5.4) with an α for each feature; δ' − v_δ is δ_t of (2.2).
* h_i is ∂w_i/∂β_i and z̄_i is ∂z_i/∂β_i, as if only the feature's own step size mattered to it and the
  target R + γv(S') were given: differentiate the lines for w and z, with ∂zδ_i/∂β_i = zδ_i. ĥ is h one
  step before, as w_{t−1}ᵀφ_t asks. p is a trace of −∂δ'/∂β, so β descends the squared error.
* Σ_i zδ_i φ_i ≤ η: of an error no more than η is taken away in one step. Step sizes that would lose a
  factor of ε each time, and their derivatives, which know nothing of the bound, begin anew.

Options: `theta` (θ), `eta` (η; a `step_size` above it begins at the bound), `decay` (ε), `eta_min`.
"""

import math
from collections.abc import Mapping
from typing import ClassVar

import numpy as np

from bentod.contracts import Arrival, LearnerSettings, Vector
from bentod.learn.algorithms.linear import Linear, dot
from bentod.learn.algorithms.options import Option


class SwiftTD(Linear):
    """SwiftTD for any features; `step_size` is where each feature's begins."""

    OPTIONS: ClassVar[Mapping[str, Option]] = {
        "theta": Option(1e-3, 0.0, 10.0),
        "eta": Option(0.5, 1e-6, 1.0),
        "decay": Option(0.9, 0.01, 1.0),
        "eta_min": Option(1e-10, 1e-30, 1e-6),
    }

    def __init__(self, settings: LearnerSettings) -> None:
        super().__init__(settings)
        self.theta, self.eta = self.parameters["theta"], self.parameters["eta"]
        self._ln_decay = math.log(self.parameters["decay"])
        self._least, self._most = math.log(self.parameters["eta_min"]), math.log(self.eta)
        self.beta = self._keep("log_step_sizes", min(max(math.log(self.alpha), self._least), self._most))
        self.z = self._keep("trace", passing=True)
        self.z_bar = self._keep("trace_slope", passing=True)
        self.p = self._keep("error_slope", passing=True)
        self.h = self._keep("weight_slope")
        self.h_old = self._keep("weight_slope_before")

    def _learn(self, phi: Vector, arrival: Arrival, delta: float, change: float) -> None:
        z_delta, h_next = self._enter(self.phi)
        delta_old = delta + change  # δ', for v_δ is the change
        self.w += delta_old * self.z - change * z_delta
        self.beta += self.theta * np.exp(-self.beta) * delta * self.p
        np.clip(self.beta, self._least, self._most, out=self.beta)
        self.h_old[:] = self.h
        self.h[:] = h_next + delta_old * self.z_bar - change * z_delta
        self._fade(arrival, self.z, self.p, self.z_bar)

    def _enter(self, phi: Vector) -> tuple[Vector, Vector]:
        """Bring φ_t into the traces; returns zδ and h̃."""
        alpha = np.exp(self.beta)
        rate = dot(alpha, phi * phi)
        fresh = 1 - dot(self.z, phi)
        z_delta = self.eta / max(self.eta, rate) * alpha * phi
        self.z += z_delta * fresh
        self.p += self.h_old * phi
        self.z_bar += z_delta * (fresh - self.z_bar * phi)
        h_next = self.h - self.h_old * phi * (self.z - z_delta) - self.h * z_delta * phi
        if rate > self.eta:
            active = phi != 0
            for slope in (self.h, self.h_old, h_next, self.z_bar):
                slope[active] = 0
            self.beta += phi * phi * self._ln_decay
            np.maximum(self.beta, self._least, out=self.beta)
        return z_delta, h_next
