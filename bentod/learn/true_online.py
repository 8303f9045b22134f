"""True Online TD(λ) for many general value functions that share features, γ, λ and α, and hence one trace.

Thesis (5.2)–(5.4), after van Seijen & Sutton, "True Online TD(λ)", ICML 2014:

    δ_t     = R_{t+1} + γ w_tᵀφ_{t+1} − w_{t−1}ᵀφ_t                        (5.2)
    e_t     = γλ e_{t−1} + α φ_t − αγλ [e_{t−1}ᵀφ_t] φ_t                   (5.3)
    w_{t+1} = w_t + δ_t e_t + α [w_{t−1}ᵀφ_t − w_tᵀφ_t] φ_t                (5.4)

Chapter 2 of the thesis writes it as Algorithm 1, (2.7)–(2.9). The two are one algorithm:

* the trace of (5.3) is ê of (2.7), before the decay that (2.9) applies at the end of a step; both hold α
  inside, so they agree even when α changes from step to step. A trace without α, with w += α δ e
  (Sutton & Barto 2018, section 12.5), agrees only while α is constant;
* Algorithm 1 takes δ with w_tᵀφ_t, (5.2) with w_{t−1}ᵀφ_t; the difference, Δv = (w_t − w_{t−1})ᵀφ_t, returns
  in its last term, Δv (e − α φ). The δ of one with the last term of the other is a different, wrong rule;
* v_old is w_tᵀφ_{t+1}, taken *before* w is updated. Taken after, Δv is always 0 and the correction is lost;
* at the first step after the trace was cleared e = α φ, and v_old drops out: any w_{−1} will do;
* only Algorithm 1 says what happens at the end of an episode: γ = 0 in δ and, through (2.9), in the trace.
  Here the end is a step with no active features, worth 0, then `cut()`.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from bentod.contracts import Features

_NEGLIGIBLE = 1e-100
"""A trace below this moves no float64 weight. Left to decay it would become subnormal, stay so for ever
(0.9 of the least subnormal number rounds to itself) and make every step about three times as slow."""
_SWEEP = 64  # steps between two clearings of negligible traces


class TrueOnlineTD:
    """A group of GVFs over `size` binary features; `initial`: the weight each GVF starts with everywhere.

    A GVF that stops being finite starts again from its initial weights, and `resets` counts it. The others
    keep learning, which is why the shared trace is kept: the GVF's later errors also reach features from
    before. A cumulant that is not finite teaches its GVF nothing for one step.

    Stable for α times the number of active features up to 1.
    """

    def __init__(self, size: int, initial: Sequence[float], gamma: float, lam: float, alpha: float) -> None:
        if not (0 <= gamma <= 1 and 0 <= lam <= 1 and 0 < alpha <= 1):
            raise ValueError(
                f"γ and λ must be 0 to 1 and α above 0 and up to 1, not {gamma}, {lam}, {alpha}."
            )
        self._gamma = gamma
        self._gamma_lam = gamma * lam
        self._alpha = alpha
        self._initial = np.array(initial, dtype=np.float64)
        # One GVF a row, because numpy is fast along rows and a group has few GVFs.
        self._w = np.repeat(self._initial[:, None], size, axis=1)
        self._change = np.empty_like(self._w)
        self._factors = np.empty((len(self._initial), 2))
        self._directions = np.zeros((2, size))
        self._e, self._dense_phi = self._directions
        self._age = 0
        self._phi: Features | None = None
        self._v = self._v_old = np.zeros(len(self._initial))
        self.resets = np.zeros(len(self._initial), dtype=np.int64)
        """How often each GVF had to start again, shape (gvfs,)."""

    @property
    def weights(self) -> NDArray[np.float64]:
        """A view for reading, shape (features, gvfs)."""
        view = self._w.T.view()
        view.flags.writeable = False
        return view

    def step(self, features: Features, cumulants: Sequence[float]) -> NDArray[np.float64]:
        """P_{t+1} = w_{t+1}ᵀφ_{t+1} after learning from R_{t+1} = `cumulants`; finite whatever comes in."""
        with np.errstate(over="ignore", invalid="ignore"):
            v_old = prediction = self._values(features)
            if self._phi is not None:
                self._remember(self._phi)
                self._learn(self._phi, np.asarray(cumulants, dtype=np.float64), v_old)
                prediction = self._values(features)
        self._mend(len(features), prediction, v_old)
        self._phi, self._v, self._v_old = features, prediction, v_old
        return prediction.copy()

    def cut(self) -> None:
        """Clear the trace: what follows has nothing to do with what came before."""
        self._phi = None
        self._e.fill(0)

    def _values(self, phi: Features) -> NDArray[np.float64]:
        values: NDArray[np.float64] = self._w.take(phi, axis=1).sum(axis=1)
        return values

    def _remember(self, phi: Features) -> None:
        """Bring φ_t into the trace, (5.3)."""
        e = self._e
        e *= self._gamma_lam
        e[phi] += self._alpha * (1 - e.take(phi).sum())
        self._age += 1
        if self._age % _SWEEP == 0:
            e[np.abs(e) < _NEGLIGIBLE] = 0

    def _learn(self, phi: Features, cumulants: NDArray[np.float64], v_next: NDArray[np.float64]) -> None:
        """Update the weights by (5.2) and (5.4); `v_next` is w_tᵀφ_{t+1}."""
        delta = cumulants + self._gamma * v_next - self._v_old
        correction = self._alpha * (self._v_old - self._v)
        untaught = ~np.isfinite(cumulants)
        if untaught.any():
            delta[untaught] = correction[untaught] = 0
        # (5.4) as one product, [δ, α(…)] · [e; φ]: a third of the time of an outer product and a scatter.
        self._factors[:, 0] = delta
        self._factors[:, 1] = correction
        self._dense_phi[phi] = 1
        self._w += np.matmul(self._factors, self._directions, out=self._change)
        self._dense_phi[phi] = 0

    def _mend(self, k: int, prediction: NDArray[np.float64], v_old: NDArray[np.float64]) -> None:
        """Restart GVFs whose `prediction` over k active features is not finite; mends both arrays in place.

        An infinite or undefined δ spoils every weight of its GVF, so looking at the prediction is enough.
        """
        broken = ~np.isfinite(prediction)
        if broken.any():
            self._w[broken] = self._initial[broken, None]
            prediction[broken] = v_old[broken] = k * self._initial[broken]
            self.resets[broken] += 1
            if not np.isfinite(self._e).all():
                self._e.fill(0)
