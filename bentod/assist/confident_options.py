"""What may be set of the assist that heeds its confidence: names, bounds and defaults."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields

from bentod.errors import BadRequest, nearest


@dataclass(frozen=True, slots=True)
class ConfidentOptions:
    """The table `options` of `dpcc_confident`, all numbers.

    | name | bounds | what it is |
    |---|---|---|
    | `confidence` | 0..1 | C of (6.3) from which on a joint is helped |
    | `hysteresis` | 0..1 | how far C may fall below that before help ends |
    | `surprise` | above 0 | Z of (6.1) above which help ends; it begins again below half of it |
    | `familiarity` | 0..1 | how well a posture must be known; 0: no matter |
    | `fade` | 0..10 s | until help has its full strength |
    | `acceleration` | above 0 up to 100 rad/s² | how fast the speed of help may grow |
    | `slope` | above 0 up to 100 | rad that a joint may go for each rad that the attended one goes |
    | `astray` | 0..10 rad | how far the attended joint may be expected the other way; 10: no matter |
    | `ground` | 0..2 s | ahead for which a joint must stay where it has been without help; 0: no matter |
    | `doubt` | 0..1 | share of the trust that a correction costs |
    | `hold_back` | 0..60 s | without help for a joint that was corrected |
    | `recovery` | above 0 up to 600 s | of undisturbed help, in which lost trust comes back |
    | `first` | above 0 up to 1 | share of its strength with which help begins for who does not know it |
    | `introduction` | 0..3600 s | of undisturbed help, in which that grows to all of it |
    """

    confidence: float = 0.6
    hysteresis: float = 0.1
    surprise: float = 2.0
    familiarity: float = 0.5
    fade: float = 0.3
    acceleration: float = 2.0
    slope: float = 3.0
    astray: float = 0.02
    ground: float = 0.45
    doubt: float = 0.15
    hold_back: float = 2.0
    recovery: float = 2.0
    first: float = 0.2
    introduction: float = 5.0

    def __post_init__(self) -> None:
        for name, (least, most, unit) in _BOUNDS.items():
            value: float = getattr(self, name)
            if not (least < value <= most or (value == least and name not in _ABOVE)):
                word = "above" if name in _ABOVE else "from"
                bound = f"{word} {least:g} up to {most:g}{unit}"
                raise BadRequest(f"The assistance's {name} must be {bound}, not {value}.", name)


_BOUNDS = {
    "confidence": (0.0, 1.0, ""),
    "hysteresis": (0.0, 1.0, ""),
    "surprise": (0.0, math.inf, ""),
    "familiarity": (0.0, 1.0, ""),
    "fade": (0.0, 10.0, " s"),
    "acceleration": (0.0, 100.0, " rad/s²"),
    "slope": (0.0, 100.0, ""),
    "astray": (0.0, 10.0, " rad"),
    "ground": (0.0, 2.0, " s"),
    "doubt": (0.0, 1.0, ""),
    "hold_back": (0.0, 60.0, " s"),
    "recovery": (0.0, 600.0, " s"),
    "first": (0.0, 1.0, ""),
    "introduction": (0.0, 3600.0, " s"),
}

_ABOVE = frozenset({"surprise", "acceleration", "slope", "recovery", "first"})
"""Those that must be above their lower bound."""


def confident_options(table: Mapping[str, float]) -> ConfidentOptions:
    """The options that `table` gives. Raises BadRequest: one is unknown, or out of its bounds."""
    known = [field.name for field in fields(ConfidentOptions)]
    for name in table:
        if name not in known:
            raise BadRequest(f"dpcc_confident has no option '{name}'{nearest(name, known)}", name)
    return ConfidentOptions(**table)
