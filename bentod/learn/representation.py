"""The state as learners see it: tile-coded joint angles, their history traces, and a bias (thesis 5.3)."""

import math
from collections.abc import Sequence

import numpy as np

from bentod.contracts import Features
from bentod.learn.tiles import TileCoder
from bentod.learn.traces import HistoryTraces


class Representation:
    """Binary features of some joints' positions. `limits`: rad, (minimum, maximum) of each joint.

    Twice as many dimensions are tiled as there are joints: each joint's angle, normalised over its limits
    and clamped to them, then each joint's trace of that. The last feature, with index `memory`, is the bias;
    it is always active.
    """

    def __init__(
        self,
        limits: Sequence[tuple[float, float]],
        tilings: int = 100,
        width: float = 1.0,
        memory: int = 2048,
        trace_decay: float = 0.99,
    ) -> None:
        for low, high in limits:
            if not (math.isfinite(high - low) and low < high):
                raise ValueError(
                    f"A joint's range must have a minimum below its maximum, not {low} to {high}."
                )
        self._lows = tuple(low for low, _ in limits)
        self._spans = tuple(high - low for low, high in limits)
        self._tiles = TileCoder(2 * len(limits), tilings, width, memory)
        self._traces = HistoryTraces(trace_decay)
        self.size = memory + 1
        """Number of features."""
        self.active = tilings + 1
        """Nominal number of active features; hash collisions make it smaller by a few, never larger."""

    def features(self, positions: Sequence[float]) -> Features:
        """The features of one time step. `positions`: rad, one for each of the limits, in their order.

        Every call is one step of the history traces.

        Raises:
            ValueError: a position is not a finite number; the traces are then as they were.
        """
        angles = self._normalised(positions)
        tiles = self._tiles.encode(angles + self._traces.step(angles))
        return np.append(tiles, self._tiles.memory)

    def restart(self) -> None:
        """Begin the history traces anew at the next position, e.g. after a gap in the readings."""
        self._traces.restart()

    def _normalised(self, positions: Sequence[float]) -> list[float]:
        if not all(map(math.isfinite, positions)):
            raise ValueError(f"Joint positions must be finite numbers, not {list(positions)}.")
        scaled = zip(positions, self._lows, self._spans, strict=True)
        return [min(max((p - low) / span, 0.0), 1.0) for p, low, span in scaled]
