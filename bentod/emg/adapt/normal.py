"""Linear discriminant analysis that keeps what it is made of, so that it can be changed in use."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from bentod.emg.classify.options import Bound, taken
from bentod.emg.classify.rows import Arrays, Scale, classes, fitting, products, softmax, wanted
from bentod.emg.recognition import Table
from bentod.errors import SnapshotError

OPTIONS = {"shrinkage": Bound(0.0, 0.0, 1.0)}
"""How far the common covariance is drawn to equal, uncorrelated columns (of unit deviation)."""

LEAST_SCATTER = 1e-10
"""Share of the greatest variance below which a direction has none."""

Row = NDArray[np.float64]
"""Shape (columns,)."""


class Normal:
    """Normal classes with one covariance (Bishop 2006, 4.1.5).

    p(c | x) is the softmax of w_c x + b_c, with w_c = Σ⁻¹ μ_c and b_c = −½ μ_cᵀ Σ⁻¹ μ_c + ln π_c.
    """

    def __init__(self, labels: tuple[str, ...], means: Table, precision: Table, logs: Row) -> None:
        """`means`: μ, shape (labels, columns); `precision`: Σ⁻¹; `logs`: ln π, shape (labels,)."""
        self.labels = labels
        self.means, self.precision, self.logs = means, precision, logs
        self._weights = np.ascontiguousarray(means @ precision)
        self._bias = logs - 0.5 * np.einsum("ij,ij->i", self._weights, means)

    def probabilities(self, table: Table) -> Table:
        """See `Classifier`."""
        return softmax(products(self._weights, table) + self._bias)

    def arrays(self) -> Mapping[str, NDArray[np.float64]]:
        """μ, Σ⁻¹ and ln π."""
        return {"means": self.means, "precision": self.precision, "logs": self.logs}

    def moved(self, place: int, mean: Row) -> "Normal":
        """The same with another mean of one class."""
        means = self.means.copy()
        means[place] = mean
        return Normal(self.labels, means, self.precision, self.logs)

    def distances(self, row: Row) -> Row:
        """From `row` to every mean, in standard deviations (Mahalanobis), shape (labels,)."""
        apart = self.means - row
        squares: Row = np.einsum("ij,ij->i", apart @ self.precision, apart)
        return np.sqrt(np.maximum(squares, 0.0))


def train(table: Table, labels: Sequence[str], options: Mapping[str, float], seed: int = 0) -> Normal:
    """The same answers as `lda` gives, which keeps less.

    Raises:
        ConfigError: an option or the rows cannot be used.
    """
    shrinkage = taken("lda_adaptive", OPTIONS, options)["shrinkage"]
    names, codes = classes(table, labels)
    scale = Scale.of(table)
    rows = scale.scaled(table)
    means = np.array([rows[codes == code].mean(axis=0) for code in range(len(names))])
    within = rows - means[codes]
    scatter = np.einsum("ij,ik->jk", within, within) / len(rows)
    scatter = (1 - shrinkage) * scatter + shrinkage * np.trace(scatter) / len(scatter) * np.eye(len(scatter))
    inverse = np.linalg.pinv(scatter, rcond=LEAST_SCATTER, hermitian=True)
    precision = inverse / np.outer(scale.deviation, scale.deviation)
    logs = np.log(np.bincount(codes) / len(codes))
    return Normal(names, means * scale.deviation + scale.mean, precision, logs)


def restore(labels: tuple[str, ...], arrays: Arrays) -> Normal:
    """What `arrays` told. Raises SnapshotError: it is not that of such a classifier."""
    means, precision, logs = wanted(arrays, means=2, precision=2, logs=1)
    fitting("means", means, (len(labels), means.shape[1]))
    fitting("precision", precision, (means.shape[1], means.shape[1]))
    fitting("logs", logs, (len(labels),))
    if not np.allclose(precision, precision.T):
        raise SnapshotError("the array 'precision' is not symmetric")
    return Normal(labels, means, precision, logs)
