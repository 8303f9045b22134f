"""Questions that are learned in one go: over the same representation, with the same γ, λ and algorithm."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bentod.contracts import Vector
from bentod.learn.doubts import Doubts
from bentod.learn.encoder import Encoder
from bentod.learn.guesses import Guesses
from bentod.learn.paths import below, put_below
from bentod.learn.program import Program
from bentod.learn.pupils import Pupils
from bentod.learn.scene import Scene


@dataclass(frozen=True, slots=True)
class Discount:
    """γ of a tick, and what n ticks at once make of it, of λ and of the cumulant.

    When ticks were missed, what they would have shown is not known: the cumulant is taken to have been then
    what it is now. A transition of n ticks is discounted by γ^n, its trace decays by (γλ)^n, and

        R = Σ_{i<n} γ^i c = c (1 − γ^n) / (1 − γ)      or, of a question that is scaled,      R = c (1 − γ^n)

    as over an option that lasts n steps (Sutton, Precup & Singh 1999, section 3). A cumulant that is made of
    a transition, as δ² is, is that of all n ticks already: R = c.
    """

    gamma: float | None  # None: an expression of the state
    lam: float
    scaled: NDArray[np.bool_]  # shape (questions,)
    whole: NDArray[np.bool_] | None = None  # whether c is of the transition, as δ² is; None: no

    def rewards(self, cumulants: NDArray[np.float64], gamma: float, steps: int) -> NDArray[np.float64]:
        """R of each question after `steps` ticks; `gamma`: of one."""
        rest = 1 - gamma**steps
        whole = rest / (1 - gamma) if gamma < 1 else float(steps)
        share = np.where(self.scaled, rest, whole)
        if self.whole is not None:
            share = np.where(self.whole, np.where(self.scaled, 1 - gamma, 1.0), share)
        rewards: NDArray[np.float64] = cumulants * share
        return rewards


class Unit:
    """Answers those questions whose `places` it is given."""

    def __init__(
        self,
        places: Sequence[int],
        encoder: Encoder,
        program: Program,
        discount: Discount,
        pupils: Pupils,
        doubts: Doubts,
        guesses: Guesses | None = None,
    ) -> None:
        """`program` evaluates cumulants, γ unless it is constant, ρ of each off policy, and guesses last."""
        self.places = np.array(places, dtype=np.intp)
        self.pupils = pupils
        self.doubts = doubts
        self._encoder = encoder
        self._program = program
        self._discount = discount
        self._guesses = guesses

    def step(self, scene: Scene, learn: bool) -> None:
        """Learn from this tick, unless it is not to or nothing can be; then predict, unless it is blind."""
        sees = self._encoder.look(scene)
        observed = self._program.evaluate(scene.signals, scene.answers, scene.elapsed)
        gamma = self._gamma(observed)
        knows = bool(np.isfinite(gamma))
        follows = bool(scene.steps and sees and knows)
        if not follows:
            self.doubts.cut()
        if not (learn and follows):
            self.pupils.cut()
        if sees:
            self._answer(observed, gamma if knows else 0.0, scene)

    def cut(self) -> None:
        """Forget the step before, not what was learned."""
        self.pupils.cut()
        self.doubts.cut()

    def restart(self) -> None:
        """Forget all that came before, what the cumulants remember included; not what was learned."""
        self.cut()
        self._program.restart()

    def reset(self, columns: Sequence[int]) -> None:
        """Begin anew with some of the questions."""
        self.pupils.reset(columns)
        self.doubts.forget(np.array(columns, dtype=np.intp))

    def own(self) -> frozenset[str]:
        """The entries of `memory` whose last axis is the questions."""
        named = {"pupils": self.pupils.own(), "doubts": self.doubts.own(), "guesses": frozenset({"before"})}
        return frozenset(f"{part}/{name}" for part, names in named.items() for name in names)

    def memory(self) -> dict[str, NDArray[np.float64]]:
        """Copies of all that is to be kept, by part and name."""
        return put_below("pupils", self.pupils.memory()) | self.beside()

    def beside(self) -> dict[str, NDArray[np.float64]]:
        """The same without what the pupils have learned."""
        inputs = put_below("inputs", self._program.memory())
        guesses = put_below("guesses", self._guesses.memory()) if self._guesses else {}
        return put_below("doubts", self.doubts.memory()) | inputs | guesses

    def recall(self, memory: Mapping[str, NDArray[np.float64]]) -> None:
        """Become what `memory` told. Raises ValueError: it is not that of such a unit."""
        self.pupils.recall(below(memory, "pupils"))
        self.recall_beside(memory)

    def recall_beside(self, memory: Mapping[str, NDArray[np.float64]]) -> None:
        """Become what `memory` told, as far as `beside` goes. Raises as `recall` does."""
        self.doubts.recall(below(memory, "doubts"))
        self._program.recall(below(memory, "inputs"))
        if self._guesses:
            self._guesses.recall(below(memory, "guesses"))

    def _gamma(self, observed: Vector) -> float:
        if self._discount.gamma is not None:
            return self._discount.gamma
        return float(np.clip(observed[len(self.places)], 0.0, 1.0))

    def _rho(self, observed: Vector) -> NDArray[np.float64] | None:
        first = len(self.places) + (self._discount.gamma is None)
        last = len(observed) - (self._guesses.count if self._guesses else 0)
        return np.maximum(observed[first:last], 0.0) if last > first else None

    def _answer(self, observed: Vector, gamma: float, scene: Scene) -> None:
        count, steps = len(self.places), max(scene.steps, 1)
        with np.errstate(over="ignore", invalid="ignore"):  # a cumulant may be anything
            rewards = self._discount.rewards(observed[:count], gamma, steps)
            gamma, lam = gamma**steps, self._discount.lam**steps
            values = self._step(observed, rewards, gamma, lam)
            scene.answers.put(self.places, values, self.pupils.delta)
            self.doubts.step(rewards, gamma, values, scene.elapsed)
        self.doubts.tell(scene.answers, self.places)

    def _step(self, observed: Vector, rewards: Vector, gamma: float, lam: float) -> Vector:
        """Learn and predict; where there are guesses, add to these."""
        if self._guesses is None:
            return self.pupils.step(self._encoder, rewards, gamma, lam, self._rho(observed))
        now = observed[-self._guesses.count :]
        shaped = self._guesses.shaped(rewards, gamma, now)
        values: Vector = self.pupils.step(self._encoder, shaped, gamma, lam, self._rho(observed)) + now
        return values
