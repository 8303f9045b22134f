"""How help comes and goes: a gate with hysteresis, strength that grows, velocity without jumps."""

import math
from dataclasses import dataclass

from bentod.assist.confident_options import ConfidentOptions


@dataclass(frozen=True, slots=True)
class Evidence:
    """What speaks for one prediction in one tick; NaN: nobody estimates it."""

    confidence: float  # C, up to 1
    surprise: float  # Z
    familiarity: float  # 0..1


class Gate:
    """Whether one joint is to be helped. Opening needs more than staying open, so noise does not flutter it.

    What nobody estimates is no obstacle, but for C: without that nothing speaks for the prediction at all.
    """

    def __init__(self) -> None:
        self.open = False
        """As of the last look."""

    def look(self, seen: Evidence, options: ConfidentOptions) -> str:
        """Take in a tick; why the gate is shut, empty if it is open."""
        least = options.confidence - (options.hysteresis if self.open else 0.0)
        most = options.surprise if self.open else options.surprise / 2
        known = options.familiarity * (0.8 if self.open else 1.0)
        reason = ""
        if math.isnan(seen.confidence):
            reason = "nobody says how sure this prediction is"
        elif seen.familiarity < known:
            reason = "this posture is new"
        elif seen.surprise > most:
            reason = "things do not go as expected"
        elif not seen.confidence >= least:
            reason = f"confidence {seen.confidence:.2f} is below {least:.2f}"
        self.open = not reason
        return reason


class Fade:
    """The strength of help for one joint, 0..1, and the velocity that it asks for."""

    def __init__(self) -> None:
        self.gain = 0.0
        """0..1"""
        self.velocity = 0.0
        """rad/s, asked last"""

    def shut(self) -> None:
        """Out at once."""
        self.gain = self.velocity = 0.0

    def rest(self) -> None:
        """Nothing is asked in this tick; its strength stays."""
        self.velocity = 0.0

    def grow(self, period: float, fade: float) -> None:
        """A tick of `period` (s) more of `fade` (s)."""
        self.gain = min(1.0, self.gain + period / fade) if fade > period else 1.0

    def ask(self, wanted: float, step: float) -> float:
        """Up to the velocity `wanted` (rad/s): at most `step` faster than before, but slower at once."""
        before = abs(self.velocity) if self.velocity * wanted > 0 else 0.0
        self.velocity = math.copysign(min(abs(wanted), before + step), wanted)
        return self.velocity
