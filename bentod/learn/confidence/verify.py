"""How wrong predictions were, once what they predicted has come: the error against the return.

Of some predictions P_t a note is taken. While the horizon passes, the return is added up for each,

    G_t = R_{t+1} + γ_{t+1} R_{t+2} + γ_{t+1} γ_{t+2} R_{t+3} + …,

with the γ that was true in every state, until the product of the γ, which is what all that is yet to come
would weigh, is 1 % or less. Then the tail is taken to be what is predicted there: P_{t+H} times that
product. This trusts a prediction with 1 % of itself, and errs by 1 % of its error; to leave the tail out
would err by 1 % of the value. Where γ = 0 the return is complete at once.

**Cost.** Each note is one number to multiply and one to add to, so a tick costs `lanes` · m of both, and
the memory is three times that, however long the horizon. A note is taken of all GVFs every `every` ticks,
at most `lanes` are open: `every` = (horizon + 1)/lanes, rounded up. A sliding window over every prediction
would need the horizon times m numbers, and tell little more, because returns that overlap are nearly the
same.

A note that is still worth more than 1 % when its lane is needed again (γ depends on the state and stayed
near 1) is thrown away: it would be compared with little but another prediction. So are those that met a
cumulant that was not observed, and all that are open at a cut.
"""

import math

import numpy as np
from numpy.typing import NDArray

from bentod.learn.confidence.averages import mix, weight
from bentod.learn.confidence.columns import Column, Columns

TAIL = 0.01
"""What the rest of a return may weigh when it is taken to be known."""


def horizon(gamma: float, most: int = 54_000, tail: float = TAIL) -> int:
    """H, ticks until γ^H is down to `tail`: 90 for a timescale of 20. At most `most`, 30 min at 30 Hz."""
    if gamma <= tail:
        return 1
    return min(math.ceil(math.log(tail) / math.log(gamma)), most) if gamma < 1 else most


class ReturnError(Columns):
    """Of m = `count` GVFs with one `horizon` (ticks). `memory`: ticks of the average, 5 min at 30 Hz.

    The average of squared errors is one of all that are known at first, and forgets exponentially: an error
    from `memory` ticks ago weighs 1/e of a new one.
    """

    def __init__(self, count: int, horizon: int, lanes: int = 16, memory: float = 9000.0) -> None:
        if horizon < 1 or lanes < 1 or not memory > 0:
            raise ValueError(
                "A return needs a horizon, lanes and memory of at least 1 tick, "
                f"not {horizon}, {lanes} and {memory}."
            )
        self._lanes = min(lanes, horizon + 1)
        self.every = math.ceil((horizon + 1) / self._lanes)
        """Ticks from one note to the next."""
        own: dict[str, Column] = dict.fromkeys(("note", "so_far", "worth"), ((self._lanes,), 0.0))
        own |= dict.fromkeys(("seen", "square", "mean", "variance"), ((), 0.0))
        super().__init__(count, own, {"ticks": np.zeros(1)})
        kept = math.exp(-self.every / memory)
        self._kept = np.array([kept**n for n in range(self._lanes + 1)])

    @property
    def rmse(self) -> NDArray[np.float64]:
        """Root mean square of P_t − G_t, shape (m,), unit of the predictions; NaN until one is known."""
        return self._known(self._own["square"])

    @property
    def normalised(self) -> NDArray[np.float64]:
        """The same over the deviation of the returns: 1 is no better than always saying their mean."""
        deviation = self._known(self._own["variance"])
        normalised: NDArray[np.float64] = self.rmse / np.where(deviation > 0, deviation, np.nan)
        return normalised

    def step(
        self,
        predictions: NDArray[np.float64],
        cumulants: NDArray[np.float64],
        gamma: NDArray[np.float64] | float,
    ) -> NDArray[np.float64]:
        """`rmse` after the transition to P_{t+1} = `predictions` by R_{t+1} = `cumulants`, γ_{t+1} = `gamma`.

        Both are as learned from; a cumulant that is not finite was not observed.
        """
        own = self._own
        with np.errstate(over="ignore", invalid="ignore"):
            waiting = own["worth"] > 0
            own["so_far"] += own["worth"] * np.where(np.isfinite(cumulants), cumulants, np.nan)
            own["worth"] *= gamma
            due = waiting & (own["worth"] <= TAIL)
            if due.any():
                lanes = np.flatnonzero(due.any(axis=1))
                self._verify(lanes, due[lanes], predictions)
                own["worth"][due] = 0
        self._take_note(predictions)
        return self.rmse

    def cut(self) -> None:
        """What follows has nothing to do with what came before: no open note can be verified any more."""
        self._own["worth"].fill(0)

    def _known(self, square: NDArray[np.float64]) -> NDArray[np.float64]:
        root: NDArray[np.float64] = np.sqrt(np.where(self._own["seen"] > 0, square, np.nan))
        return root

    def _take_note(self, predictions: NDArray[np.float64]) -> None:
        ticks = self._shared["ticks"]
        turn, rest = divmod(int(ticks[0]), self.every)
        if rest == 0:
            lane = turn % self._lanes
            self._own["note"][lane] = predictions
            self._own["so_far"][lane] = 0
            self._own["worth"][lane] = 1
        ticks += 1

    def _verify(
        self, lanes: NDArray[np.intp], due: NDArray[np.bool_], predictions: NDArray[np.float64]
    ) -> None:
        """Take the notes of these lanes that are `due`, shape (lanes, m), into the averages."""
        own = self._own
        returns = own["so_far"][lanes] + own["worth"][lanes] * predictions
        square = (own["note"][lanes] - returns) ** 2
        good = due & np.isfinite(square) & np.isfinite(returns)
        number = good.sum(axis=0)
        some = np.maximum(number, 1)
        returns = np.where(good, returns, 0)
        mean = returns.sum(axis=0) / some
        variance = (np.where(good, returns - mean, 0) ** 2).sum(axis=0) / some
        share = weight(own["seen"], self._kept[number])
        own["square"] += share * (np.where(good, square, 0).sum(axis=0) / some - own["square"])
        mix(own["mean"], own["variance"], mean, variance, share)
