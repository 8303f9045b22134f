"""A classifier that is one matrix product; NumPy is all it needs."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from bentod.emg.classify.rows import Arrays, fitting, products, softmax, wanted
from bentod.emg.recognition import Table


class Linear:
    """Probabilities are the softmax of W x + b."""

    def __init__(
        self, labels: tuple[str, ...], weights: NDArray[np.float64], bias: NDArray[np.float64]
    ) -> None:
        """`weights`: shape (labels, columns); `bias`: shape (labels,)."""
        self.labels = labels
        self._weights, self._bias = np.ascontiguousarray(weights), bias

    def probabilities(self, table: Table) -> Table:
        """See `Classifier`."""
        return softmax(products(self._weights, table) + self._bias)

    def arrays(self) -> Mapping[str, NDArray[np.float64]]:
        """W and b."""
        return {"weights": self._weights, "bias": self._bias}


def restore(labels: tuple[str, ...], arrays: Arrays) -> Linear:
    """What `arrays` told. Raises SnapshotError: it is not that of such a classifier."""
    weights, bias = wanted(arrays, weights=2, bias=1)
    fitting("weights", weights, (len(labels), weights.shape[1]))
    fitting("bias", bias, (len(labels),))
    return Linear(labels, weights, bias)
