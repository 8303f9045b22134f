"""How welcome help is to the wearer, by joint: corrections cost trust, undisturbed help restores it."""

import math

from bentod.assist.confident_options import ConfidentOptions

TOLD = 0.015
"""Rad that a joint must have been helped, or moved by hand, to mean anything; the thesis' tolerance is 1°."""

SOON = 0.7
"""s after help has begun, within which a toggle is a doubt."""

LATELY = 2.0
"""s after which moving a joint back is no answer to help any more."""

SLIGHT = 0.1
"""Share of the doubt of a correction that a toggle soon after help has begun is worth."""


class Trust:
    """In the help for one joint."""

    def __init__(self) -> None:
        self.value = 1.0
        """0..1"""
        self._introduced = 0.0  # s of undisturbed help so far
        self.corrections = 0
        """How often the wearer moved the joint back."""
        self.corrected = -math.inf
        """Monotonic s of the last time."""
        self._helped = 0.0  # rad, by help one way, without a long rest
        self._began = -math.inf
        self._until = -math.inf
        self._asking = False  # whether the wearer's next move of this joint is an answer
        self._from: float | None = None

    def helped(self, way: float, now: float, period: float, options: ConfidentOptions) -> None:
        """The joint went `way` (rad) by help in the last tick, and nobody objected."""
        if now - self._until > LATELY or way * self._helped < 0:
            self._helped, self._began = 0.0, now
        self._helped += way
        self._until = now
        self._asking = False
        self._introduced += period
        self.value += (1 - self.value) * min(period / options.recovery, 1.0)

    def strength(self, options: ConfidentOptions) -> float:
        """With what share of its strength help is welcome: little at first, so that nobody is startled."""
        if options.introduction == 0:
            return self.value
        known = min(self._introduced / options.introduction, 1.0)
        return self.value * (options.first + (1 - options.first) * known)

    def toggled(self, now: float, options: ConfidentOptions) -> None:
        """The wearer has selected another joint."""
        recent = now - self._until < LATELY
        if recent and now - self._began < SOON and abs(self._helped) > TOLD / 3:
            self.lose(SLIGHT * options.doubt)
        self._asking, self._from = recent and abs(self._helped) > TOLD, None

    def moved(self, position: float, now: float, options: ConfidentOptions) -> None:
        """The wearer moves this joint, which is at `position` (rad): on, or back."""
        if not self._asking or now - self._until > LATELY:
            self._asking = False
            return
        if self._from is None:
            self._from = position
        way = position - self._from
        if abs(way) < TOLD:
            return
        self._asking = False
        if way * self._helped < 0:
            self.corrections += 1
            self.corrected = now
            self.lose(options.doubt)

    def lose(self, share: float) -> None:
        """A `share` (0..1) of it."""
        self.value *= 1 - share

    def gain(self, share: float) -> None:
        """A `share` (0..1) of what is missing."""
        self.value += share * (1 - self.value)

    def holds_back(self, now: float, options: ConfidentOptions) -> bool:
        """Whether the last correction was so lately that the joint is left alone."""
        return now - self.corrected < options.hold_back
