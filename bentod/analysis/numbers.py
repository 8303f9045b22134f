"""The numbers behind the figures: who moved what, how well it was expected, how punctual the ticks were."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from bentod.analysis.material import Material
from bentod.analysis.table import Floats
from bentod.learn.returns import ideal_predictions

NOBODY = "nobody"
UNKNOWN = "unknown"

HORIZON = 5.0
"""Timescales at the end of a stretch, of which the return is not known: what is missing weighs 0.7 %."""


def way_by_holder(material: Material) -> dict[str, dict[str, float]]:
    """Rad that each joint travelled, by who held it then; `nobody`: coasting, gravity and noise.

    A way across missing ticks is `unknown`.
    """
    broken = material.breaks()[1:]
    return {joint: _ways(material, joint, broken) for joint in material.joints}


def _ways(material: Material, joint: str, broken: NDArray[np.bool_]) -> dict[str, float]:
    way = np.abs(np.diff(material.position(joint)))
    codes, labels = material.ticks.coded(f"{joint}.holder")
    held = codes[:-1]  # what won in a tick moves the joint from that tick to the next
    found = {
        label or NOBODY: float(np.nansum(way[(held == code) & ~broken])) for code, label in enumerate(labels)
    }
    if broken.any():
        found[UNKNOWN] = float(np.nansum(way[broken]))
    return {holder: rad for holder, rad in found.items() if rad > 0}


def ideal(material: Material, joint: str, timescale: float) -> Floats:
    """What a perfect learner would have expected of a joint at each tick (rad).

    NaN within `HORIZON` timescales of the end, and of every place where ticks are missing: there the
    returns are not known.
    """
    position = material.position(joint)
    starts = np.flatnonzero(material.breaks() | ~np.isfinite(position))
    result = np.full(len(position), np.nan)
    for start, end in zip(starts, [*starts[1:], len(position)], strict=True):
        known = end - int(np.ceil(HORIZON * timescale))
        if known > start and np.isfinite(position[start]):
            result[start:known] = ideal_predictions(position[start:end], timescale)[: known - start]
    return result


def prediction_errors(material: Material) -> dict[str, dict[str, float]]:
    """Root mean square of prediction minus ideal return (rad), by joint and timescale in steps."""
    found: dict[str, dict[str, float]] = {}
    for joint in material.joints:
        for timescale, expected in material.predictions(joint).items():
            error = expected - ideal(material, joint, float(timescale))
            if np.isfinite(error).any():
                found.setdefault(joint, {})[timescale] = rms(error)
    return found


def rms(error: Floats) -> float:
    """Root mean square of what is a number; nan if nothing is."""
    known = error[np.isfinite(error)]
    return float(np.sqrt(np.mean(known**2))) if len(known) else float("nan")


def binned_rms(time: Floats, error: Floats, edges: Floats) -> Floats:
    """Root mean square of `error` between each two `edges` of `time`."""
    return np.array([rms(error[(time >= low) & (time < high)]) for low, high in pairwise(edges)])


@dataclass(frozen=True, slots=True)
class Spread:
    """How values are spread."""

    median: float
    p99: float
    maximum: float


def spread(values: Floats) -> Spread:
    """Of what is a number in `values`, of which there must be at least one."""
    median, p99, maximum = np.nanpercentile(values, [50, 99, 100])
    return Spread(float(median), float(p99), float(maximum))


COSTS = ("read", "think", "write", "publish")


def punctuality(material: Material) -> dict[str, Spread]:
    """Lateness, and cost of each phase of a tick (s)."""
    names = {"lateness": "lateness_s", **{cost: f"costs.{cost}_s" for cost in COSTS}}
    return {name: spread(material.ticks.floats(column)) for name, column in names.items()}


def levels_above(material: Material) -> dict[str, float]:
    """Share of the time that each EMG site was above its threshold of the config."""
    levels = material.levels
    if levels is None:
        return {}
    return {
        site.name: float(np.nanmean(levels.volts[:, site.channel] * site.gain > site.threshold))
        for site in material.setup.sites
        if site.channel < levels.volts.shape[1]
    }


def assisted(material: Material) -> float:
    """Share of the ticks in which the assist was engaged."""
    return float(np.mean(material.ticks.floats("assist.engaged")))


def thin(x: Floats, y: Floats, points: int = 1600) -> tuple[Floats, Floats]:
    """The same curve with about as many points: of each stretch its least and greatest value, in order.

    What is not a number stays as a break where a whole stretch is none.
    """
    if len(x) <= points:
        return x, y
    each = int(np.ceil(len(x) / (points // 2)))
    kept = []
    for start in range(0, len(x), each):
        piece = y[start : start + each]
        if np.isfinite(piece).any():
            kept += sorted({start + int(np.nanargmin(piece)), start + int(np.nanargmax(piece))})
        else:
            kept.append(start)
    return x[kept], y[kept]


def events_by_kind(material: Material) -> dict[str, Floats]:
    """Times of events (s since the session started), by kind."""
    found: dict[str, list[float]] = {}
    for event in material.events:
        found.setdefault(event.kind, []).append(event.time - material.header.started)
    return {kind: np.array(times) for kind, times in found.items()}


def stretches(time: Floats, codes: Sequence[int] | NDArray[np.int32]) -> list[tuple[float, float, int]]:
    """Where a value stays the same: start, end and the value."""
    array = np.asarray(codes)
    if not len(array):
        return []
    starts = np.flatnonzero(np.diff(array, prepend=array[0] - 1))
    ends = [*starts[1:], len(array) - 1]
    return [(float(time[a]), float(time[b]), int(array[a])) for a, b in zip(starts, ends, strict=True)]


def plain(found: Mapping[str, Spread]) -> dict[str, dict[str, float]]:
    """For JSON."""
    return {name: {"median": one.median, "p99": one.p99, "max": one.maximum} for name, one in found.items()}
