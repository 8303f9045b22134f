"""All that is known in a tick about how far the answers of a unit can be believed (thesis 6.1)."""

from collections.abc import Mapping, Sequence
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from bentod.contracts import Vector
from bentod.learn.answers import Answers
from bentod.learn.confidence.columns import Columns
from bentod.learn.confidence.interval import Interval
from bentod.learn.confidence.real_valued import RealUncertainty
from bentod.learn.confidence.surprise import Surprise
from bentod.learn.confidence.uncertainty import Uncertainty
from bentod.learn.confidence.verify import ReturnError, horizon
from bentod.learn.encoder import Encoder
from bentod.learn.paths import below
from bentod.learn.pupils import Pupils
from bentod.learn.question import Question

Precision: TypeAlias = type[np.float64] | type[np.float32]


class Doubts:
    """The estimators of the questions of one unit, all of which ask for the same estimates."""

    def __init__(
        self, asked: Sequence[Question], encoder: Encoder, pupils: Pupils, precision: Precision = np.float64
    ) -> None:
        """`precision`: of ζ, of which there is as much as of the weights."""
        count, size = len(asked), encoder.coding.size
        first = asked[0]
        self._encoder = encoder
        self._pupils = pupils
        self._resets = pupils.resets.copy()
        self._surprise = Surprise(count)
        self._error = ReturnError(count, _horizon(first.gamma))
        ranges = np.array([_range(question) for question in asked])
        self._uncertainty: Uncertainty | RealUncertainty | None = None
        if first.estimates.confidence:
            binary = encoder.coding.binary
            self._uncertainty = (
                Uncertainty(size, ranges, precision=precision) if binary else RealUncertainty(size, ranges)
            )
        looks_back = first.estimates.interval
        self._interval = Interval(size, count, looks_back) if looks_back else None
        self._told = (np.full(count, np.nan), np.full(count, np.nan))
        self._confidence: Vector = np.full(count, np.nan)
        self.interval: tuple[NDArray[np.float64], NDArray[np.float64]] | None = None
        """What past weight vectors would predict, lowest and highest, where they are kept."""

    @property
    def normalised_error(self) -> NDArray[np.float64]:
        """The same as a share of the standard deviation of the return: 1 is no better than its mean."""
        return self._error.normalised

    def step(self, rewards: Vector, gamma: float, values: Vector, ticks: int) -> None:
        """Take in a step: R_{t+1}, γ_{t+1} and the predictions that came of it; `ticks`: that it spanned."""
        self._begin_anew()
        delta = self._pupils.delta
        self._told = (self._surprise.step(delta), self._error.step(values, rewards, gamma))
        self._estimate(bool(np.isfinite(delta).any()), delta, rewards, ticks)
        if self._interval is not None:
            places, active = self._encoder.sparse
            self.interval = self._interval.step(places, self._pupils.weights, active)

    def tell(self, answers: Answers, places: NDArray[np.intp]) -> None:
        """Put what was estimated in this step beside the answers."""
        answers.surprise[places], answers.error[places] = self._told
        if self._uncertainty is not None:
            answers.confidence[places] = self._confidence

    def cut(self) -> None:
        """What follows has nothing to do with what came before."""
        self._error.cut()

    def forget(self, columns: NDArray[np.intp]) -> None:
        """Some of the learners have begun anew."""
        for estimator in self._parts().values():
            estimator.forget(columns)

    def own(self) -> frozenset[str]:
        """The entries of `memory` whose last axis is the questions."""
        return frozenset(f"{part}/{name}" for part, it in self._parts().items() for name in it.own)

    def memory(self) -> dict[str, NDArray[np.float64]]:
        """Copies of all that has been estimated, by part and name."""
        return {f"{part}/{name}": a for part, it in self._parts().items() for name, a in it.memory().items()}

    def recall(self, memory: Mapping[str, NDArray[np.float64]]) -> None:
        """Become what `memory` told. Raises ValueError: it is not that of such estimators."""
        for part, estimator in self._parts().items():
            estimator.recall(below(memory, part))
        self._resets = self._pupils.resets.copy()

    def _estimate(self, learned: bool, delta: Vector, rewards: Vector, ticks: int) -> None:
        """C here, after the error of the step before, if that was `learned` from."""
        seen = self._encoder
        if isinstance(self._uncertainty, Uncertainty):
            before = seen.before if learned else None
            self._confidence = self._uncertainty.step(before, delta, seen.features, rewards, ticks)[1]
        elif self._uncertainty is not None:
            dense = seen.dense_before if learned else None
            self._confidence = self._uncertainty.step(dense, delta, seen.dense, rewards, ticks)[1]

    def _begin_anew(self) -> None:
        """Know nothing of those learners that have begun anew since the last step."""
        resets = self._pupils.resets
        if not np.array_equal(resets, self._resets):
            self.forget(np.flatnonzero(resets != self._resets))
            self._resets = resets.copy()

    def _parts(self) -> dict[str, Columns]:
        parts: dict[str, Columns | None] = {
            "surprise": self._surprise,
            "error": self._error,
            "uncertainty": self._uncertainty,
            "interval": self._interval,
        }
        return {name: part for name, part in parts.items() if part is not None}


def _horizon(gamma: float | str) -> int:
    """Ticks; of a γ that depends on the state nobody knows, and 20 s at 30 Hz are taken."""
    return 600 if isinstance(gamma, str) else horizon(gamma)


def _range(question: Question) -> float:
    """The span of R, if the question tells that of its cumulant; else NaN."""
    told, gamma = question.estimates.confidence_range, question.gamma
    if told is None:
        return np.nan
    return told * (1 - gamma) if question.scaled and not isinstance(gamma, str) else told
