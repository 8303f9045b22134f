"""Changing the joint: it takes time, it goes wrong, and which joint one drives is a belief."""

import math
import random
from enum import Enum

from sim.people.scene import View
from sim.people.traits import Switching

SPOKEN = 0.08
"""s from a press to the arm's answer: two ticks."""

SILENCE = 0.9
"""s without a voice after which a press counts as missed; assumed."""


class Phase(Enum):
    """Where a toggle is."""

    IDLE = "idle"
    CHOOSING = "choosing"
    PRESSING = "pressing"


class Switch:
    """One toggle at a time, and the belief about which of the two joints is driven."""

    def __init__(self, switching: Switching, draw: random.Random) -> None:
        self._switching = switching
        self._draw = draw
        self._until = -math.inf
        self._again: float | None = None
        self._pressed: float | None = None
        self._heard = 0
        self.phase = Phase.IDLE
        self.belief = 0
        """The joint that the operator believes to drive, 0 or 1."""

    @property
    def busy(self) -> bool:
        """Whether a toggle is under way: the hand rests meanwhile."""
        return self.phase is not Phase.IDLE

    def foresees(self) -> bool:
        """Whether the next toggle is prepared while the push before it still lasts."""
        return self._draw.random() < self._switching.foresight

    def begin(self, now: float, prepared: bool) -> None:
        """Set about toggling at `now` (s)."""
        if not self.busy:
            self.phase = Phase.CHOOSING
            self._until = now + (0.0 if prepared else self._time(self._switching.choice))

    def step(self, now: float, told: View) -> bool:
        """Whether the button goes down in this tick; `told`: the view whose spoken name is understood."""
        self._listen(told, now)
        if self._again is not None and now >= self._again:
            self._again, self._pressed = None, now
            return True
        if now < self._until:
            return False
        if self.phase is Phase.CHOOSING:
            self.phase, self._until = Phase.PRESSING, now + self._time(self._switching.press)
        elif self.phase is Phase.PRESSING:
            self.phase = Phase.IDLE
            return self._press(now)
        return False

    def realise(self, truth: int) -> None:
        """See which joint it is."""
        self.belief = truth

    def lose(self) -> None:
        """Get it wrong."""
        self.belief = 1 - self.belief

    def _press(self, now: float) -> bool:
        self.belief = 1 - self.belief
        self._pressed = now
        if self._draw.random() < self._switching.missed:
            return False
        if self._draw.random() < self._switching.double:
            self._again = now + self._switching.press
        return True

    def _listen(self, told: View, now: float) -> None:
        """The voice after a press says which joint it is, whatever one believed; silence tells it later."""
        if self._pressed is None or told.time < self._pressed + SPOKEN:
            return
        if told.toggles != self._heard or now - self._pressed > SILENCE:
            self._heard = told.toggles
            self._pressed = None
            self.belief = told.active

    def _time(self, typical: float) -> float:
        return typical * math.exp(self._draw.gauss(0.0, self._switching.scatter))
