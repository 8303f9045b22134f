"""Questions put together into units that can be learned in one go, in an order that can be followed."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from bentod import registry
from bentod.contracts import LearnerSettings
from bentod.errors import ConfigError, nearest
from bentod.learn.doubts import Doubts
from bentod.learn.encoder import Coding, Encoder
from bentod.learn.expression import Expression, Vocabulary
from bentod.learn.expression_nodes import SquaredError
from bentod.learn.group import Group
from bentod.learn.guesses import Guesses
from bentod.learn.kernel import Kernel
from bentod.learn.lazy import Algorithm, Real
from bentod.learn.program import Program
from bentod.learn.pupils import Alone, Pupils, Together
from bentod.learn.question import Question
from bentod.learn.topology import layers
from bentod.learn.unit import Discount, Unit

SHARED = ("td", "true_online")
"""Algorithms that many questions can share a trace in."""

Weights: TypeAlias = NDArray[Real]


@dataclass(frozen=True, slots=True)
class Means:
    """What questions are learned with."""

    vocabulary: Vocabulary
    codings: Mapping[str, Coding]
    kernel: Kernel
    dtype: type[np.float64] | type[np.float32]


@dataclass(frozen=True, slots=True)
class Assembly:
    """All that a horde is made of."""

    questions: tuple[Question, ...]
    encoders: Mapping[str, Encoder]
    units: tuple[Unit, ...]
    needs: Mapping[str, frozenset[str]]  # by question: the questions whose answers it is made from

    def closure(self, names: Collection[str]) -> frozenset[int]:
        """The places of `names` and of all questions that they are made from."""
        found: set[str] = set()
        waiting = [name for name in names if name in self.needs]
        while waiting:
            name = waiting.pop()
            found.add(name)
            waiting += self.needs[name] - found
        return frozenset(place for place, question in enumerate(self.questions) if question.name in found)


@dataclass(frozen=True, slots=True, order=True)
class _Key:
    """What the questions of a unit have in common, and the order of units: what others need comes first."""

    depth: int
    horizon: float  # ticks
    representation: str
    algorithm: str
    gamma: str  # the expression; empty if it is constant
    lam: float
    step_size: float
    off_policy: bool
    confidence: bool
    interval: int
    shares: bool
    advised: bool


@dataclass(frozen=True, slots=True)
class _Told:
    """The expressions of one question."""

    cumulant: Expression
    gamma: Expression | None
    policy: Expression | None
    guess: Expression | None

    @property
    def needs(self) -> frozenset[str]:
        """The questions whose answers they are made from."""
        texts = (self.cumulant, self.gamma, self.policy, self.guess)
        return frozenset[str]().union(*(text.predictions for text in texts if text))


def assembled(questions: Sequence[Question], means: Means) -> Assembly:
    """Everything that answers `questions`, with nothing learned yet.

    Raises:
        ConfigError: an expression, a representation or an algorithm is not one, or questions are made from
            each other in a circle.
    """
    vocabulary = means.vocabulary.asking([question.name for question in questions])
    inputs = {name: _parsed(name, coding, vocabulary) for name, coding in means.codings.items()}
    encoders = {name: Encoder(coding, Program(inputs[name])) for name, coding in means.codings.items()}
    told = {question.name: _told(question, vocabulary, means.codings) for question in questions}
    seen = {name: frozenset[str]().union(*(t.predictions for t in texts)) for name, texts in inputs.items()}
    needs = {it.name: told[it.name].needs | seen[it.representation] for it in questions}
    depth = {name: level for level, names in enumerate(layers(needs)) for name in names}
    builder = _Builder(questions, means, encoders, told)
    return Assembly(tuple(questions), encoders, builder.units(depth), needs)


class _Builder:
    """Units out of questions that agree in all that a unit shares."""

    def __init__(
        self,
        questions: Sequence[Question],
        means: Means,
        encoders: Mapping[str, Encoder],
        told: Mapping[str, _Told],
    ) -> None:
        self._questions = questions
        self._means = means
        self._encoders = encoders
        self._told = told

    def units(self, depth: Mapping[str, int]) -> tuple[Unit, ...]:
        """In the order in which they are to be learned."""
        keys = [self._key(question, depth[question.name]) for question in self._questions]
        order = sorted(range(len(keys)), key=lambda place: (keys[place], place))
        runs = [(key, list(places)) for key, places in groupby(order, key=lambda place: keys[place])]
        weights = self._weights(runs)
        return tuple(self._unit(key, places, weights.get(key)) for key, places in runs)

    def _key(self, question: Question, depth: int) -> _Key:
        gamma = question.gamma
        varies = isinstance(gamma, str)
        binary = self._means.codings[question.representation].binary
        return _Key(
            depth,
            np.inf if isinstance(gamma, str) or gamma >= 1 else 1 / (1 - gamma),
            question.representation,
            question.algorithm,
            str(gamma) if varies else "",
            question.lam,
            question.step_size,
            bool(question.policy),
            question.estimates.confidence,
            question.estimates.interval,
            binary and question.algorithm in SHARED and not (question.policy or question.options),
            bool(question.guess),
        )

    def _weights(self, runs: Sequence[tuple[_Key, Sequence[int]]]) -> dict[_Key, Weights]:
        """Of each unit that shares a trace, its columns of the one array that its representation has."""
        columns: dict[_Key, Weights] = {}
        for name, coding in self._means.codings.items():
            own = [(key, places) for key, places in runs if key.shares and key.representation == name]
            whole = np.empty((coding.size, sum(len(places) for _, places in own)), dtype=self._means.dtype)
            start = 0
            for key, places in own:
                columns[key] = whole[:, start : start + len(places)]
                start += len(places)
        return columns

    def _unit(self, key: _Key, places: Sequence[int], weights: Weights | None) -> Unit:
        asked = [self._questions[place] for place in places]
        coding, gamma = self._means.codings[key.representation], asked[0].gamma
        constant = None if isinstance(gamma, str) else gamma
        whole = np.array([isinstance(self._told[it.name].cumulant.node, SquaredError) for it in asked])
        scaled = np.array([question.scaled for question in asked])
        discount = Discount(constant, key.lam, scaled, whole if whole.any() else None)
        guesses = Guesses(len(places)) if key.advised else None
        pupils = _alone(asked, coding) if weights is None else self._together(asked, coding, weights)
        program = Program(_texts([self._told[question.name] for question in asked]))
        encoder = self._encoders[key.representation]
        return Unit(
            places,
            encoder,
            program,
            discount,
            pupils,
            Doubts(asked, encoder, pupils, self._means.dtype),
            guesses,
        )

    def _together(self, asked: Sequence[Question], coding: Coding, weights: Weights) -> Pupils:
        initial = np.array([question.initial / coding.active for question in asked])
        weights[:] = initial
        alpha = asked[0].step_size / coding.active
        algorithm: Algorithm = "td" if asked[0].algorithm == "td" else "true_online"
        return Together(Group(weights, initial, algorithm, alpha, self._means.kernel))


def _alone(asked: Sequence[Question], coding: Coding) -> Pupils:
    learners = []
    for question in asked:
        settings = LearnerSettings(
            coding.size, coding.active, question.step_size, question.initial / coding.active, question.options
        )
        try:
            learners.append(registry.open_learner(question.algorithm)(settings))
        except (ValueError, ConfigError) as error:
            raise ConfigError(f"{question.name}: algorithm {question.algorithm}: {error}") from error
    return Alone(learners)


def _texts(told: Sequence[_Told]) -> list[Expression]:
    """What the program of a unit evaluates: cumulants, γ if it varies, policies and initial guesses."""
    gamma = [told[0].gamma] if told[0].gamma else []
    more = [each.policy for each in told if each.policy] + [each.guess for each in told if each.guess]
    return [each.cumulant for each in told] + gamma + more


def _parsed(name: str, coding: Coding, vocabulary: Vocabulary) -> tuple[Expression, ...]:
    return tuple(_expression(f"representation {name}", text, vocabulary) for text in coding.inputs)


def _told(question: Question, vocabulary: Vocabulary, codings: Mapping[str, Coding]) -> _Told:
    name, gamma, policy = question.name, question.gamma, question.policy
    if question.representation not in codings:
        hint = nearest(question.representation, codings)
        raise ConfigError(f"{name}: there is no representation '{question.representation}'{hint}")
    if policy and question.algorithm in registry.ON_POLICY:
        raise ConfigError(
            f"{name}: policy: {question.algorithm} learns on policy only: take gtd or a kind of td"
        )
    return _Told(
        _expression(f"{name}: cumulant", question.cumulant, vocabulary),
        _expression(f"{name}: gamma", gamma, vocabulary) if isinstance(gamma, str) else None,
        _expression(f"{name}: policy", policy, vocabulary) if policy else None,
        _expression(f"{name}: adviser", question.guess, vocabulary) if question.guess else None,
    )


def _expression(where: str, text: str, vocabulary: Vocabulary) -> Expression:
    try:
        return Expression.parse(text, vocabulary)
    except ConfigError as error:
        raise ConfigError(f"{where}: {error}") from error
