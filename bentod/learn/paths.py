"""Memories within memories: names joined by "/"."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray


def below(memory: Mapping[str, NDArray[np.float64]], name: str) -> dict[str, NDArray[np.float64]]:
    """The entries of `memory` below `name`."""
    prefix = f"{name}/"
    return {key.removeprefix(prefix): array for key, array in memory.items() if key.startswith(prefix)}


def put_below(name: str, memory: Mapping[str, NDArray[np.float64]]) -> dict[str, NDArray[np.float64]]:
    """The same entries, below `name`."""
    return {f"{name}/{key}": array for key, array in memory.items()}
