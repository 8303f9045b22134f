"""Many questions like "where will this joint be in τ steps?", answered by groups of value functions."""

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from bentod.contracts import Features
from bentod.frames import Prediction
from bentod.learn.returns import discount
from bentod.learn.true_online import TrueOnlineTD

HasTime: TypeAlias = Callable[[], bool]
"""Whether there is time left to learn."""


def unhurried() -> bool:
    """There is time."""
    return True


@dataclass(frozen=True, slots=True)
class Question:
    """One general value function: the position of a joint, `timescale` steps ahead in expectation."""

    joint: int
    timescale: float  # steps, at least 1


@dataclass(frozen=True, slots=True)
class _Group:
    """The questions of one timescale, which share γ and so one eligibility trace."""

    timescale: float  # steps
    gamma: float
    asked: tuple[int, ...]  # places among the questions
    joints: tuple[int, ...]
    learner: TrueOnlineTD


class Horde:
    """Predictors of joint positions, as in thesis 5.3: R = (1 − γ) θ, α = `step_size` / `active`.

    `size` and `active` are those of the representation. `initial`: rad, what each question is answered before
    anything is learned (the thesis: the joint's minimum), to within the few features that collisions cost.
    A `step_size` of 1 would take each error away whole; more would overshoot, so 1 is the bound.
    """

    def __init__(
        self,
        questions: Sequence[Question],
        size: int,
        active: int,
        initial: Sequence[float],
        lam: float = 0.95,
        step_size: float = 0.3,
    ) -> None:
        if not 0 < step_size <= 1:
            raise ValueError(f"The step size must be above 0 and up to 1, not {step_size}.")
        if len(initial) != len(questions):
            raise ValueError(f"{len(questions)} questions need as many initial angles, not {len(initial)}.")
        self._questions = tuple(questions)
        weights = [angle / active for angle in initial]
        self._groups = tuple(
            self._group(timescale, weights, size, lam, step_size / active)
            for timescale in sorted({question.timescale for question in questions})
        )
        self.shed = 0
        """How often a group of questions was left to predict without learning, because there was no time."""

    @property
    def resets(self) -> tuple[int, ...]:
        """How often each question's learner stopped being finite and started again, in question order."""
        counts = [0] * len(self._questions)
        for group in self._groups:
            for place, count in zip(group.asked, group.learner.resets.tolist(), strict=True):
                counts[place] = count
        return tuple(counts)

    def step(
        self,
        features: Features,
        positions: Sequence[float],
        has_time: HasTime = unhurried,
        timescales: Collection[float] | None = None,
    ) -> tuple[Prediction, ...]:
        """Learn from having arrived at `positions` (rad, by joint index), then predict, in question order.

        The shortest timescale learns first. Once `has_time` says no, the groups that are left learn nothing
        from this step: they forget the step before, so that none is learned from twice or across a gap, and
        predict with what they know. `timescales`: only these groups take the step; None is all of them.

        A joint whose position is not finite teaches nothing in this step, and is still predicted.
        """
        answers: dict[int, float] = {}
        for group in self._groups:
            if timescales is None or group.timescale in timescales:
                values = self._step(group, features, positions, has_time())
                answers.update(zip(group.asked, values, strict=True))
        asked = [(place, self._questions[place]) for place in sorted(answers)]
        return tuple(Prediction(it.joint, it.timescale, answers[place]) for place, it in asked)

    def cut(self) -> None:
        """Forget the previous step, not the weights, e.g. after a gap in the readings."""
        for group in self._groups:
            group.learner.cut()

    def _step(
        self, group: _Group, features: Features, positions: Sequence[float], learn: bool
    ) -> list[float]:
        if not learn:
            self.shed += 1
            group.learner.cut()
        cumulants = [(1 - group.gamma) * positions[joint] for joint in group.joints]
        values: list[float] = group.learner.step(features, cumulants).tolist()
        return values

    def _group(
        self, timescale: float, weights: Sequence[float], size: int, lam: float, alpha: float
    ) -> _Group:
        gamma = discount(timescale)
        asked = tuple(i for i, question in enumerate(self._questions) if question.timescale == timescale)
        learner = TrueOnlineTD(size, [weights[i] for i in asked], gamma, lam, alpha)
        return _Group(timescale, gamma, asked, tuple(self._questions[i].joint for i in asked), learner)
