"""The learners that a config asks for, from readings to predictions, and what may change meanwhile."""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bentod.config_learn import Gvf, Learn
from bentod.errors import BadRequest, ConfigError, SnapshotError, nearest
from bentod.frames import JointSpec, LearnFrame, Value
from bentod.learn.advice import Advised
from bentod.learn.adviser import open_adviser
from bentod.learn.assembly import Assembly, Means, assembled
from bentod.learn.expression import Vocabulary
from bentod.learn.horde import HasTime, Horde, Memory
from bentod.learn.kernel import choose
from bentod.learn.question import Question
from bentod.learn.questions import MOST, expand, questions_of
from bentod.learn.representation import codings
from bentod.learn.signals import Percept, Signals
from bentod.learn.told import Teller

LONGEST = 3
"""Ticks that one step of learning may span: two missed ones. A longer hole is not bridged but cut."""

PROBATION = 900
"""Ticks for which nothing follows a learner that began anew, diverged or told to: 30 s at 30 Hz."""

MOST_WEIGHTS = 1 << 28
"""Of all questions together, past ones of intervals included: 2 GiB of float64."""


@dataclass(frozen=True, slots=True)
class Body:
    """What there is to be learned about."""

    specs: Sequence[JointSpec]
    sites: Sequence[str]  # of muscle signals
    groups: Mapping[str, Sequence[str]]  # names of joints, by group
    rate_hz: float
    classes: Sequence[str] = ()  # of recognised contractions


def position_at(joint: str, timescale: float) -> str:
    """The name of the question where `joint` will be, `timescale` ticks ahead."""
    return f"{joint}.position@{timescale:g}"


class Predictor:
    """General value functions over the signals of a body; some from the config, others come and go."""

    def __init__(self, body: Body, learn: Learn) -> None:
        """Raises ConfigError: a question is not one."""
        self._body = body
        signals = Signals(body.specs, body.sites, body.groups, body.classes)
        self._signals = Advised(signals, [open_adviser(table, signals) for table in learn.advisers])
        self._means = Means(
            Vocabulary(self._signals, learn.define),
            codings(learn, body.specs, self._signals),
            choose(learn.kernel),
            np.float32 if learn.precision == "float32" else np.float64,
        )
        timescales = learn.timescales if learn.joints else ()
        self._apart = frozenset(position_at(spec.name, t) for spec in body.specs for t in timescales)
        self._first = expand(learn, body.specs, self._signals, body.rate_hz)
        self._install(Horde(self._assembled(self._first)))
        self._due = math.nan
        self._seen_by = self.horde
        self._resets: dict[str, int] = {}
        self._anew: list[str] = []
        self._on_probation: dict[str, int] = {}  # the tick in which a question's learner began anew

    @property
    def kernel(self) -> str:
        """What updates the shared weights."""
        return self._means.kernel.name

    @property
    def advice(self) -> Advised:
        """What is perceived, and what its advisers say of it."""
        return self._signals

    @property
    def shed(self) -> int:
        """Updates left out for lack of time."""
        return self.horde.shed

    def see(self, percept: Percept) -> None:
        """Begin a tick."""
        self._seen_by = self.horde
        elapsed = self._elapsed(percept)
        if elapsed < 1:
            self.restart()
        bridged = 1 <= elapsed <= LONGEST and not (percept.gap and elapsed == 1)
        self._due = percept.due
        steps = elapsed if bridged else 0
        self.horde.begin(percept.tick, self._signals.read(percept, max(elapsed, 1)), max(elapsed, 1), steps)

    def step(self, has_time: HasTime, names: Collection[str] | None = None) -> None:
        """Learn and predict what has not been in this tick: `names` and all they need, or (None) all."""
        self.horde.step(has_time, names)
        now = self.horde.resets()
        if now != self._resets:
            anew = [name for name, count in now.items() if count > self._resets.get(name, 0)]
            self._resets = now
            self._anew += anew
            self._on_probation |= dict.fromkeys(anew, self.horde.answers.tick)

    def restart(self) -> None:
        """What comes next has nothing to do with what came before; what was learned stays."""
        self._signals.restart()
        self.horde.restart()

    def fresh(self, name: str) -> float:
        """The prediction `name` if it was made in this tick, by a learner that can be followed; else NaN.

        One that diverged and began anew answers with what it was told at first, which nobody should follow.
        """
        if self.horde.answers.tick - self._on_probation.get(name, -PROBATION) < PROBATION:
            return math.nan
        return self.horde.answers.fresh(name)

    def newest(self, name: str) -> float:
        """The newest prediction `name`; NaN if there is none."""
        return self.horde.answers.newest(name)

    def confidence(self, name: str) -> float:
        """C of the prediction `name` in this tick; NaN where nobody estimates it."""
        return self.horde.answers.now(name, self.horde.answers.confidence)

    def surprise(self, name: str) -> float:
        """Z of the prediction `name` in this tick; NaN if nobody asks it."""
        return self.horde.answers.now(name, self.horde.answers.surprise)

    def familiarity(self, representation: str) -> float:
        """How well a state like this one is known, 0..1; NaN where nobody counts."""
        encoder = self.horde.encoders.get(representation)
        return encoder.visit.familiarity if encoder and encoder.visit else math.nan

    @property
    def changed(self) -> bool:
        """Whether other questions are asked than in the newest tick."""
        return self.horde is not self._seen_by

    def add(self, *tables: Gvf, most: int = MOST) -> tuple[str, ...]:
        """Ask more from the next tick on, and go on undisturbed with all else; returns the names.

        `most`: questions that each table may stand for.

        Raises:
            BadRequest: that cannot be asked.
        """
        try:
            rate = self._body.rate_hz
            families = [questions_of(table, self._signals, rate, most=most) for table in tables]
            more = tuple(question for family in families for question in family)
            taken = {question.name for question in self.horde.questions}
            if twice := [question.name for question in more if question.name in taken]:
                raise ConfigError(f"there is a GVF '{twice[0]}' already")
            if own := [question.name for question in more if question.name in self._apart]:
                raise ConfigError(f"assists take '{own[0]}' for the arm's own: choose another name")
            self._replace((*self.horde.questions, *more))
        except ConfigError as error:
            raise BadRequest(str(error), "gvf") from error
        return tuple(question.name for question in more)

    def remove(self, names: Collection[str]) -> None:
        """Ask no more. Raises BadRequest: there is no such question, or it is needed."""
        known = self.known(names)
        if kept := known & self._apart:
            raise BadRequest(f"{min(kept)} is the arm's own and stays, for the assist may follow it", "name")
        rest = tuple(question for question in self.horde.questions if question.name not in known)
        for question in rest:
            if missing := self.horde.needs(question.name) & known:
                raise BadRequest(f"{question.name} is made from {min(missing)}: remove it first", "name")
        self._replace(rest)

    def reset(self, names: Collection[str]) -> None:
        """Begin anew with some questions, as if nothing had been learned. Raises BadRequest: none such."""
        known = self.known(names)
        self._install(self.horde)
        self.horde.reset(known)
        self._on_probation |= dict.fromkeys(sorted(known), self.horde.answers.tick)

    def known(self, names: Collection[str]) -> frozenset[str]:
        """`names`, all of which are asked. Raises BadRequest: one is not."""
        asked = [question.name for question in self.horde.questions]
        for name in names:
            if name not in asked:
                raise BadRequest(f"there is no GVF '{name}'{nearest(name, asked)}", "name")
        return frozenset(names)

    def frame(self) -> LearnFrame:
        """What is to be told of this tick."""
        return self._teller.frame()

    def describe(self) -> list[dict[str, Value]]:
        """Every question, and how well it is answered, for clients."""
        return self._teller.describe()

    def begun_anew(self) -> list[str]:
        """Questions whose learners had to begin anew since the last call, because they had diverged."""
        anew, self._anew = self._anew, []
        return anew

    def spec(self) -> dict[str, Value]:
        """All that decides what the memory means."""
        return self.horde.spec() | {"rate_hz": self._body.rate_hz}

    def memory(self) -> dict[str, NDArray[np.float64]]:
        """Copies of all that has been learned and is remembered."""
        return self.horde.memory()

    def recall(self, spec: Mapping[str, Value], memory: Memory) -> list[str]:
        """Go on with what was learned before; returns the questions that it says nothing of.

        Raises:
            SnapshotError: it was learned at another rate or from other representations, or is none. Then
                nothing is known, of any question.
        """
        rate = spec.get("rate_hz", self._body.rate_hz)
        if rate != self._body.rate_hz:
            raise SnapshotError(
                f"it was learned at {rate!r} Hz, and a tick is another time at {self._body.rate_hz:g}"
            )
        try:
            new = self.horde.recall(spec, memory)
        except SnapshotError:
            self._install(Horde(self._assembled(self.horde.questions)))
            raise
        self._resets = self.horde.resets()
        return new

    def _elapsed(self, percept: Percept) -> int:
        """Ticks since the last one that was seen; 0 if there was none, or time went back."""
        if not self._due < percept.due:
            return 0
        return min(round((percept.due - self._due) * self._body.rate_hz), 1_000_000)

    def _replace(self, questions: Sequence[Question]) -> None:
        horde = Horde(self._assembled(questions))
        horde.succeed(self.horde)
        self._install(horde)
        self._resets = horde.resets()

    def _install(self, horde: Horde) -> None:
        self.horde = horde
        self._teller = Teller(horde, self._apart)

    def _assembled(self, questions: Sequence[Question]) -> Assembly:
        sizes = {name: coding.size for name, coding in self._means.codings.items()}
        weights = sum(sizes.get(it.representation, 0) * (1 + it.estimates.interval) for it in questions)
        if weights > MOST_WEIGHTS:
            raise ConfigError(
                f"{len(questions)} GVFs need {weights:,} weights; the bound is {MOST_WEIGHTS:,}"
            )
        return assembled(questions, self._means)
