"""What was thought live beside what is thought again, and both beside what came to pass."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from math import nan

import numpy as np
from numpy.typing import NDArray

from bentod.frames import Frame, Freshness
from bentod.learn.returns import ideal_predictions
from bentod.replay.relearn import Relearner, Tick, same_thoughts


@dataclass(frozen=True, slots=True)
class Error:
    """How far the predictions of one joint at one timescale were from the ideal ones."""

    joint: str
    timescale: str  # steps, as frames name it
    live: float  # rad, root mean square
    again: float  # rad, root mean square


@dataclass(frozen=True, slots=True)
class GvfError:
    """How wrong one of the users' own GVFs was, as it reckons itself at the end of the recording."""

    name: str
    live: float  # running RMSE against the return, in the cumulant's unit; NaN if it was not known
    again: float


@dataclass(slots=True)
class Comparison:
    """Of a whole recording, tick by tick."""

    ticks: int = 0
    equal: int = 0
    first_other: int = -1
    """The first tick that was thought differently; -1: none was."""
    broken: int = 0
    """Ticks that broke live: what they read is not recorded, so from the first on nothing need be equal."""
    engaged: tuple[int, int] = (0, 0)
    """Ticks in which the assist was engaged: live, and again."""
    errors: list[Error] = field(default_factory=list)
    gvfs: list[GvfError] = field(default_factory=list)


def compared(recorded: Iterable[Tick], relearner: Relearner) -> Comparison:
    """Learn again from every tick and compare."""
    found = Comparison()
    live, again = _Series(), _Series()
    last: tuple[Frame, Frame] | None = None
    for tick in recorded:
        frame = relearner.step(tick)
        _count(found, tick.frame, frame)
        live.take(tick.frame)
        again.take(frame)
        last = tick.frame, frame
    found.gvfs = _own(*last) if last else []
    errors = again.errors()
    found.errors = [Error(*key, error, errors[key]) for key, error in live.errors().items() if key in errors]
    return found


def _own(live: Frame, again: Frame) -> list[GvfError]:
    told, now = live.learn.error, again.learn.error
    return [GvfError(name, told.get(name, nan), now.get(name, nan)) for name in again.learn.predictions]


def _count(found: Comparison, live: Frame, again: Frame) -> None:
    same = same_thoughts(live, again)
    found.ticks += 1
    found.equal += same
    found.broken += not live.whole
    found.engaged = (found.engaged[0] + live.assist.engaged, found.engaged[1] + again.assist.engaged)
    if not same and found.first_other < 0:
        found.first_other = live.tick


class _Series:
    """Positions and predictions of every tick, by joint."""

    def __init__(self) -> None:
        self._positions: dict[str, list[float]] = {}
        self._predicted: dict[tuple[str, str], list[float]] = {}
        self._ticks = 0

    def take(self, frame: Frame) -> None:
        """One more tick; what is not known in it is nan."""
        for joint in frame.joints:
            fresh = joint.freshness is Freshness.FRESH
            self._positions.setdefault(joint.name, []).append(joint.position if fresh else float("nan"))
            for timescale, value in joint.predictions.items():
                known = self._predicted.setdefault((joint.name, timescale), [float("nan")] * self._ticks)
                known.append(value)
        self._ticks += 1
        for series in self._predicted.values():
            series.extend([float("nan")] * (self._ticks - len(series)))

    def errors(self) -> dict[tuple[str, str], float]:
        """Root mean square (rad) against the ideal predictions, where both are known."""
        return {(name, scale): error for name, scale, error in self._errors()}

    def _errors(self) -> Iterator[tuple[str, str, float]]:
        for (name, scale), values in self._predicted.items():
            positions = _held(np.array(self._positions[name]))
            difference = np.array(values) - ideal_predictions(positions, float(scale))
            known = difference[np.isfinite(difference)]
            if len(known):
                yield name, scale, float(np.sqrt(np.mean(known**2)))


def _held(positions: NDArray[np.float64]) -> NDArray[np.float64]:
    """Positions with the last known one where there is none."""
    known = np.flatnonzero(np.isfinite(positions))
    if not len(known):
        return positions
    places = np.searchsorted(known, np.arange(len(positions)), side="right") - 1
    return positions[known[np.maximum(places, 0)]]
