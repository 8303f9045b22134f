"""What is seen and heard of the arm: late, and a little blurred."""

import math
import random
from collections import deque

from sim.people.scene import Point, View
from sim.people.traits import Senses

REMEMBERED = 1.5
"""s of views and of one's own efforts that are kept."""


class Eyes:
    """Views as they reach a decision, and what of one's own motion one foresees meanwhile."""

    def __init__(self, senses: Senses, speed: float, draw: random.Random) -> None:
        """`speed`: rad/s of a joint at full effort, which the operator knows."""
        self._senses = senses
        self._speed = speed
        self._draw = draw
        self._views: deque[View] = deque()
        self._efforts: deque[tuple[float, int, float]] = deque()

    def look(self, view: View) -> None:
        """Light and sound reach the operator."""
        self._views.append(view)
        while self._views[0].time < view.time - REMEMBERED:
            self._views.popleft()

    def felt(self, time: float, joint: int, effort: float) -> None:
        """What the own hand does is known at once, and for which joint it is meant."""
        self._efforts.append((time, joint, effort))
        while self._efforts[0][0] < time - REMEMBERED:
            self._efforts.popleft()

    def seen(self, ago: float = 0.0) -> View:
        """The view that is conscious now, or was `ago` (s)."""
        return self.at(self._senses.visual_delay + ago)

    def heard(self) -> View:
        """The view whose sounds can be answered now."""
        return self.at(self._senses.hearing)

    def told(self) -> View:
        """The view whose spoken name is understood now."""
        return self.at(self._senses.voice)

    def at(self, ago: float) -> View:
        """The newest view that is `ago` (s) old; the oldest if none is."""
        moment = self._views[-1].time - ago + 1e-9
        return next((view for view in reversed(self._views) if view.time <= moment), self._views[0])

    def travel(self, joint: int, ago: float) -> float:
        """How far the own effort should have moved `joint` in the last `ago` (s), in rad."""
        since = self._views[-1].time - ago
        recent = [(of, effort) for time, of, effort in self._efforts if time > since]
        if not recent:
            return 0.0
        return self._speed * ago * math.fsum(effort for of, effort in recent if of == joint) / len(recent)

    def foreseen(self, joint: int, transit: float, to_rest: float) -> float:
        """How far (rad) `joint` will have gone from what is seen, if one lets go now.

        `transit`: s from an effort to the motion that it makes; `to_rest`: s that the effort takes to fade.
        Who does not foresee all of it overshoots.
        """
        _, of, effort = self._efforts[-1] if self._efforts else (0.0, joint, 0.0)
        fading = effort * self._speed * to_rest if of == joint else 0.0
        return self._senses.prediction * (self.travel(joint, self._senses.visual_delay + transit) + fading)

    def blurred(self, position: Point) -> Point:
        """As seen at one glance."""
        blur = self._senses.blur
        return (position[0] + self._draw.gauss(0.0, blur), position[1] + self._draw.gauss(0.0, blur))
