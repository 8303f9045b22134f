"""The state of many GVFs over shared binary features, whose traces fade lazily: what need not change, waits.

GVFs with equal γ, λ and α over the same features have the same trace. With z the trace without α (e = α z
in the thesis, (2.3) and (2.7)–(2.9)), and v, v_old the values of φ_t under the newest weights and those
before,

    TD(λ)              z_t = γ_tλ_t z_{t−1} + φ_t                                   w_{t+1} = w_t + α δ_t z_t
    True Online TD(λ)  z_t = γ_tλ_t z_{t−1} + (1 − α γ_tλ_t z_{t−1}ᵀφ_t) φ_t
                                                  w_{t+1} = w_t + α (δ_t + v − v_old) z_t − α (v − v_old) φ_t

    δ_t = R_{t+1} + γ_{t+1} w_tᵀφ_{t+1} − w_tᵀφ_t                                     (2.2), Algorithm 1

(thesis 2.3; van Seijen & Sutton, "True Online TD(λ)", ICML 2014; Sutton & Barto 2018, section 12.5.) Each
step changes z everywhere and w wherever z is not 0. But z = s c, where s = Π γλ is one number and c changes
only where φ is active; and w = w̃ + c D, where D sums α s (δ + v − v_old) for each GVF. A feature that is
not active keeps c and w̃, so a step costs what its active rows cost, whatever λ and the number of features:
algebra, not approximation.

One step, from the active features A to A′, the terms of True Online in brackets:

    raw  = Σ_{A′} w̃ + (Σ_{A′} c) D            v′ = raw [+ α (v − v_old) |A ∩ A′|]
    δ    = R + γ v′ − v                        D += α s (δ [+ v − v_old])
    v    = raw + (Σ_{A′} c) · that change of D    v_old = v′
    s   *= γλ                                  inc = (1 [− α s Σ_{A′} c]) / s
    c_{A′} += inc                              w̃_{A′} −= inc D [+ α (v − v_old)]

The last bracket is the term − α (v − v_old) φ of the *next* step, known already; taken now, it costs no
second visit of the rows. Until then w̃ on A lacks it, which v′ makes good.

When s gets small (or an epoch old: at γλ = 1 it never does), 1/s would drown w̃ in rounding. Then an
*epoch* ends: D_old = D, D = 0, s = 1, and every row i is *stale*: it still owes w̃_i += c_i D_old and c_i
*= s. It pays when it is next active, or when the sweep, a slice of the rows each step, comes by, which is
before the next epoch ends. When does not matter to the result, as neither c_i nor D_old changes meanwhile.
γλ = 0 forgets: an epoch that ends with s = 0.

What goes wrong easily:

* (2.7)–(2.9) have α inside the trace, (12.5) outside; they agree while α is constant, as it is here;
* Algorithm 1 takes δ with w_tᵀφ_t, thesis (5.2) with w_{t−1}ᵀφ_t; the difference returns in the last term
  of (5.4). The δ of one with the last term of the other is a different, wrong rule;
* v_old is w_tᵀφ_{t+1}, taken *before* w is updated. Taken after, v − v_old is always 0 and the correction
  is lost. Only when the trace was just forgotten it drops out: z = φ, and α (v − v_old) z is what is taken
  away again;
* v_old is exact only while φ_{t+1} becomes φ_t unchanged, and nobody writes weights in between.
"""

from dataclasses import dataclass
from typing import Literal, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from bentod.contracts import Vector

Real: TypeAlias = np.float64 | np.float32
Algorithm: TypeAlias = Literal["td", "true_online"]

ON, EPOCH, FORGET, BEGIN = range(4)
"""How a step turns: it goes on; it ends the epoch; it forgets a trace that was φ alone; it only predicts."""

REACH = 1000.0
"""A prediction is exploding beyond so many times what its cumulants so far could add up to."""


class Step(NamedTuple):
    """What is the same for all GVFs of a step; a tuple, which is made faster than a dataclass."""

    active: int  # |A′|
    before: int  # |A|
    gamma: float  # γ_{t+1}
    s: float
    s_next: float  # s γ_{t+1}λ_{t+1}
    kept: float  # what s was when the last epoch ended
    horizon: float  # how many of the greatest cumulant a return can have, see `Group`
    turn: int
    sweep: int  # the first row that the sweep folds before the step
    swept: int  # the first row after those


@dataclass(frozen=True, slots=True)
class Lazy:
    """n features, m GVFs; every kernel works on this state in place."""

    weights: NDArray[Real]  # w̃, shape (n, m), rows contiguous
    c: Vector  # z / s, shape (n,)
    stale: NDArray[np.uint8]  # 1: the row owes c D_old, shape (n,)
    active: NDArray[np.uint8]  # 1: in A, shape (n,)
    rows: NDArray[np.intp]  # A′, as far as `Step.active`, shape (n,)
    before: NDArray[np.intp]  # A, as far as `Step.before`, shape (n,)
    cumulants: Vector  # R_{t+1}; this and all below of shape (m,)
    d: Vector
    d_old: Vector
    v: Vector
    v_old: Vector
    delta: Vector  # δ of Algorithm 1; NaN where nothing was learned
    peak: Vector  # the greatest |R| so far
    base: Vector  # the greatest |w| that it began with
    initial: Vector  # the weight to begin again with
    resets: NDArray[np.int64]
    alpha: float
    negligible: float  # a c below it, in a new epoch, is 0
    online: bool


def lazy(weights: NDArray[Real], initial: Vector, algorithm: Algorithm, alpha: float) -> Lazy:
    """The state before the first step; `weights` are overwritten with `initial`.

    Raises:
        ValueError: arrays that do not fit one another.
    """
    if weights.ndim != 2 or initial.shape != weights.shape[1:] or not weights.flags.writeable:
        raise ValueError(
            f"A group needs writable weights of shape (features, GVFs) and an initial weight for each GVF, "
            f"not shapes {weights.shape} and {initial.shape}."
        )
    if weights.dtype not in (np.float64, np.float32) or not _rows_contiguous(weights):
        raise ValueError("Weights must be float64 or float32, and each row of them contiguous.")
    weights[:] = initial
    n, m = weights.shape
    rounded = np.asarray(initial, dtype=weights.dtype).astype(np.float64)
    return Lazy(
        weights,
        c=np.zeros(n),
        stale=np.zeros(n, np.uint8),
        active=np.zeros(n, np.uint8),
        rows=np.zeros(n, np.intp),
        before=np.zeros(n, np.intp),
        cumulants=np.zeros(m),
        d=np.zeros(m),
        d_old=np.zeros(m),
        v=np.zeros(m),
        v_old=np.zeros(m),
        delta=np.full(m, np.nan),
        peak=np.zeros(m),
        base=np.abs(rounded),
        initial=rounded,
        resets=np.zeros(m, np.int64),
        alpha=alpha,
        # Neither moves a weight of its type, and products with it do not become subnormal, which is slow.
        negligible=1e-100 if weights.dtype == np.float64 else 1e-20,
        online=algorithm == "true_online",
    )


def _rows_contiguous(weights: NDArray[Real]) -> bool:
    return weights.shape[1] < 2 or weights.strides[1] == weights.itemsize
