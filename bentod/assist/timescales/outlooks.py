"""An outlook in which the timescale of the settings stands for the one that was chosen, or a mixture."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from bentod.contracts_assist import Outlook


@dataclass(frozen=True, slots=True)
class Blend:
    """At `timescale`, the predictions of all `timescales` by `weights` (1 in all); at others, as they are.

    Where a prediction with a weight is not known, neither is the blend.
    """

    outlook: Outlook
    timescale: float  # ticks; what the assist asks for
    timescales: tuple[float, ...]  # ticks
    weights: Sequence[float]  # shape (timescales,)

    def position(self, joint: int, timescale: float) -> float:
        """As in `Outlook`."""
        return self._blended(lambda t: self.outlook.position(joint, t), timescale)

    def confidence(self, joint: int, timescale: float) -> float:
        """As in `Outlook`."""
        return self._blended(lambda t: self.outlook.confidence(joint, t), timescale)

    def surprise(self, joint: int, timescale: float) -> float:
        """As in `Outlook`."""
        return self._blended(lambda t: self.outlook.surprise(joint, t), timescale)

    def familiarity(self) -> float:
        """As in `Outlook`."""
        return self.outlook.familiarity()

    def answer(self, name: str) -> float:
        """As in `Outlook`."""
        return self.outlook.answer(name)

    def _blended(self, told: Callable[[float], float], timescale: float) -> float:
        if timescale != self.timescale:
            return told(timescale)
        shares = zip(self.weights, self.timescales, strict=True)
        return sum(share * told(t) for share, t in shares if share > 0)


@dataclass(frozen=True, slots=True)
class Varying:
    """At `timescale`, the prediction whose γ depends on the state, as far as `share` trusts it.

    P = P_short + share · (P_state − P_short), where P_state is kept between the least and the greatest of the
    predictions at all `timescales`: however badly it was learned, it says nothing that none of them says.
    """

    outlook: Outlook
    timescale: float  # ticks; what the assist asks for
    timescales: tuple[float, ...]  # ticks, ascending
    share: float  # 0..1
    names: Sequence[str]  # of the questions with a varying γ, by joint

    def position(self, joint: int, timescale: float) -> float:
        """As in `Outlook`."""
        if timescale != self.timescale:
            return self.outlook.position(joint, timescale)
        short, *longer = (self.outlook.position(joint, t) for t in self.timescales)
        varying = self.outlook.answer(self.names[joint])
        if self.share == 0 or not all(map(math.isfinite, (short, *longer, varying))):
            return short
        return short + self.share * (min(max(varying, min(short, *longer)), max(short, *longer)) - short)

    def confidence(self, joint: int, timescale: float) -> float:
        """As in `Outlook`: of the prediction with a varying γ, the least that any timescale has."""
        return self._worst(min, lambda t: self.outlook.confidence(joint, t), timescale)

    def surprise(self, joint: int, timescale: float) -> float:
        """As in `Outlook`: of the prediction with a varying γ, the greatest that any timescale has."""
        return self._worst(max, lambda t: self.outlook.surprise(joint, t), timescale)

    def familiarity(self) -> float:
        """As in `Outlook`."""
        return self.outlook.familiarity()

    def answer(self, name: str) -> float:
        """As in `Outlook`."""
        return self.outlook.answer(name)

    def _worst(
        self, pick: Callable[[list[float]], float], told: Callable[[float], float], timescale: float
    ) -> float:
        if timescale != self.timescale:
            return told(timescale)
        if self.share == 0:
            return told(self.timescales[0])
        found = [told(t) for t in self.timescales]
        return math.nan if any(map(math.isnan, found)) else pick(found)
