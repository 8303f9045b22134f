"""Muscles whose signals were lost must be seen at rest before they may move anything again."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from bentod.control.proportional import Levels, Site

REST_S = 0.3
"""s at rest, counted in samples; as long as whoever drives a group must rest to have left it."""

LOST_S = 1.0
"""s after which signals that could not be believed were lost, and not just interrupted. Who contracts through
an interruption goes on asking; who has waited for an arm that does not answer may be doing anything."""


class RestFirst:
    """Whether muscles that were lost still have to be seen at rest, all of them at the same time."""

    def __init__(self, rate_hz: float) -> None:
        self._needed = math.ceil(REST_S * rate_hz)
        self._owed = 0  # samples
        self._openings = 1
        self._began: float | None = None  # monotonic s, when a problem was first seen

    def watch(self, now: float, problem: str, openings: int) -> None:
        """Told at every look (monotonic s) what is wrong, and how often the source was opened so far."""
        if problem and self._began is None:
            self._began = now
        lasted = 0.0 if self._began is None else now - self._began
        if not problem:
            self._began = None
        if openings != self._openings or lasted > LOST_S or (problem and self._owed):
            self._owed = self._needed
        self._openings = openings

    def step(self, sites: Sequence[Site], levels: Levels) -> str:
        """Why the muscles may move nothing yet, at `levels` (V, shape (n, channels)); empty if they may.

        `levels`: all since the last step. One that is not a number is not at rest.
        """
        if not self._owed:
            return ""
        quiet = np.ones(len(levels), bool)
        for site in sites:
            quiet &= levels[:, site.channel] * site.gain <= site.floor
        self._count(quiet)
        return f"EMG is back; it moves nothing until every muscle has been at rest for {REST_S:g} s."

    def _count(self, quiet: NDArray[np.bool_]) -> None:
        """Take off what is seen at rest; `quiet`: shape (n,). Whatever comes between begins the time anew."""
        tense = np.flatnonzero(~quiet)
        runs = np.diff([-1, *tense, len(quiet)]) - 1
        if runs[0] >= self._owed or np.any(runs[1:] >= self._needed):
            self._owed = 0
        else:
            self._owed = (self._needed if len(tense) else self._owed) - int(runs[-1])
