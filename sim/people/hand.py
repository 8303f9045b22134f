"""From a way to go to effort on the joystick: pushes that run on without sight, noisier the stronger."""

import math
import random

from sim.people.traits import Hands


class Hand:
    """One push at a time; what is not pushed springs back to rest."""

    def __init__(self, hands: Hands, speed: float, draw: random.Random) -> None:
        """`speed`: rad/s at full effort, as the operator believes it to be."""
        self._hands = hands
        self._speed = speed
        self._draw = draw
        self._intent = 0.0
        self._until = -math.inf
        self._effort = 0.0
        self._time: float | None = None

    @property
    def pushing(self) -> bool:
        """Whether a push is intended at the moment."""
        return self._intent != 0.0

    def push(self, distance: float, ease: float, now: float) -> float:
        """Push for `distance` (rad, signed) from `now` (s) on; returns when the push ends (s).

        `ease`: 0..1, share of the full effort to use at most.
        """
        hands = self._hands
        level = min(max(abs(distance) / hands.fine, hands.least), ease)
        lasts = abs(distance) / (level * self._speed)
        self._intent = math.copysign(level * (1 + self._draw.gauss(0.0, hands.noise)), distance)
        self._until = now + lasts * max(0.2, 1 + self._draw.gauss(0.0, hands.misjudgement))
        return self._until

    def rest(self) -> None:
        """Let go."""
        self._intent = 0.0

    def step(self, now: float) -> float:
        """Effort, -1..1, at `now` (s)."""
        elapsed = 0.0 if self._time is None else now - self._time
        self._time = now
        if now >= self._until:
            self._intent = 0.0
        share = 1 - math.exp(-elapsed / self._hands.lag) if self._hands.lag else 1.0
        self._effort += share * (self._intent - self._effort)
        if abs(self._effort) < DEAD_ZONE:
            return 0.0
        trembling = self._effort * (1 + self._draw.gauss(0.0, self._hands.tremor))
        return min(max(trembling, -1.0), 1.0)


DEAD_ZONE = 0.08
"""Effort below which a joystick, or a threshold, gives nothing; assumed."""
