"""Predicts with large classifiers and says whether another thread or library had a part in it."""

import sys
from pathlib import Path

import numpy as np

from bentod.emg.classify.kinds import restored

COLUMNS = 1000
LABELS = tuple(f"class {k}" for k in range(12))
PAIRS = len(LABELS) * (len(LABELS) - 1) // 2
TIMES = 60


def main() -> None:
    """Predict, and tell."""
    normal = np.random.default_rng(1).normal
    scale = {"mean": normal(size=COLUMNS), "deviation": np.ones(COLUMNS)}
    rows, one = normal(size=(1000, COLUMNS)), np.ones(1)
    codes = {"codes": np.arange(1000.0) % 12, "neighbours": 5 * one}
    bias = {"bias": normal(size=PAIRS), "slope": one}
    linear = {"weights": normal(size=(PAIRS, COLUMNS)), **bias}
    kernel = {"weights": normal(size=(PAIRS, 1000)), "vectors": rows, "gamma": one * 1e-3, **bias}
    tree = {"column": np.zeros(3), "bound": np.zeros(3), "low": np.array([1.0, 1, 2])}
    leaves = {"high": np.array([2.0, 1, 2]), "roots": np.zeros(100), "steps": one, "columns": one * COLUMNS}
    classifiers = [
        restored("lda", LABELS, {"weights": normal(size=(12, COLUMNS)), "bias": normal(size=12)}),
        restored("knn", LABELS, {**scale, **codes, "rows": rows}),
        restored("svm_linear", LABELS, {**scale, **linear}),
        restored("svm_rbf", LABELS, {**scale, **kernel}),
        restored("random_forest", LABELS, {**tree, **leaves, "shares": normal(size=(3, 12))}),
    ]
    before = others()
    for _ in range(TIMES):
        for classifier in classifiers:
            classifier.probabilities(normal(size=(1, COLUMNS)))
    problems: list[str] = [name for name in ("sklearn", "scipy") if name in sys.modules]
    if others() != before:
        problems.append(f"threads worked from {before} to {others()}")
    sys.stdout.write("".join(problems) or "one thread, no scikit-learn, no SciPy\n")


def others() -> dict[str, str]:
    """How long every other thread has worked (ns); none of those that BLAS keeps may have a part."""
    own = Path("/proc/thread-self").resolve().name
    tasks = [task for task in Path("/proc/self/task").iterdir() if task.name != own]
    return {task.name: (task / "schedstat").read_text().split()[0] for task in tasks}


main()
