"""TD(λ) with the traces that the thesis knows: accumulating, replacing, and normalised by what is active.

Sutton, "Learning to predict by the methods of temporal differences", 1988; thesis section 2.3.1:

    δ_t     = R_{t+1} + γ w_tᵀφ_{t+1} − w_tᵀφ_t                                     (2.2)
    e_t     = λγ e_{t−1} + α φ_t                                   accumulating     (2.3)
    w_{t+1} = w_t + δ_t e_t                                                         (2.4)
    e_t(s)  = λγ e_{t−1}(s), or 1 if s is active in φ_t            replacing        (2.5)
    e_t     = λγ e_{t−1} + α φ_t / max(1, ‖φ_t‖₀)                  normalised       (4.3)
    w_{t+1} = w_t + δ_{t+1} e_t                                                     (4.4)

* γ and λ may change from state to state: γ in (2.2) is that of the state arrived at, γ_{t+1}; those of
  the trace are of the state left, γ_t and λ_t (Sutton & Barto 2018, section 12.8).
* All traces hold α: in a replacing trace α stands where (2.5) has 1, so that (2.4) is one rule for all.
* (4.3) and (4.4) are one step apart in their indices; read to the letter the state just left would not
  learn from its own error. The trace that w_t learns with holds φ_t here, as in (2.3).
* ρ_t multiplies the whole trace, as in Sutton & Barto 2018, (12.25). So it may learn off policy, and
  diverge.
"""

import numpy as np

from bentod.contracts import Arrival, LearnerSettings, Vector
from bentod.learn.algorithms.linear import FixedStep, dot


class TD(FixedStep):
    """TD(λ) with accumulating traces.

    It is stable only while eᵀφ stays below about 2: where the same features are active for long, the trace
    adds up to 1/(1 − γλ) times α|φ|², and the step size must be as much smaller.
    """

    def __init__(self, settings: LearnerSettings) -> None:
        super().__init__(settings)
        self.e = self._keep("trace", passing=True)

    def _learn(self, phi: Vector, arrival: Arrival, delta: float, change: float) -> None:
        self._enter(self.phi)
        self.e *= arrival.rho
        self.w += delta * self.e  # (2.4)
        self._fade(arrival, self.e)

    def _enter(self, phi: Vector) -> None:
        self.e += self._alpha(phi) * phi  # (2.3)


class ReplacingTD(TD):
    """TD(λ) with replacing traces, for binary features; of others α φ(s) replaces e(s) if φ(s) is not 0."""

    def _enter(self, phi: Vector) -> None:
        np.copyto(self.e, self._alpha(phi) * phi, where=phi != 0)  # (2.5)


class NormalisedTD(TD):
    """TD(λ) with traces normalised by the number of active features, whatever number was expected."""

    def __init__(self, settings: LearnerSettings) -> None:
        super().__init__(settings)
        self._share = settings.step_size

    def _enter(self, phi: Vector) -> None:
        alpha = self._share / max(1, int(np.count_nonzero(phi)))
        self.e += min(alpha, 1 / max(dot(phi, phi), 1e-300)) * phi  # (4.3)
