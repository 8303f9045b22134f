"""Classifiers by name: how one is trained, and how it is had back from what was kept of it."""

from collections.abc import Callable, Mapping
from typing import cast

import numpy as np
from numpy.typing import NDArray

from bentod.emg.recognition import Classifier, Train
from bentod.errors import ConfigError, nearest
from bentod.registry import CLASSIFIERS, ClassifierKind, resolve

Restore = Callable[[tuple[str, ...], Mapping[str, NDArray[np.float64]]], Classifier]


def trainer(name: str) -> Train:
    """How the classifier `name` is trained.

    Raises:
        ConfigError: there is none, or the extra that trains it is not installed.
    """
    return cast("Train", resolve(kind(name).train))


def restored(name: str, labels: tuple[str, ...], arrays: Mapping[str, NDArray[np.float64]]) -> Classifier:
    """The classifier `name` that knows `arrays`; this needs NumPy only.

    Raises:
        ConfigError: there is none of that name.
        SnapshotError: the arrays are not those of such a classifier.
    """
    return cast("Restore", resolve(kind(name).restore))(labels, arrays)


def kind(name: str) -> ClassifierKind:
    """Where the classifier `name` is found. Raises ConfigError: there is none of that name."""
    if name not in CLASSIFIERS:
        raise ConfigError(f"there is no classifier '{name}'{nearest(name, CLASSIFIERS)}", "classifier")
    return CLASSIFIERS[name]
