"""What all learners of one general value function share: weights, a memory, and a way out of divergence."""

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from bentod.contracts import Arrival, LearnerSettings, Vector
from bentod.learn.algorithms.options import Option, check, chosen

_LONGEST = 1e15
"""Vectors longer than this have diverged; whatever an arm measures is smaller by far, in any unit."""

_NEGLIGIBLE = 1e-100
"""A trace below this moves no weight. Left to decay it would become subnormal, stay so for ever (0.9 of the
least subnormal number rounds to itself) and make every step about three times as slow."""
_SWEEP = 64  # steps between two clearings of negligible traces


def dot(a: Vector, b: Vector) -> float:
    """Their inner product. Not that of BLAS, which depends on how many threads there are."""
    return float(np.add.reduce(a * b))


@dataclass(frozen=True, slots=True)
class _Kept:
    vector: Vector
    start: float
    passing: bool  # forgotten at a cut


class Linear(ABC):
    """A learner whose answer is wᵀφ. An algorithm adds what it remembers with `_keep`, and how it learns.

    A cumulant that is not finite was not observed: it is taken to be what was expected, R = v(S) − γ v(S'),
    so δ = 0 and the traces go on. γ, λ or ρ that are not finite say that nothing is known of the way here:
    nothing is learned, and the traces end. Weights that are not finite, or longer than 1e15, begin anew, and
    so does all else that was learned; `resets` counts it. So predictions are finite, whatever comes in.

    `delta` is that of (2.2) for all, δ_t = R_{t+1} + γ_{t+1} w_tᵀφ_{t+1} − w_tᵀφ_t.
    """

    OPTIONS: ClassVar[Mapping[str, Option]] = {}
    """The algorithm's own parameters."""

    def __init__(self, settings: LearnerSettings) -> None:
        check(settings, _LONGEST)
        self.parameters = chosen(settings.options, self.OPTIONS)
        self.alpha = settings.step_size / settings.active
        self.delta = math.nan
        self.resets = 0
        self._size = settings.size
        self._kept: dict[str, _Kept] = {}
        self.w = self._keep("weights", settings.initial)
        self.phi = self._keep("phi")  # φ_t
        self._begun = self._keep("begun", size=1, passing=True)  # 1: there is a φ_t
        self._v_old = self._keep("v_old", size=1)  # w_{t−1}ᵀφ_t, from before w_t was made
        self._age = self._keep("age", size=1)

    def step(self, phi: Vector, arrival: Arrival) -> float:
        """As the contract says. Raises ValueError: no such features, or not finite; nothing has changed."""
        if phi.shape != (self._size,) or not dot(phi, phi) <= _LONGEST**2:
            raise ValueError(
                f"A step takes {self._size} features, finite and together not above {_LONGEST:g}."
            )
        if not math.isfinite(arrival.gamma + arrival.lam + arrival.rho):
            self.cut()
        self.delta = math.nan
        if self._begun[0]:
            self._go(phi, arrival)
        prediction = dot(self.w, phi)
        if not self._begun[0]:
            self._v_old[0] = prediction
        self.phi[:], self._begun[0] = phi, 1
        return prediction

    def cut(self) -> None:
        """As the contract says."""
        for kept in self._kept.values():
            if kept.passing:
                kept.vector.fill(kept.start)

    def memory(self) -> dict[str, Vector]:
        """As the contract says."""
        told = {name: kept.vector.copy() for name, kept in self._kept.items()}
        return {**told, "resets": np.array([float(self.resets)])}

    def recall(self, memory: Mapping[str, Vector]) -> None:
        """As the contract says. `delta` is NaN until the next step."""
        shapes = {name: vector.shape for name, vector in self.memory().items()}
        told = {name: vector.shape for name, vector in memory.items()}
        if told != shapes:
            raise ValueError(f"This is not the memory of such a learner: {told} instead of {shapes}.")
        spoilt = [name for name, vector in memory.items() if not np.isfinite(vector).all()]
        if spoilt:
            raise ValueError(f"A memory must be finite, which {', '.join(spoilt)} is not.")
        for name, kept in self._kept.items():
            kept.vector[:] = memory[name]
        self.resets = int(memory["resets"][0])
        self.delta = math.nan

    @abstractmethod
    def _learn(self, phi: Vector, arrival: Arrival, delta: float, change: float) -> None:
        """Learn from the transition from φ_t, which is `self.phi`, to φ_{t+1}, which is `phi`.

        `delta`: δ_t by (2.2). `change`: (w_t − w_{t−1})ᵀφ_t, 0 at the first transition.
        """

    def _go(self, phi: Vector, arrival: Arrival) -> None:
        observed = math.isfinite(arrival.cumulant)
        with np.errstate(over="ignore", invalid="ignore"):
            v, v_next = dot(self.w, self.phi), dot(self.w, phi)
            delta = arrival.cumulant + arrival.gamma * v_next - v if observed else 0.0  # (2.2)
            self._learn(phi, arrival, delta, v - float(self._v_old[0]))
            self._v_old[0] = v_next
            sound = dot(self.w, self.w) <= _LONGEST**2
        if not sound:
            self._restart()
        elif observed:
            self.delta = delta

    def _keep(self, name: str, start: float = 0.0, size: int = 0, passing: bool = False) -> Vector:
        """A vector to be changed in place only; of as many numbers as there are features, unless `size`."""
        vector = np.full(size or self._size, start)
        self._kept[name] = _Kept(vector, start, passing)
        return vector

    def _fade(self, arrival: Arrival, *traces: Vector) -> None:
        """Decay by γ_{t+1} λ_{t+1}, which are the γ_t λ_t of the next transition."""
        self._age += 1
        for trace in traces:
            trace *= arrival.gamma * arrival.lam
            if self._age[0] % _SWEEP == 0:
                trace[np.abs(trace) < _NEGLIGIBLE] = 0

    def _restart(self) -> None:
        for kept in self._kept.values():
            kept.vector.fill(kept.start)
        self.resets += 1


class FixedStep(Linear):
    """With one step size for all features, and no more of it than takes an error away whole."""

    def _alpha(self, phi: Vector) -> float:
        """α, or 1/|φ|² where α|φ|² would be above 1 and the step overshoot."""
        square = dot(phi, phi)
        return self.alpha if self.alpha * square <= 1 else 1 / square
