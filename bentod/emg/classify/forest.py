"""A forest of decision trees in flat arrays, walked all trees at once; NumPy is all it needs."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from bentod.emg.classify.rows import Arrays, fitting, wanted
from bentod.emg.recognition import Table
from bentod.errors import SnapshotError

_AT_ONCE = 256
"""Windows that are walked together, so that a whole recording does not fill the memory."""


class Forest:
    """The mean of what the trees say.

    A node sends a row to `low` if its `column` is not above `bound`, else to `high`; a leaf sends it to
    itself. So all trees are walked by as many steps as the deepest has.
    """

    def __init__(self, labels: tuple[str, ...], arrays: Arrays) -> None:
        """`arrays`: as `arrays()` tells them, checked by whoever calls."""
        self.labels = labels
        self._arrays = dict(arrays)
        self._roots, self._column = arrays["roots"].astype(np.intp), arrays["column"].astype(np.intp)
        # Column 0 is what a row goes to if it is not above the bound: one look-up takes the step.
        self._next = np.column_stack([arrays["low"], arrays["high"]]).astype(np.intp).reshape(-1)
        self._bound, self._shares = arrays["bound"], arrays["shares"]
        self._steps, self._columns = int(arrays["steps"][0]), int(arrays["columns"][0])

    def probabilities(self, table: Table) -> Table:
        """See `Classifier`. Raises ValueError: the rows are of another length than in training."""
        if table.shape[1] != self._columns:
            raise ValueError(f"rows of {table.shape[1]} columns for a forest of {self._columns}")
        # scikit-learn learns the bounds on, and compares, single precision.
        rows = table.astype(np.float32).astype(np.float64)
        pieces = [self._mean(rows[k : k + _AT_ONCE]) for k in range(0, len(rows), _AT_ONCE)]
        return np.concatenate([np.empty((0, len(self.labels))), *pieces])

    def _mean(self, rows: Table) -> Table:
        base = np.arange(len(rows))[:, None] * rows.shape[1]
        flat = rows.reshape(-1)
        nodes = np.broadcast_to(self._roots, (len(rows), len(self._roots)))
        for _ in range(self._steps):
            above = flat[self._column[nodes] + base] > self._bound[nodes]
            nodes = self._next[2 * nodes + above]
        return np.stack([np.add.reduce(self._shares[walked], axis=0) for walked in nodes]) / len(self._roots)

    def arrays(self) -> Mapping[str, NDArray[np.float64]]:
        """Roots, nodes and the shares of classes in leaves."""
        return self._arrays


def restore(labels: tuple[str, ...], arrays: Arrays) -> Forest:
    """What `arrays` told. Raises SnapshotError: it is not that of such a classifier."""
    column, bound, low, high = wanted(arrays, column=1, bound=1, low=1, high=1)
    roots, shares, steps, columns = wanted(arrays, roots=1, shares=2, steps=1, columns=1)
    for name, array in (("bound", bound), ("low", low), ("high", high)):
        fitting(name, array, column.shape)
    fitting("shares", shares, (len(column), len(labels)))
    fitting("steps", steps, (1,))
    fitting("columns", columns, (1,))
    nodes = np.concatenate([roots, low, high])
    inside = (
        (nodes >= 0).all()
        and (nodes < len(column)).all()
        and (column >= 0).all()
        and (column < columns[0]).all()
    )
    if not len(roots) or not inside or not 0 <= steps[0] <= len(column):
        raise SnapshotError("its trees lead to nodes that it does not have")
    return Forest(labels, arrays)
