"""Random numbers that are the same again in every replay, and go on where they were after a restart."""

import math

_MASK = (1 << 64) - 1
_GOLDEN = 0x9E3779B97F4A7C15
_MOST = 1 << 52
"""Throws, after which they begin anew: a count up to here is a float64 exactly."""


class Dice:
    """SplitMix64 (Steele, Lea & Flood 2014): the n-th number is a hash of n, so n is all of its state."""

    def __init__(self, seed: int) -> None:
        self._seed = seed & _MASK
        self.thrown = 0
        """How many numbers were taken."""

    def uniform(self) -> float:
        """A number in [0, 1)."""
        self.thrown = (self.thrown + 1) % _MOST
        z = (self._seed + self.thrown * _GOLDEN) & _MASK
        z = ((z ^ (z >> 30)) * 0xBF58476D1CE4E5B9) & _MASK
        z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & _MASK
        return float((z ^ (z >> 31)) >> 11) / (1 << 53)

    def below(self, count: int) -> int:
        """A whole number from 0 to `count` − 1."""
        return min(int(self.uniform() * count), count - 1)

    def normal(self) -> float:
        """A number of the standard normal distribution, within ±3 (Box & Muller 1958)."""
        radius = math.sqrt(-2 * math.log(1 - self.uniform()))
        return min(max(radius * math.cos(2 * math.pi * self.uniform()), -3.0), 3.0)

    def recall(self, thrown: float) -> None:
        """Go on after so many numbers. Raises ValueError: there is no such count."""
        if not (0 <= thrown < _MOST and float(thrown).is_integer()):
            raise ValueError(f"{thrown} is not a count of random numbers.")
        self.thrown = int(thrown)
