"""From the record of steps to a joint's dead time and deceleration: pure.

A servo follows a reference r by a proportional loop, so its position x lags behind r by an angle in
proportion to the duty of its motor (measured by Rhoban/bam, `bam/dynamixel/actuator.py`), whatever friction,
gravity and inertia do. The load u that it shows is that duty, or else a current, from which the duty differs
by a share of the velocity ω. So x + K u + B ω is the reference itself, which starts when the command takes
effect. Of a step of the length D at the speed v, with the ramp τ = v/a,

    x(t) = c + g v (ρ(t - T) - ρ(t - T - D/v)) - K u(t) - B ω(t)
    ρ(s) = 0 before 0, s²/2τ during the ramp, s - τ/2 after it

c (of each step), g, K and B are found by linear least squares; T, v and τ by search.
A position alone would not do: a lag that grows with speed looks just like 20 to 30 ms more of dead time.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

ONSETS = (0.0, 0.01, 0.02, 0.04, 0.07, 0.1)
"""s: where the search for the dead time starts; the longest that was measured on a servo of this kind is
50.2 ms (Smith & Jivraj)."""

RAMPS = (0.0, 0.03, 0.1, 0.3, 1.0)
"""s: where the search for the ramp starts."""

WORTH, SURE = 1.1, 1.3
"""What explains the readings no better than by this factor would fit noise, and is left out; for another ramp
than the one that is believed it takes the second."""

ONSET_STEP, SPEED_STEP, RAMP_STEP, HALVINGS = 0.008, 0.02, 0.03, 9
"""s, share, s: the first steps of the search, and how often they are halved."""

PROMISING = 3
"""Of the starts, so many are followed."""

REST = 0.015
"""s of rest before and after the motion that are looked at."""

FEWEST = 12
"""Readings in which a start can be found."""


@dataclass(frozen=True, slots=True)
class Record:
    """Readings around one step, the command being given at time 0. Arrays have the shape (readings,)."""

    times: Array  # s
    positions: Array  # rad
    velocities: Array  # rad/s
    loads: Array  # share of the greatest torque
    distance: float  # rad, signed: how far the step was to go
    speed: float  # rad/s, above 0: how fast


@dataclass(frozen=True, slots=True)
class Motion:
    """How a reference moves."""

    dead_time: float  # s
    speed: float  # rad/s, above 0
    ramp: float  # s, 0 or more


@dataclass(frozen=True, slots=True)
class Estimate:
    """What steps say."""

    dead_time: float  # s
    deceleration: float  # rad/s²; 0: it is not limited, or by too little to be seen
    error: float  # rad, root mean square of what the model leaves


def estimate(records: Sequence[Record], acceleration: float = 0.0, settled: bool = False) -> Estimate:
    """What steps in both directions say together.

    `acceleration` (rad/s²; 0: no ramp) is believed unless the steps say clearly otherwise, or always if it
    is `settled`.

    Raises:
        ValueError: too few readings, or the joint did not move as it was told.
    """
    for record in records:
        _check(record)
    known = records[0].speed / acceleration if acceleration > 0 else 0.0
    records = [_trimmed(record) for record in records]
    plain, full = (_fit(records, known, settled, with_velocity) for with_velocity in (False, True))
    motion, error = plain if plain[1] < WORTH * full[1] else full
    return Estimate(motion.dead_time, motion.speed / motion.ramp if motion.ramp > 0 else 0.0, error)


def reference(times: Array, distance: float, motion: Motion) -> Array:
    """Way (rad) of a reference that is told at time 0 to go `distance` (rad, signed)."""
    speed, ramp = motion.speed, motion.ramp
    if ramp * speed > abs(distance):  # it slows down again before it has reached its speed
        share = math.sqrt(abs(distance) / (ramp * speed))
        speed, ramp = speed * share, ramp * share
    since = times - motion.dead_time
    way = _running(since, ramp) - _running(since - abs(distance) / speed, ramp)
    return math.copysign(speed, distance) * way


def _running(since: Array, ramp: float) -> Array:
    """ρ, s."""
    running = np.maximum(since, 0.0)
    if ramp < 1e-6:
        return running
    return np.where(running < ramp, running**2 / (2 * ramp), running - ramp / 2)


class _Stack:
    """Steps that share everything but their constants."""

    def __init__(self, records: Sequence[Record], with_velocity: bool) -> None:
        self._records = records
        columns = [_joined([record.loads for record in records])]
        if with_velocity:
            columns.append(_joined([record.velocities for record in records]))
        varying = [column for column in columns if np.ptp(column) > 1e-6]
        self._known = (
            np.linalg.qr(np.stack(varying, axis=1))[0] if varying else np.zeros((len(columns[0]), 0))
        )
        self._rest = self._without(_joined([record.positions for record in records]))

    def error(self, motion: Motion) -> float:
        """Root mean square (rad) of what `motion` does not explain."""
        ways = [reference(record.times, record.distance, motion) for record in self._records]
        way = self._without(_joined(ways))
        share = way @ self._rest / (way @ way + 1e-15)
        return float(np.sqrt(np.mean((self._rest - share * way) ** 2)))

    def _without(self, values: Array) -> Array:
        return values - self._known @ (self._known.T @ values)


def _joined(parts: Sequence[Array]) -> Array:
    """All readings in one row, each step less its mean."""
    return np.concatenate([part - part.mean() for part in parts])


def _fit(records: Sequence[Record], known: float, settled: bool, with_velocity: bool) -> tuple[Motion, float]:
    """The best motion and its error: that with the known ramp (s), unless another is clearly better."""
    error = _Stack(records, with_velocity).error
    speed = records[0].speed
    fixed = _best(
        error, [Motion(onset, speed, known) for onset in ONSETS], (ONSET_STEP, SPEED_STEP * speed, 0.0)
    )
    if settled:
        return fixed
    starts = [Motion(onset, speed, ramp) for onset in (fixed[0].dead_time, *ONSETS) for ramp in RAMPS]
    free = _best(error, starts, (ONSET_STEP, SPEED_STEP * speed, RAMP_STEP))
    return fixed if fixed[1] < SURE * free[1] else free


def _best(
    error: Callable[[Motion], float], starts: Sequence[Motion], steps: tuple[float, float, float]
) -> tuple[Motion, float]:
    """The best that a search from the most promising of `starts` leads to."""
    promising = sorted(starts, key=error)[:PROMISING]
    return min((_descend(error, start, steps) for start in promising), key=lambda found: found[1])


def _descend(
    error: Callable[[Motion], float], motion: Motion, steps: tuple[float, float, float]
) -> tuple[Motion, float]:
    """Pattern search: try a step either way along each parameter, halve the steps when none helps."""
    least = error(motion)
    for _ in range(HALVINGS):
        better = True
        while better:
            tried = [(error(near), near) for near in _neighbours(motion, steps)]
            best = min(tried, key=lambda one: one[0])
            better = best[0] < least
            if better:
                least, motion = best
        steps = (steps[0] / 2, steps[1] / 2, steps[2] / 2)
    return motion, least


def _neighbours(motion: Motion, steps: tuple[float, float, float]) -> list[Motion]:
    onset, speed, ramp = steps
    changes = [(onset, 0.0, 0.0), (0.0, speed, 0.0), (0.0, 0.0, ramp), (-ramp / 2, 0.0, ramp)]
    return [
        Motion(max(motion.dead_time + s * a, 0.0), motion.speed + s * b, max(motion.ramp + s * c, 0.0))
        for a, b, c in changes
        if a or b or c
        for s in (1, -1)
    ]


def _trimmed(record: Record) -> Record:
    """Without most of the rest at both ends, where one rounding of the position counts again and again."""
    moved = np.flatnonzero(np.diff(record.positions))
    last = record.times[moved[-1] + 1] + REST
    kept = (record.times >= -REST) & (record.times <= last)
    return replace(
        record,
        times=record.times[kept],
        positions=record.positions[kept],
        velocities=record.velocities[kept],
        loads=record.loads[kept],
    )


def _check(record: Record) -> None:
    moving = (record.times > 0) & (record.times <= abs(record.distance) / record.speed)
    if np.count_nonzero(moving) < FEWEST:
        raise ValueError(
            f"there are only {np.count_nonzero(moving)} readings while it moved, {FEWEST} are needed; "
            "is the latency timer of the adapter at 1 ms? (`bentod doctor`)"
        )
    moved = (record.positions[-1] - record.positions[0]) / record.distance
    if not 0.5 <= moved <= 1.5:
        raise ValueError(f"it went {moved:.0%} of the way that it was told to go; is it blocked?")
