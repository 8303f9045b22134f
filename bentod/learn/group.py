"""Many general value functions over shared binary features, with one algorithm, γ, λ and α: one trace."""

import math
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from bentod.contracts import Features, Vector
from bentod.learn.kernel import Kernel
from bentod.learn.lazy import BEGIN, EPOCH, FORGET, ON, Algorithm, Real, Step, lazy
from bentod.learn.lazy_memory import read, take_over, true_trace, true_weights, written

_LEAST_S = {np.dtype(np.float64): 1e-6, np.dtype(np.float32): 1e-2}
"""An epoch ends below: s costs so much of the precision of the weights' type."""
_LONGEST = {np.dtype(np.float64): 4096, np.dtype(np.float32): 64}
"""Steps after which an epoch ends in any case: at γλ near 1, D grows although s does not fall."""


class Group:
    """m GVFs by TD(λ) with accumulating traces or by True Online TD(λ); `bentod.learn.lazy` has the algebra.

    Results are the same to the last bit with every kernel. In float32 they are those of float64 to within
    1e-3 of the greatest prediction.

    A cumulant that is not finite was not observed: δ of Algorithm 1 counts as 0, and in True Online TD(λ) the
    correction for w having changed still applies. Everything else goes on.

    A GVF begins again with its initial weight, and `resets` counts it, when its prediction is not finite or
    beyond a thousand times (`REACH`) the sum of what it began with (k active features of the greatest initial
    weight) and what its cumulants could add up to (the greatest |R| so far, times the horizon: the number of
    steps learned from, or 1 / (1 − the greatest γ so far) if that is less). The others go on, and so does the
    trace, which is theirs too.
    """

    def __init__(
        self,
        weights: NDArray[Real],
        initial: NDArray[np.float64],
        algorithm: Algorithm,
        alpha: float,
        kernel: Kernel,
    ) -> None:
        """`weights`, shape (n, m), is where the group works: w̃, not w. It begins with `initial`, shape (m,).

        Raises:
            ValueError: shapes, types or α that make no sense.
        """
        if not 0 < alpha <= 1 or algorithm not in ("td", "true_online"):
            raise ValueError(
                f'A group is of "td" or "true_online" with 0 < α ≤ 1, not of "{algorithm}" with {alpha}.'
            )
        self._lazy = lazy(weights, initial, algorithm, alpha)
        self._steps = kernel.bind(self._lazy)
        self._most = math.floor(1 / alpha + 1e-9)
        self._least_s, self._longest = _LEAST_S[weights.dtype], _LONGEST[weights.dtype]
        self._s, self._kept, self._age = 1.0, 0.0, 0
        self._n = self._swept = len(self._lazy.c)
        self._decay, self._share = 0.0, 1 / self._longest
        self._before = 0
        self._started = False
        self._fresh = True  # z is φ alone
        self._taught, self._top = 0, 0.0

    @property
    def delta(self) -> NDArray[np.float64]:
        """δ of (2.2) in the last step, shape (m,), overwritten by the next; NaN where nothing was learned."""
        return self._lazy.delta

    @property
    def resets(self) -> NDArray[np.int64]:
        """How often each GVF had to begin again, shape (m,)."""
        return self._lazy.resets

    def step(self, features: Features, cumulants: NDArray[np.float64], gamma: float, lam: float) -> Vector:
        """w_{t+1}ᵀφ_{t+1}, shape (m,), after learning from R_{t+1} = `cumulants`, γ_{t+1}, λ_{t+1}.

        It is finite whatever the cumulants were.

        The first call, and the first after `cut`, only predicts. γ and λ may change; γ = 0 forgets the trace.

        Raises:
            ValueError: features not ascending in 0..n − 1, or more than 1/α of them; γ, λ not in 0..1.
        """
        count = self._arrive(features, gamma, lam)
        self._lazy.cumulants[:] = cumulants
        step = self._learning(count, gamma, gamma * lam) if self._started else self._beginning(count)
        if not self._steps.step(step):
            raise ValueError(f"Active features must ascend within 0..{self._n - 1}.")
        self._after(step)
        return self._lazy.v.copy()

    def cut(self) -> None:
        """Forget the step before, and the trace: the next step only predicts."""
        if not self._started:
            return
        owed = self._lazy.before[: self._before]
        self._lazy.weights[owed] += self._correction()
        self._forget(owed)
        self._lazy.active[owed] = 0
        self._s, self._age, self._before = 1.0, 0, 0
        self._started = False

    def weights_now(self) -> NDArray[np.float64]:
        """w, everything folded in: a copy, shape (n, m)."""
        w = true_weights(self._lazy, self._kept)
        w[self._lazy.before[: self._before]] += self._correction()
        return w

    def trace_now(self) -> Vector:
        """z_t, the trace without α (e of the thesis is α z), shape (n,)."""
        return true_trace(self._lazy, self._s, self._kept)

    def set_weights(self, columns: Sequence[int], weights: NDArray[np.float64]) -> None:
        """Let some GVFs go on from other weights, shape (n, columns), as if they had always had them.

        Their errors reach what the trace remembers, which is the others' too.

        Raises:
            ValueError: another shape.
        """
        lazy, chosen = self._lazy, np.asarray(columns, dtype=np.intp)
        if weights.shape != (len(lazy.c), len(chosen)):
            raise ValueError(f"The weights need the shape {(len(lazy.c), len(chosen))}, not {weights.shape}.")
        lazy.weights[:, chosen] = weights
        values = weights[lazy.before[: self._before]].sum(axis=0)
        lazy.d[chosen] = lazy.d_old[chosen] = lazy.peak[chosen] = 0
        lazy.v[chosen] = lazy.v_old[chosen] = values
        lazy.base[chosen] = np.abs(weights).max(axis=0, initial=0)
        lazy.delta[chosen] = np.nan

    def reset(self, columns: Sequence[int]) -> None:
        """Let some GVFs begin anew; `resets` does not count it."""
        self.set_weights(columns, np.tile(self._lazy.initial[list(columns)], (len(self._lazy.c), 1)))

    def memory(self) -> dict[str, NDArray[np.float64]]:
        """Copies of all that was learned and is remembered: the same for every kernel and type of weights."""
        reach = (self._taught, self._top, self._started)
        return written(self._lazy, self.weights_now(), self.trace_now(), self._before, reach)

    def recall(self, memory: Mapping[str, NDArray[np.float64]]) -> None:
        """Become what `memory` told. To within rounding it goes on as the group that told it.

        Raises:
            ValueError: it is not that of a group of this size; nothing has changed.
        """
        self._before, (taught, top, started) = read(self._lazy, memory)
        self._taught, self._top, self._started = int(taught), float(top), bool(started)
        self._s, self._age, self._swept = 1.0, 0, self._n
        self._fresh = not self._started
        self._lazy.weights[self._lazy.before[: self._before]] -= self._correction()

    def go_on(self, other: "Group", mine: Sequence[int], theirs: Sequence[int]) -> None:
        """Be where `other` is, to the last bit: the GVFs `mine` as its `theirs`. The rest begin.

        Raises:
            ValueError: it learns otherwise, or from other features; nothing has changed.
        """
        take_over(self._lazy, other._lazy, mine, theirs)
        self._s, self._kept, self._age, self._swept = other._s, other._kept, other._age, other._swept
        self._before, self._started, self._fresh = other._before, other._started, other._fresh
        self._taught, self._top = other._taught, other._top
        if rest := sorted(set(range(len(self._lazy.d))) - set(mine)):
            self.reset(rest)

    def _arrive(self, features: Features, gamma: float, lam: float) -> int:
        count = len(features)
        if count > self._most:
            raise ValueError(
                f"α = {self._lazy.alpha:g} overshoots with {count} active features: it bears {self._most}."
            )
        if not (0 <= gamma <= 1 and 0 <= lam <= 1):
            raise ValueError(f"γ and λ must be 0 to 1, not {gamma} and {lam}.")
        if count > self._n:
            raise ValueError(f"Of {self._n} features {count} cannot be active.")
        self._lazy.rows[:count] = features
        return count

    def _beginning(self, count: int) -> Step:
        return Step(count, self._before, 0.0, 1.0, 1.0, self._kept, self._horizon(), BEGIN, 0, 0)

    def _learning(self, count: int, gamma: float, decay: float) -> Step:
        self._taught += 1
        self._top = max(self._top, gamma)
        s_next = self._s * decay
        turn = ON
        if s_next == 0 and self._fresh:
            turn = FORGET
        elif s_next < self._least_s or self._age >= self._longest:
            turn = EPOCH
        start = self._swept
        if start < self._n:
            self._swept = self._n if turn == EPOCH else self._slice(start, decay)
        horizon = self._horizon()
        return Step(
            count, self._before, gamma, self._s, s_next, self._kept, horizon, turn, start, self._swept
        )

    def _slice(self, start: int, decay: float) -> int:
        """Where a slice of the sweep ends: at the last row when log s has fallen to the end of the epoch.

        So the sweep is spread over the whole epoch, and hardly shows in any single step.
        """
        if decay != self._decay:
            fall = math.log(decay) / math.log(self._least_s) if decay > 0 else 0.0
            self._decay, self._share = decay, max(fall, 1 / self._longest)
        return min(self._n, start + math.ceil(self._n * self._share))

    def _after(self, step: Step) -> None:
        if step.turn == EPOCH:
            self._kept, self._swept = step.s_next, 0
        turned = step.turn != ON
        self._s = 1.0 if turned else step.s_next
        self._age = 0 if turned else self._age + 1
        self._fresh = turned and (step.turn != EPOCH or step.s_next == 0)
        self._before, self._started = step.active, True

    def _forget(self, rows: Features) -> None:
        """End an epoch with s = 0; `rows` are active."""
        lazy = self._lazy
        if self._fresh:
            lazy.weights[rows] += np.outer(lazy.c[rows], lazy.d)
            lazy.c[rows] = 0
        else:
            self._steps.fold(self._swept, self._n, self._kept)
            lazy.d_old[:] = lazy.d
            lazy.stale.fill(1)
            self._kept, self._swept = 0.0, 0
        lazy.d.fill(0)
        self._fresh = True

    def _correction(self) -> Vector:
        """α (v − v_old), which w̃ of the active features lacks already."""
        change: Vector = self._lazy.alpha * (self._lazy.v - self._lazy.v_old)
        return change if self._lazy.online else np.zeros_like(change)

    def _horizon(self) -> float:
        return self._taught if self._top == 1 else min(self._taught, 1 / (1 - self._top))
