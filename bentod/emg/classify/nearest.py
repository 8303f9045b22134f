"""The k nearest neighbours (Bishop 2006, 2.5.2); NumPy is all they need."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from bentod.emg.classify.options import Bound, taken
from bentod.emg.classify.rows import Arrays, Codes, Scale, classes, fitting, squares, wanted
from bentod.emg.recognition import Table
from bentod.errors import ConfigError, SnapshotError

OPTIONS = {"neighbours": Bound(5, 1, 100, whole=True)}


class Nearest:
    """A class is as likely as its share of the k nearest training rows, in standardised columns."""

    def __init__(
        self, labels: tuple[str, ...], scale: Scale, rows: Table, codes: Codes, neighbours: int
    ) -> None:
        """`rows`: of training, standardised; `codes`: which label each has."""
        self.labels = labels
        self._scale, self._rows, self._codes, self._k = scale, rows, codes, neighbours

    def probabilities(self, table: Table) -> Table:
        """See `Classifier`."""
        counts = np.empty((len(table), len(self.labels)))
        for place, row in enumerate(self._scale.scaled(table)):
            near = np.argpartition(squares(self._rows, row), self._k - 1)[: self._k]
            counts[place] = np.bincount(self._codes[near], minlength=len(self.labels))
        return counts / self._k

    def arrays(self) -> Mapping[str, NDArray[np.float64]]:
        """Every training row."""
        numbers = {"codes": self._codes.astype(np.float64), "neighbours": np.array([float(self._k)])}
        return {**self._scale.arrays(), "rows": self._rows, **numbers}


def train(table: Table, labels: Sequence[str], options: Mapping[str, float], seed: int = 0) -> Nearest:
    """Keep the rows. Raises ConfigError: an option or the rows cannot be used."""
    neighbours = int(taken("knn", OPTIONS, options)["neighbours"])
    names, codes = classes(table, labels)
    if len(table) < neighbours:
        raise ConfigError(
            f"{neighbours} neighbours are asked for, of {len(table)} training rows", "neighbours"
        )
    scale = Scale.of(table)
    return Nearest(names, scale, scale.scaled(table), codes, neighbours)


def restore(labels: tuple[str, ...], arrays: Arrays) -> Nearest:
    """What `arrays` told. Raises SnapshotError: it is not that of such a classifier."""
    rows, codes, neighbours = wanted(arrays, rows=2, codes=1, neighbours=1)
    scale = Scale.restored(arrays)
    fitting("neighbours", neighbours, (1,))
    fitting("codes", codes, (len(rows),))
    fitting("mean", scale.mean, (rows.shape[1],))
    whole = codes.astype(np.intp)
    if not np.isin(codes, np.arange(len(labels))).all() or not 1 <= neighbours[0] <= len(rows):
        raise SnapshotError("its training rows are of classes that it does not have, or too few")
    return Nearest(labels, scale, rows, whole, int(neighbours[0]))
