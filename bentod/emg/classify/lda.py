"""Linear discriminant analysis (Bishop 2006, 4.1), trained by scikit-learn and kept as one matrix."""

import warnings
from collections.abc import Mapping, Sequence

import numpy as np
from sklearn.discriminant_analysis import LinearDiscriminantAnalysis
from threadpoolctl import threadpool_limits

from bentod.emg.classify.linear import Linear
from bentod.emg.classify.options import Bound, taken
from bentod.emg.classify.rows import Scale, classes
from bentod.emg.recognition import Table

OPTIONS = {"shrinkage": Bound(0.0, 0.0, 1.0)}
"""How far the common covariance is drawn to equal, uncorrelated columns (of unit deviation)."""


def train(table: Table, labels: Sequence[str], options: Mapping[str, float], seed: int = 0) -> Linear:
    """The usual kind: every class has the same covariance, and is as likely as its share of rows.

    Raises:
        ConfigError: an option or the rows cannot be used.
    """
    shrinkage = taken("lda", OPTIONS, options)["shrinkage"]
    return _fitted(table, labels, shrinkage or None)


def train_shrunk(table: Table, labels: Sequence[str], options: Mapping[str, float], seed: int = 0) -> Linear:
    """With as much shrinkage as the rows call for (Ledoit and Wolf 2004): for many columns and few rows.

    Raises:
        ConfigError: an option or the rows cannot be used.
    """
    taken("lda_shrunk", {}, options)
    return _fitted(table, labels, "auto")


def _fitted(table: Table, labels: Sequence[str], shrinkage: float | str | None) -> Linear:
    names, codes = classes(table, labels)
    scale = Scale.of(table)
    solver = "svd" if shrinkage is None else "lsqr"
    with threadpool_limits(1), warnings.catch_warnings():
        # The decomposition drops directions without scatter by itself: a constant column is one.
        warnings.filterwarnings("ignore", "Variables are collinear", UserWarning)
        found = LinearDiscriminantAnalysis(solver=solver, shrinkage=shrinkage).fit(scale.scaled(table), codes)
    weights, bias = np.asarray(found.coef_, np.float64), np.asarray(found.intercept_, np.float64)
    if len(names) == 2:  # scikit-learn keeps only the difference of the two
        weights, bias = np.vstack([np.zeros_like(weights), weights]), np.append(0.0, bias)
    weights = weights / scale.deviation
    return Linear(names, weights, bias - weights @ scale.mean)
