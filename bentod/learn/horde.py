"""Many general value functions, learned on line in the control tick: where to read how it is done first."""

from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import fields
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from bentod.contracts import Vector
from bentod.errors import SnapshotError
from bentod.frames import Value
from bentod.learn.answers import Answers
from bentod.learn.assembly import Assembly
from bentod.learn.differences import by_name, differences
from bentod.learn.encoder import Encoder
from bentod.learn.paths import below, put_below
from bentod.learn.question import Estimates, Question
from bentod.learn.scene import Scene
from bentod.learn.succession import Heritage, succeed
from bentod.learn.unit import Unit

HasTime: TypeAlias = Callable[[], bool]
"""Whether there is time left to learn."""

Memory: TypeAlias = Mapping[str, NDArray[np.float64]]

_KEYS = tuple(field.name for field in fields(Question))
_ESTIMATES = tuple(field.name for field in fields(Estimates))


def unhurried() -> bool:
    """There is time."""
    return True


class Horde:
    """Answers all questions of an assembly, tick by tick.

    A tick is `begin`, then `step` for the questions that somebody waits for, then `step` for the rest. A
    question follows those whose predictions it is made from, and then the shortest horizon comes first.
    Once `has_time` says no, the units that are left learn nothing from this tick: they forget the step
    before, so that none is learned from twice or across a gap, and predict with what they know.
    """

    def __init__(self, assembly: Assembly) -> None:
        self._assembly = assembly
        self.answers = Answers([question.name for question in assembly.questions])
        self.shed = 0
        """How often a unit was left to predict without learning, because there was no time."""
        self._scene = Scene(np.empty(0), self.answers, 1, 0)
        self._waiting: list[Unit] = []
        self._units_for: dict[frozenset[str], list[Unit]] = {}

    @property
    def questions(self) -> tuple[Question, ...]:
        """What is asked, in the order of all arrays."""
        return self._assembly.questions

    @property
    def units(self) -> tuple[Unit, ...]:
        """What learns in one go, in the order of learning; `shed` counts these."""
        return self._assembly.units

    def needs(self, name: str) -> frozenset[str]:
        """The questions whose predictions the question `name` is made from."""
        return self._assembly.needs[name]

    def resets(self) -> dict[str, int]:
        """How often learners had to begin anew, of those that had to."""
        counts = [(unit, unit.pupils.resets) for unit in self.units]
        return {
            name: int(count)
            for unit, resets in counts
            if resets.any()
            for name, count in zip(self._names(unit), resets.tolist(), strict=True)
        }

    def begin(self, tick: int, signals: Vector, elapsed: int, steps: int) -> None:
        """A new tick, `elapsed` after the last; `steps`: the same, or 0 if learning cannot span them."""
        self.answers.begin(tick)
        self._scene = Scene(signals, self.answers, elapsed, steps)
        self._waiting = list(self.units)

    def step(self, has_time: HasTime = unhurried, names: Collection[str] | None = None) -> None:
        """Learn, then predict, what has not been in this tick: `names` and all they are made from, or all."""
        due = self._waiting if names is None else self._needed(names)
        for unit in due:
            learn = has_time()
            self.shed += not learn
            unit.step(self._scene, learn)
        self._waiting = [unit for unit in self._waiting if unit not in due]

    def restart(self) -> None:
        """What comes next has nothing to do with what came before; what was learned stays."""
        for encoder in self._assembly.encoders.values():
            encoder.restart()
        for unit in self.units:
            unit.restart()

    def reset(self, names: Collection[str]) -> None:
        """Begin anew with the questions `names`."""
        for unit in self.units:
            columns = [c for c, place in enumerate(unit.places) if self.questions[place].name in names]
            if columns:
                unit.reset(columns)

    def spec(self) -> dict[str, Value]:
        """All that decides what the memory means."""
        codings: dict[str, Value] = {
            name: encoder.coding.spec() for name, encoder in self._assembly.encoders.items()
        }
        return {
            "questions": [plain(question) for question in self.questions],
            "representations": codings,
            "units": [list[Value](self._names(unit)) for unit in self.units],
        }

    def memory(self) -> dict[str, NDArray[np.float64]]:
        """Copies of all that has been learned and is remembered."""
        return {name: array for part in self.memories() for name, array in part.items()}

    def memories(self) -> Iterator[dict[str, NDArray[np.float64]]]:
        """The same in parts, each copied when it is asked for: they are units and representations."""
        for place, unit in enumerate(self.units):
            yield put_below(f"units/{place}", unit.memory())
        for name, encoder in self._assembly.encoders.items():
            yield put_below(f"representations/{name}", encoder.memory())

    def recall(self, spec: Mapping[str, Value], memory: Memory) -> list[str]:
        """Go on with what was learned before; returns the questions of which nothing was, which begin anew.

        Raises:
            SnapshotError: it was learned from other representations, and the sentence says what differs; or
                it is not such a memory. This horde may then know some of it.
        """
        questions, codings, units = (
            by_name(spec.get("questions")) or {},
            spec.get("representations"),
            spec.get("units"),
        )
        if unlike := differences(
            {"representations": self.spec()["representations"]}, {"representations": codings}
        ):
            raise SnapshotError("; ".join(unlike))
        known = frozenset(it.name for it in self.questions if plain(it) == questions.get(it.name))
        asked = (
            [list(map(str, names)) for names in units if isinstance(names, list)]
            if isinstance(units, list)
            else []
        )
        try:
            new = self._inherit(Heritage.of(asked, below(memory, "units")), known)
            for name, encoder in self._assembly.encoders.items():
                encoder.recall(below(memory, f"representations/{name}"))
        except (ValueError, LookupError, ArithmeticError) as error:
            raise SnapshotError(f"it does not hold what it says: {error}") from error
        return new

    def succeed(self, other: "Horde") -> None:
        """Go on with the tick of `other`, and where it is with questions that are the same; it is used up."""
        asked = {question.name: question for question in other.questions}
        known = frozenset(it.name for it in self.questions if asked.get(it.name) == it)
        elders = [(other._names(unit), unit) for unit in other.units]
        for unit in self.units:
            succeed(unit, self._names(unit), elders, known)
        for name, encoder in self._assembly.encoders.items():
            encoder.go_on(other._assembly.encoders[name])
        self.answers.take_over(other.answers, known)
        self.shed = other.shed

    @property
    def encoders(self) -> Mapping[str, Encoder]:
        """Each representation, as it sees the newest tick."""
        return self._assembly.encoders

    def _inherit(self, heritage: Heritage, known: frozenset[str]) -> list[str]:
        return [name for unit in self.units for name in heritage.hand_on(unit, self._names(unit), known)]

    def _names(self, unit: Unit) -> list[str]:
        return [self.questions[place].name for place in unit.places.tolist()]

    def _needed(self, names: Collection[str]) -> list[Unit]:
        """Units that are waiting and answer `names`, with all that others in these units are made from."""
        key = frozenset(names)
        if key not in self._units_for:
            self._units_for = {key: self._found(names)}  # the same names are asked for in tick after tick
        needed = self._units_for[key]
        return [unit for unit in self._waiting if unit in needed]

    def _found(self, names: Collection[str]) -> list[Unit]:
        places: frozenset[int] = frozenset()
        units: list[Unit] = []
        found = self._assembly.closure(names)
        while found != places:
            places = found
            units = [unit for unit in self.units if not places.isdisjoint(unit.places.tolist())]
            found = self._assembly.closure([name for unit in units for name in self._names(unit)])
        return units


def plain(question: Question) -> dict[str, Value]:
    """A question as data; equal data, equal questions."""
    told: dict[str, Value] = {name: getattr(question, name) for name in _KEYS}
    estimates = {name: getattr(question.estimates, name) for name in _ESTIMATES}
    told |= {"options": dict[str, Value](question.options), "estimates": estimates}
    if not question.guess:
        del told["guess"]  # as in snapshots from before there were advisers
    return told
