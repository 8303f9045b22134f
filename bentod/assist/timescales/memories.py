"""Checks of what a learner of timescales is given back."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

Memory = Mapping[str, NDArray[np.float64]]
"""What was learned, by name."""


def checked(memory: Memory, shapes: Mapping[str, Sequence[int]]) -> dict[str, NDArray[np.float64]]:
    """Copies of the arrays of `memory`. Raises ValueError: one is missing, of another shape or not finite."""
    if set(memory) != set(shapes):
        raise ValueError(f"A memory of {', '.join(sorted(shapes))} has been expected, not {sorted(memory)}.")
    for name, shape in shapes.items():
        if memory[name].shape != tuple(shape) or not np.isfinite(memory[name]).all():
            raise ValueError(f"{name} must be finite and of shape {tuple(shape)}, not {memory[name].shape}.")
    return {name: np.array(array, dtype=np.float64) for name, array in memory.items()}
