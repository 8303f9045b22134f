"""Whether the way of all joints of a group is known well enough to be offered as one (thesis 6.1, 6.4)."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields

from bentod.contracts_assist import Situation
from bentod.errors import BadRequest, nearest
from bentod.frames import Value


@dataclass(frozen=True, slots=True)
class SurenessOptions:
    """The table `options` of `trajectory`."""

    confidence: float = 0.75  # 0..1, C of (6.3) from which on a joint's way counts as known
    familiarity: float = 0.5  # 0..1, how well a state must be known
    hysteresis: float = 0.1  # 0..1, how far both may fall below that before the offer ends
    after: float = 1.0  # s, 0..60, for which both must hold before the offer begins

    def __post_init__(self) -> None:
        for name, most in (("confidence", 1), ("familiarity", 1), ("hysteresis", 1), ("after", 60)):
            value: float = getattr(self, name)
            if not 0 <= value <= most:
                raise BadRequest(f"The assistance's {name} must be from 0 to {most}, not {value}.", name)


def options_of(table: Mapping[str, float]) -> SurenessOptions:
    """The options that `table` gives. Raises BadRequest: one is unknown, or out of its bounds."""
    known = [field.name for field in fields(SurenessOptions)]
    for name in table:
        if name not in known:
            raise BadRequest(f"trajectory has no option '{name}'{nearest(name, known)}", name)
    return SurenessOptions(**table)


class Sureness:
    """Offers when the least confidence of all joints, and familiarity, have been high for a while.

    The offer ends at once when one of them has fallen by `hysteresis` more, or anything is not known.
    """

    def __init__(self, options: SurenessOptions) -> None:
        self.options = options
        self.offers = False
        self.confidence = math.nan
        """The least of all joints."""
        self.reason = "The way of the joints is not known yet."
        self._familiarity = math.nan
        self._since: float | None = None

    def look(self, situation: Situation, timescale: float, expects: bool, hold: bool) -> None:
        """One tick. `expects`: whether all joints have predictions. `hold`: no offer ends for mere doubt."""
        outlook = situation.outlook
        told = [outlook.confidence(joint, timescale) for joint in situation.joints]
        self.confidence = min(told) if all(map(math.isfinite, told)) else math.nan
        self._familiarity = outlook.familiarity()
        if not expects:
            self.offers, self._since = False, None
        elif not (hold and self.offers):
            self._judge(situation.time)
        self.reason = self._explain(expects)

    def told(self) -> Mapping[str, Value]:
        """What it knows now."""
        return {
            "offers_together": self.offers,
            "confidence": self.confidence,
            "familiarity": self._familiarity,
        }

    def _judge(self, now: float) -> None:
        slack = self.options.hysteresis if self.offers else 0.0
        sure = self.confidence >= self.options.confidence - slack
        familiar = self._familiarity >= self.options.familiarity - slack
        if not (sure and familiar):
            self.offers, self._since = False, None
            return
        self._since = now if self._since is None else self._since
        self.offers = self.offers or now - self._since >= self.options.after

    def _explain(self, expects: bool) -> str:
        if not expects:
            return "Not every joint has a prediction."
        known = f"confidence {self.confidence:.2f}, familiarity {self._familiarity:.2f}"
        if self.offers:
            return f"All joints together can be selected: {known}."
        wanted = f"needs {self.options.confidence:g} and {self.options.familiarity:g}"
        return f"The way is not known well enough: {known}; {wanted} for {self.options.after:g} s."
