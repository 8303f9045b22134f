"""Support vector machines (Bishop 2006, 7.1), trained by scikit-learn, one for each pair of classes."""

from collections.abc import Mapping, Sequence
from typing import Literal

import numpy as np
from sklearn.model_selection import StratifiedKFold
from sklearn.svm import SVC
from threadpoolctl import threadpool_limits

from bentod.emg.classify.options import Bound, taken
from bentod.emg.classify.pairs import Machine, Pairs, calibrated
from bentod.emg.classify.rows import Codes, Scale, classes
from bentod.emg.recognition import Table

Kernel = Literal["linear", "rbf"]

LINEAR = {"c": Bound(1.0, 1e-4, 1e6)}
RBF = {"c": Bound(10.0, 1e-4, 1e6), "gamma": Bound(0.0, 0.0, 1e4)}  # gamma 0: one over the columns

_FOLDS = 5


def train_linear(table: Table, labels: Sequence[str], options: Mapping[str, float], seed: int = 0) -> Pairs:
    """Straight borders. Raises ConfigError: an option or the rows cannot be used."""
    return _trained("linear", table, labels, taken("svm_linear", LINEAR, options))


def train_rbf(table: Table, labels: Sequence[str], options: Mapping[str, float], seed: int = 0) -> Pairs:
    """Borders by likeness, exp(-gamma |x - v|²). Raises ConfigError: an option or the rows cannot be used."""
    return _trained("rbf", table, labels, taken("svm_rbf", RBF, options))


def _trained(kernel: Kernel, table: Table, labels: Sequence[str], told: Mapping[str, float]) -> Pairs:
    names, codes = classes(table, labels)
    gamma = told.get("gamma") or 1 / table.shape[1]
    machine = _machine(kernel, table, codes, told["c"], gamma)
    held_out = np.empty((len(table), len(machine.bias)))
    # In order of time, not shuffled: windows that share samples would know one another.
    folds = StratifiedKFold(min(_FOLDS, int(np.bincount(codes).min())))
    for known, asked in folds.split(table, codes):
        held_out[asked] = _machine(kernel, table[known], codes[known], told["c"], gamma).decisions(
            table[asked]
        )
    return Pairs(names, machine, calibrated(held_out, codes, len(names)))


def _machine(kernel: Kernel, table: Table, codes: Codes, c: float, gamma: float) -> Machine:
    scale = Scale.of(table)
    with threadpool_limits(1):
        found = SVC(kernel=kernel, C=c, gamma=gamma, decision_function_shape="ovo").fit(
            scale.scaled(table), codes
        )
    # Of two classes scikit-learn turns the sign, so that it is above 0 for the second.
    sign = -1.0 if len(found.classes_) == 2 else 1.0
    bias = sign * np.asarray(found.intercept_, np.float64)
    if kernel == "linear":
        return Machine(scale, sign * np.asarray(found.coef_, np.float64), bias)
    vectors = np.ascontiguousarray(found.support_vectors_, np.float64)
    return Machine(scale, sign * _by_pair(found), bias, vectors, gamma)


def _by_pair(found: SVC) -> Table:
    """Coefficients of every support vector in every pair, shape (pairs, vectors), 0 where it has none.

    libsvm keeps those of a vector of class i against class j in row j - 1 if j is above i, else in row j.
    """
    edges = np.cumsum([0, *found.n_support_])
    first, second = np.triu_indices(len(found.classes_), 1)
    weights = np.zeros((len(first), edges[-1]))
    for pair, (one, other) in enumerate(zip(first, second, strict=True)):
        own, others = slice(edges[one], edges[one + 1]), slice(edges[other], edges[other + 1])
        weights[pair, own] = found.dual_coef_[other - 1, own]
        weights[pair, others] = found.dual_coef_[one, others]
    return weights
