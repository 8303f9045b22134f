"""One representation in the course of ticks: its inputs, and its features here and one step before."""

from collections.abc import Mapping
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from bentod.contracts import Features, Vector
from bentod.frames import Value
from bentod.learn.confidence.visits import Visit, Visits
from bentod.learn.paths import below, put_below
from bentod.learn.program import Program
from bentod.learn.scene import Scene


class Coding(Protocol):
    """How values of inputs become features: `bentod.learn.representation`."""

    size: int
    active: float
    binary: bool
    inputs: tuple[str, ...]
    apart: tuple[int, ...]  # features that tell nothing of the state: the bias

    def encode(self, inputs: Vector) -> Features:
        """Indices of the active features, if they are binary."""
        ...

    def dense(self, inputs: Vector) -> Vector:
        """All features, shape (size,)."""
        ...

    def spec(self) -> dict[str, Value]:
        """All that decides what a feature means."""
        ...


class Encoder:
    """Evaluates the inputs of a representation once a tick, and encodes them when somebody asks."""

    def __init__(self, coding: Coding, program: Program) -> None:
        self.coding = coding
        self._program = program
        self._inputs: Vector | None = None
        self._features: Features | None = None
        self._dense: Vector | None = None
        self._tick = -1
        self.before: Features | None = None
        """The active features of the step before; None if that cannot be learned from."""
        self.dense_before: Vector | None = None
        """All features of the step before, if somebody asked for them."""
        self.visits = Visits(coding.size, coding.apart) if coding.binary else None
        self.visit: Visit | None = None
        """What is known of the state that was entered last, if the features are binary."""

    def look(self, scene: Scene) -> bool:
        """Take in this tick, once; whether all inputs are known."""
        if self._tick != scene.answers.tick:
            self._tick = scene.answers.tick
            bridged = self._inputs is not None and scene.steps > 0
            self.before = self._features if bridged else None
            self.dense_before = self._dense if bridged else None
            values = self._program.evaluate(scene.signals, scene.answers, scene.elapsed)
            self._inputs = values if bool(np.isfinite(values).all()) else None
            self._features = self._dense = None
            if self.visits and self._inputs is not None:
                self.visit = self.visits.step(self.features, scene.elapsed)
        return self._inputs is not None

    @property
    def sees(self) -> bool:
        """Whether all inputs of this tick are known."""
        return self._inputs is not None

    @property
    def features(self) -> Features:
        """The active features of this tick, of a binary representation that can see."""
        if self._features is None:
            self._features = self.coding.encode(self._seen())
        return self._features

    @property
    def dense(self) -> Vector:
        """All features of this tick, shape (size,), of a representation that can see."""
        if self._dense is None:
            self._dense = self.coding.dense(self._seen())
        return self._dense

    @property
    def sparse(self) -> tuple[Features, Vector | None]:
        """Those features of this tick that are not 0: where, and their values unless all are 1."""
        if self.coding.binary:
            return self.features, None
        places = np.flatnonzero(self.dense)
        return places, self.dense[places]

    def restart(self) -> None:
        """Forget what came before: the next tick is the first."""
        self._program.restart()
        self._inputs = self._features = self._dense = self.before = self.dense_before = None

    def memory(self) -> dict[str, NDArray[np.float64]]:
        """What the inputs remember, e.g. history traces, and which features were visited."""
        visits = self.visits.memory() if self.visits else {}
        return put_below("inputs", self._program.memory()) | put_below("visits", visits)

    def recall(self, memory: Mapping[str, NDArray[np.float64]]) -> None:
        """Remember it again. Raises ValueError: it is not that of such a representation."""
        self._program.recall(below(memory, "inputs"))
        if self.visits:
            self.visits.recall(below(memory, "visits"))

    def go_on(self, other: "Encoder") -> None:
        """Be where `other` is, which is of the same representation."""
        self.recall(other.memory())
        self._inputs, self._features, self._dense = other._inputs, other._features, other._dense
        self.before, self.dense_before = other.before, other.dense_before
        self.visit, self._tick = other.visit, other._tick

    def _seen(self) -> Vector:
        if self._inputs is None:
            raise ValueError("A representation that cannot see has no features.")
        return self._inputs
