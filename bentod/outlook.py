"""What learners expect of the joints, as assists may ask for it."""

import math
from collections.abc import Sequence

from bentod.config_learn import ARM
from bentod.learn.predictor import Predictor, position_at


class Expectation:
    """The predictions of this tick; without learners nothing is expected."""

    def __init__(
        self,
        predictor: Predictor | None,
        names: Sequence[str],
        timescales: Sequence[float],
        representation: str = ARM,
    ) -> None:
        """`representation`: what the joints' positions are predicted from."""
        self._representation = representation
        self._predictor = predictor
        self._names = tuple(names)
        self.timescales = tuple(sorted(timescales))
        """Ticks at which the joints' positions are predicted, ascending."""

    def position(self, joint: int, timescale: float) -> float:
        """As in `Outlook`."""
        return self.answer(position_at(self._names[joint], timescale))

    def confidence(self, joint: int, timescale: float) -> float:
        """As in `Outlook`."""
        name = position_at(self._names[joint], timescale)
        return self._predictor.confidence(name) if self._predictor else math.nan

    def surprise(self, joint: int, timescale: float) -> float:
        """As in `Outlook`."""
        name = position_at(self._names[joint], timescale)
        return self._predictor.surprise(name) if self._predictor else math.nan

    def familiarity(self) -> float:
        """As in `Outlook`."""
        return self._predictor.familiarity(self._representation) if self._predictor else math.nan

    def answer(self, name: str) -> float:
        """As in `Outlook`."""
        return self._predictor.fresh(name) if self._predictor else math.nan
