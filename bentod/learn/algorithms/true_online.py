"""True Online TD(λ), in both forms of the thesis.

van Seijen & Sutton, "True Online TD(λ)", ICML 2014. Thesis, Algorithm 1, with Δv_t = (w_t −
w_{t−1})ᵀφ_t:

    δ_t     = R_{t+1} + γ w_tᵀφ_{t+1} − w_tᵀφ_t
    ê_t     = e_{t−1} + α [1 − e_{t−1}ᵀφ_t] φ_t                                     (2.7)
    w_{t+1} = w_t + δ_t ê_t + Δv_t (ê_t − α φ_t)                                    (2.8)
    e_t     = γλ ê_t                                                                (2.9)

and section 5.3:

    δ_t     = R_{t+1} + γ w_tᵀφ_{t+1} − w_{t−1}ᵀφ_t                                 (5.2)
    e_t     = γλ e_{t−1} + α φ_t − αγλ [e_{t−1}ᵀφ_t] φ_t                            (5.3)
    w_{t+1} = w_t + δ_t e_t + α [w_{t−1}ᵀφ_t − w_tᵀφ_t] φ_t                         (5.4)

* They are one rule: the trace of (5.3) is ê of (2.7), and δ of (5.2) is that of Algorithm 1 plus Δv_t.
* γ and λ may change from state to state: that of δ is γ_{t+1}, those of (5.3) are γ_t and λ_t; (2.9)
  decays what (2.7) takes up at the next step, by γ_{t+1} and λ_{t+1} (van Seijen et al., "True Online
  Temporal-Difference Learning", JMLR 2016; Sutton & Barto 2018, section 12.8).
* w_{t−1}ᵀφ_t must be taken before w_t is made; at the first step w_{−1} = w_0.
* ρ is not heeded: this is an algorithm for learning on policy.
"""

from bentod.contracts import Arrival, LearnerSettings, Vector
from bentod.learn.algorithms.linear import FixedStep, dot


class TrueOnlineTD(FixedStep):
    """Algorithm 1: (2.7)–(2.9)."""

    def __init__(self, settings: LearnerSettings) -> None:
        super().__init__(settings)
        self.e = self._keep("trace", passing=True)

    def _learn(self, phi: Vector, arrival: Arrival, delta: float, change: float) -> None:
        alpha = self._alpha(self.phi)
        self.e += alpha * (1 - dot(self.e, self.phi)) * self.phi  # (2.7)
        self.w += delta * self.e + change * (self.e - alpha * self.phi)  # (2.8)
        self._fade(arrival, self.e)  # (2.9)


class TrueOnlineTD5(FixedStep):
    """(5.2)–(5.4)."""

    def __init__(self, settings: LearnerSettings) -> None:
        super().__init__(settings)
        self.e = self._keep("trace", passing=True)  # γ_t λ_t e_{t−1}

    def _learn(self, phi: Vector, arrival: Arrival, delta: float, change: float) -> None:
        alpha = self._alpha(self.phi)
        delta_5 = delta + change  # (5.2)
        self.e += alpha * self.phi - alpha * dot(self.e, self.phi) * self.phi  # (5.3)
        self.w += delta_5 * self.e - alpha * change * self.phi  # (5.4)
        self._fade(arrival, self.e)
