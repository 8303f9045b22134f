"""How unexpected the TD errors of late are: the unexpected demon error of thesis (6.1).

    Z_t = |δ̄| / √var[δ]                                                                              (6.1)

after White, Modayil & Sutton, "Surprise and Curiosity for Big Data Robotics", AAAI-14 workshop on
sequential decision making with big data. δ̄ is an exponentially weighted average of δ, which tends to 0 for
a learner that is right on average, however noisy its signal is; the deviation says how much δ̄ may stray
while nothing happens.

The variance is taken about the mean of a far longer time than δ̄ is, and this difference is what makes the
measure work. With one time constant for both, a single error that stands out widens the deviation at the
tick at which it moves the average, so that Z never exceeds √(β/(1 − β)) for it. With the variance of all
time a learner's first minutes, in which all its errors are large, hide what comes in the hours after. So
the variance forgets too, slowly: until it begins to, it is the variance of all errors so far.

For errors that are independent and as large as ever E[Z²] = β/(2 − β), so Z is about 0.13 for β = 1/30.
"""

import numpy as np
from numpy.typing import NDArray

from bentod.learn.confidence.averages import mix, weight
from bentod.learn.confidence.columns import Columns


class Surprise(Columns):
    """Of m = `count` GVFs. `rate`: β of δ̄, per tick; `slow_rate`: that of the variance.

    At 30 Hz δ̄ looks back 1 s, and the variance 10 min.
    """

    def __init__(self, count: int, rate: float = 1 / 30, slow_rate: float = 1 / 18_000) -> None:
        if not 0 < slow_rate <= rate <= 1:
            raise ValueError(
                "Surprise needs rates above 0 up to 1, the slow one not above the other, "
                f"not {rate} and {slow_rate}."
            )
        super().__init__(
            count,
            dict.fromkeys(("recent", "recent_seen", "mean", "variance", "mean_seen"), ((), 0.0)),
        )
        self._rate = rate
        self._slow_rate = slow_rate

    def step(self, delta: NDArray[np.float64]) -> NDArray[np.float64]:
        """Z after δ_t = `delta`, shape (m,); 0 until a variance is known. NaN leaves a GVF as it was."""
        own = self._own
        taught = np.isfinite(delta)
        delta = np.where(taught, delta, 0)
        own["recent"] += weight(own["recent_seen"], 1 - taught * self._rate) * (delta - own["recent"])
        share = weight(own["mean_seen"], 1 - taught * self._slow_rate)
        mix(own["mean"], own["variance"], delta, 0.0, share)
        return self.value

    @property
    def value(self) -> NDArray[np.float64]:
        """Z, shape (m,)."""
        deviation = np.sqrt(self._own["variance"])
        known = deviation > 0
        z: NDArray[np.float64] = np.abs(self._own["recent"]) / np.where(known, deviation, 1) * known
        return z
