"""All that a mind has learned, as one thing that can be kept and gone on with."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from bentod.assist.help import Help
from bentod.frames import Value
from bentod.learn.horde import Horde
from bentod.learn.paths import below, put_below
from bentod.learn.predictor import Predictor


class Known:
    """What predictors know, and what helps has found out about how and how far to help (`Keepable`)."""

    def __init__(self, predictor: Predictor, helps: Sequence[Help]) -> None:
        self._predictor = predictor
        self._helps = tuple(helps)

    @property
    def horde(self) -> Horde:
        """The questions that are asked now; another one when one comes or goes."""
        return self._predictor.horde

    def spec(self) -> Mapping[str, Value]:
        """That of the questions; what it does not name has none."""
        return self._predictor.spec()

    def memory(self) -> dict[str, NDArray[np.float64]]:
        """Copies of all that has been learned and is remembered."""
        return {name: array for part in self.parts() for name, array in part.items()}

    def parts(self) -> Iterator[dict[str, NDArray[np.float64]]]:
        """The same in parts, each copied when it is asked for: units, representations, choices."""
        yield from self.horde.memories()
        for help_ in self._helps:
            yield put_below(f"assists/{help_.group}", help_.memory())

    def recall(self, spec: Mapping[str, Value], memory: Mapping[str, NDArray[np.float64]]) -> list[str]:
        """Go on with what was learned before; returns the questions that it says nothing of.

        Raises:
            SnapshotError: it was learned from other representations, or is not such a memory.
        """
        new = self._predictor.recall(spec, memory)
        for help_ in self._helps:
            help_.recall(below(memory, f"assists/{help_.group}"))
        return new
