"""What general value functions answer in a tick, where other questions and people can look it up by name."""

from collections.abc import Collection, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

NEVER = -1
"""The tick of a prediction that has not been made yet."""


class Answers:
    """The newest predictions of all questions, in question order; arrays of shape (questions,)."""

    def __init__(self, names: Sequence[str]) -> None:
        self.names = tuple(names)
        self.place: Mapping[str, int] = {name: place for place, name in enumerate(self.names)}
        self.value = np.full(len(self.names), np.nan)
        self.delta = np.full(len(self.names), np.nan)
        """δ of this tick's learning; NaN where nothing was learned."""
        self.made_at = np.full(len(self.names), NEVER, dtype=np.int64)
        self.confidence = np.full(len(self.names), np.nan)
        """C of each; NaN where nobody estimates it."""
        self.surprise = np.full(len(self.names), np.nan)
        """Z of each."""
        self.error = np.full(len(self.names), np.nan)
        """Running RMSE of each against the return; NaN until one is known."""
        self.tick = NEVER

    def begin(self, tick: int) -> None:
        """A new tick: nothing has been learned in it yet, and no prediction is of it."""
        self.tick = tick
        self.delta.fill(np.nan)

    def put(self, places: NDArray[np.intp], values: NDArray[np.float64], delta: NDArray[np.float64]) -> None:
        """Take in what was answered in this tick."""
        self.value[places] = values
        self.delta[places] = delta
        self.made_at[places] = self.tick

    def prediction(self, name: str) -> float:
        """The prediction of one question in this tick; NaN if it was not made in it."""
        place = self.place[name]
        return float(self.value[place]) if self.made_at[place] == self.tick else float("nan")

    def squared_error(self, name: str) -> float:
        """δ² of one question in this tick; NaN if it learned nothing."""
        delta = float(self.delta[self.place[name]])
        return delta * delta  # which may be infinite, where a power would raise

    def older(self) -> dict[str, float]:
        """The age in ticks of those predictions that were not made in this one, by name."""
        places = np.flatnonzero((self.made_at != self.tick) & (self.made_at > NEVER))
        return {self.names[place]: float(self.tick - self.made_at[place]) for place in places}

    def fresh(self, name: str) -> float:
        """The prediction of a question if it was made in this tick; NaN if not, or if nobody asks it."""
        return self.prediction(name) if name in self.place else float("nan")

    def now(self, name: str, told: NDArray[np.float64]) -> float:
        """What `told`, one of these arrays, says of a question in this tick; NaN if nothing."""
        known = name in self.place and self.made_at[self.place[name]] == self.tick
        return float(told[self.place[name]]) if known else float("nan")

    def newest(self, name: str) -> float:
        """The newest prediction of a question; NaN if there is none, or nobody asks it."""
        return float(self.value[self.place[name]]) if name in self.place else float("nan")

    def take_over(self, other: "Answers", known: Collection[str]) -> None:
        """Go on with the answers of `other` to the questions `known`."""
        self.tick = other.tick
        for name in known:
            mine, theirs = self.place[name], other.place[name]
            self.value[mine], self.made_at[mine] = other.value[theirs], other.made_at[theirs]
