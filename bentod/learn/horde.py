"""Many questions like "where will this joint be in τ steps?", answered by groups of value functions."""

from collections.abc import Sequence
from dataclasses import dataclass

from bentod.contracts import Features
from bentod.frames import Prediction
from bentod.learn.returns import discount
from bentod.learn.true_online import TrueOnlineTD


@dataclass(frozen=True, slots=True)
class Question:
    """One general value function: the position of a joint, `timescale` steps ahead in expectation."""

    joint: int
    timescale: float  # steps, at least 1


@dataclass(frozen=True, slots=True)
class _Group:
    """The questions of one timescale, which share γ and so one eligibility trace."""

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
            for timescale in dict.fromkeys(question.timescale for question in questions)
        )

    @property
    def resets(self) -> tuple[int, ...]:
        """How often each question's learner stopped being finite and started again, in question order."""
        counts = [0] * len(self._questions)
        for group in self._groups:
            for place, count in zip(group.asked, group.learner.resets.tolist(), strict=True):
                counts[place] = count
        return tuple(counts)

    def step(self, features: Features, positions: Sequence[float]) -> tuple[Prediction, ...]:
        """Learn from having arrived at `positions` (rad, by joint index), then predict, in question order.

        A joint whose position is not finite teaches nothing in this step, and is still predicted.
        """
        answers = [0.0] * len(self._questions)
        for group in self._groups:
            cumulants = [(1 - group.gamma) * positions[joint] for joint in group.joints]
            values = group.learner.step(features, cumulants).tolist()
            for place, value in zip(group.asked, values, strict=True):
                answers[place] = value
        pairs = zip(self._questions, answers, strict=True)
        return tuple(Prediction(question.joint, question.timescale, answer) for question, answer in pairs)

    def cut(self) -> None:
        """Forget the previous step, not the weights, e.g. after a gap in the readings."""
        for group in self._groups:
            group.learner.cut()

    def _group(
        self, timescale: float, weights: Sequence[float], size: int, lam: float, alpha: float
    ) -> _Group:
        gamma = discount(timescale)
        asked = tuple(i for i, question in enumerate(self._questions) if question.timescale == timescale)
        learner = TrueOnlineTD(size, [weights[i] for i in asked], gamma, lam, alpha)
        return _Group(gamma, asked, tuple(self._questions[i].joint for i in asked), learner)
