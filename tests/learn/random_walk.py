"""The random walk of Sutton & Barto, whose values are known."""

from collections.abc import Iterator

import numpy as np

STATES = 19


def walk(rng: np.random.Generator) -> Iterator[int]:
    """States from the middle one, up to and including the terminal −1 or 19."""
    state = STATES // 2
    while 0 <= state < STATES:
        yield state
        state += 1 if rng.random() < 0.5 else -1
    yield state
