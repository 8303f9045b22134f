"""What was learned elsewhere, in simulation or by other arms, and answers here without learning any more.

Thesis 4.6.1, Figure 4.8: general value functions that were learned elsewhere advise those that learn here.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from pydantic import ValidationError

from bentod.config_learn import AdviserTable, RepresentationTable
from bentod.contracts import Vector
from bentod.errors import ConfigError, SnapshotError, nearest
from bentod.frames import Value
from bentod.learn.answers import Answers
from bentod.learn.differences import by_name
from bentod.learn.encoder import Encoder
from bentod.learn.expression import Expression, Vocabulary
from bentod.learn.program import Program
from bentod.learn.representation import StateCoding, state_coding
from bentod.learn.scene import Scene
from bentod.learn.signals import Named
from bentod.learn.snapshot import Snapshot, read
from bentod.learn.topology import layers


@dataclass(frozen=True, slots=True)
class _Expert:
    """One question that can be answered: the last weights, over a representation of its own time."""

    encoder: Encoder
    weights: Vector  # shape (features,)

    def answer(self) -> float:
        """wᵀφ here; NaN where an input is not known."""
        encoder = self.encoder
        if not encoder.sees:
            return float("nan")
        if encoder.coding.binary:
            return float(self.weights[encoder.features].sum())
        return float(encoder.dense @ self.weights)


class Adviser:
    """The questions of a snapshot, answered from what is perceived here with the weights as they were.

    Its representations keep the ranges of the arm that they were learned on. A question that cannot be
    answered here, e.g. because this arm lacks a signal, is refused only when somebody asks for it.
    """

    def __init__(self, name: str, snapshot: Snapshot, signals: Named) -> None:
        """Raises SnapshotError: it does not hold what learners keep."""
        self.name = name
        self.digest = snapshot.digest
        self._tables = by_name(snapshot.spec.get("questions")) or {}
        self.names = tuple(self._tables)
        """Of its questions, in the order of `answer`."""
        self._refused: dict[str, str] = {}
        self._answers = Answers(self.names)
        weights = _weights(snapshot)
        codings = by_name(snapshot.spec.get("representations")) or {}
        vocabulary = Vocabulary(signals).asking(self.names)
        self._seen = {key: self._opened(key, told, vocabulary) for key, told in codings.items()}
        self._experts = self._ordered(weights)
        self._inner = frozenset[str]().union(*(needs for _, needs in self._seen.values()))
        self._wanted: set[str] = set()

    def want(self, question: str) -> int:
        """The place in `answer` of a question, which is answered from now on.

        Raises:
            ConfigError: it is none of the snapshot's, or cannot be answered here.
        """
        if question not in self._tables:
            raise ConfigError(f"the adviser '{self.name}' does not know '{question}'{self._known(question)}")
        if question not in self._experts:
            raise ConfigError(f"the adviser '{self.name}' cannot answer '{question}': {self._why(question)}")
        self._wanted.add(question)
        return self._answers.place[question]

    def answer(self, tick: int, signals: Vector, elapsed: int) -> Vector:
        """All that is wanted, shape (questions,); NaN: not wanted, or an input is not known."""
        answers = self._answers
        answers.begin(tick)
        answers.value.fill(np.nan)
        scene = Scene(signals, answers, elapsed, 0)
        looked: set[int] = set()
        for name, expert in self._experts.items():
            if id(expert.encoder) not in looked:
                looked.add(id(expert.encoder))
                expert.encoder.look(scene)
            if name in self._inner or name in self._wanted:
                place = answers.place[name]
                answers.value[place], answers.made_at[place] = expert.answer(), tick
        return answers.value

    def restart(self) -> None:
        """The next tick is the first."""
        for encoder in {id(it.encoder): it.encoder for it in self._experts.values()}.values():
            encoder.restart()

    def _opened(self, key: str, told: Value, vocabulary: Vocabulary) -> tuple[Encoder | None, frozenset[str]]:
        """A representation, and the questions that it is made from; None if there is none such here."""
        try:
            coding = _coding(told, vocabulary)
            inputs = [Expression.parse(text, vocabulary) for text in coding.inputs]
            if any("delta2(" in str(it) for it in inputs):
                raise ConfigError("it is made from errors of learning, and an adviser does not learn")
        except (ConfigError, ValidationError) as error:
            self._refused[key] = f"its representation {key} cannot be made here: {error}"
            return None, frozenset()
        return Encoder(coding, Program(inputs)), frozenset[str]().union(*(it.predictions for it in inputs))

    def _ordered(self, weights: Mapping[str, Vector]) -> dict[str, _Expert]:
        """Those who can answer, each after all that its representation is made from."""
        needs = {
            name: self._seen[self._over(name)][1] for name in self.names if self._over(name) in self._seen
        }
        found: dict[str, _Expert] = {}
        for name in (name for layer in layers(needs) for name in layer):
            encoder, needed = self._seen[self._over(name)]
            if encoder is None or not needed <= found.keys() or self._key(name, "guess"):
                continue
            if name not in weights or weights[name].shape != (encoder.coding.size,):
                raise SnapshotError(f"it has no weights for '{name}' over {encoder.coding.size} features")
            found[name] = _Expert(encoder, weights[name])
        return found

    def _why(self, question: str) -> str:
        if self._key(question, "guess"):
            return "it adds to what an adviser of its own said"
        return self._refused.get(self._over(question), "it is made from others that cannot be answered")

    def _over(self, question: str) -> str:
        return self._key(question, "representation")

    def _key(self, question: str, key: str) -> str:
        table = self._tables[question]
        return str(table.get(key, "")) if isinstance(table, dict) else ""

    def _known(self, question: str) -> str:
        return nearest(question, self.names) if len(self.names) < 20 else ""


def open_adviser(table: AdviserTable, signals: Named) -> Adviser:
    """The adviser that a table of the config describes.

    Raises:
        ConfigError: its snapshot is not there, not whole, or another one than that of the table.
    """
    where = f"learn.advisers.{table.name}"
    try:
        snapshot = read(table.snapshot)
        if table.digest and snapshot.digest != table.digest:
            raise SnapshotError(
                f"{table.snapshot}: is another snapshot than that which was used "
                f"({snapshot.digest[:12]}, not {table.digest[:12]}): put that one back in its place"
            )
        return Adviser(table.name, snapshot, signals)
    except SnapshotError as error:
        raise ConfigError(f"{where}.snapshot: {error}") from error


def _coding(told: Value, vocabulary: Vocabulary) -> StateCoding:
    """The representation that a snapshot describes. Raises ConfigError, ValidationError: not here."""
    described = {key: told[key] for key in ("bias", "tiles", "raw")} if isinstance(told, dict) else {}
    coding = state_coding(
        RepresentationTable.model_validate({"name": "adviser", **described}), vocabulary, "snapshot"
    )
    if coding.spec() != told:
        raise ConfigError("it would mean something else than where it was learned")
    return coding


def _weights(snapshot: Snapshot) -> dict[str, Vector]:
    """By question. Raises SnapshotError: they are not there."""
    units = snapshot.spec.get("units")
    found: dict[str, Vector] = {}
    for place, names in enumerate(units if isinstance(units, list) else []):
        array = snapshot.arrays.get(f"units/{place}/pupils/weights")
        if not isinstance(names, list) or array is None or array.shape[1:] != (len(names),):
            raise SnapshotError(f"it does not hold the weights of its unit {place}")
        for column, name in enumerate(names):
            found[str(name)] = array[:, column].astype(np.float64)
    return found
