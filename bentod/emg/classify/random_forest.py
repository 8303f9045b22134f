"""Random forests (Breiman 2001), trained by scikit-learn and kept as flat arrays."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from sklearn.ensemble import RandomForestClassifier
from sklearn.tree import DecisionTreeClassifier
from threadpoolctl import threadpool_limits

from bentod.emg.classify.forest import Forest
from bentod.emg.classify.options import Bound, taken
from bentod.emg.classify.rows import classes
from bentod.emg.recognition import Table

OPTIONS = {
    "trees": Bound(100, 1, 1000, whole=True),
    "depth": Bound(0, 0, 64, whole=True),  # 0: as deep as it takes
    "leaf": Bound(1, 1, 100, whole=True),  # fewest rows in a leaf
}


def train(table: Table, labels: Sequence[str], options: Mapping[str, float], seed: int) -> Forest:
    """Trees of rows drawn by `seed`. Raises ConfigError: an option or the rows cannot be used."""
    told = {name: int(value) for name, value in taken("random_forest", OPTIONS, options).items()}
    names, codes = classes(table, labels)
    found = RandomForestClassifier(
        told["trees"],
        max_depth=told["depth"] or None,
        min_samples_leaf=told["leaf"],
        random_state=seed,
        n_jobs=1,
    )
    with threadpool_limits(1):
        found.fit(table, codes)
    return Forest(names, _flat(found.estimators_))


def _flat(
    trees: Sequence[DecisionTreeClassifier],
) -> dict[str, NDArray[np.float64]]:
    """All trees in one another's row, nodes counted on."""
    parts = [tree.tree_ for tree in trees]
    starts = np.cumsum([0, *(part.node_count for part in parts)])
    low, high = [], []
    for part, start in zip(parts, starts, strict=False):
        own = np.arange(part.node_count)
        leaf = part.children_left < 0
        low.append(start + np.where(leaf, own, part.children_left))
        high.append(start + np.where(leaf, own, part.children_right))
    columns = np.concatenate([np.maximum(part.feature, 0) for part in parts])
    shares = np.concatenate([part.value[:, 0, :] for part in parts])
    arrays = {
        "roots": starts[:-1],
        "column": columns,
        "bound": np.concatenate([part.threshold for part in parts]),
        "low": np.concatenate(low),
        "high": np.concatenate(high),
        "shares": shares / shares.sum(axis=1, keepdims=True),
        "steps": np.array([max(part.max_depth for part in parts)]),
        "columns": np.array([parts[0].n_features]),
    }
    return {name: np.ascontiguousarray(array, np.float64) for name, array in arrays.items()}
