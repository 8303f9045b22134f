"""One combination of a sweep thought through: a recording learned from with other parameters."""

from collections.abc import Sequence
from math import isfinite
from pathlib import Path

from bentod.errors import BentodError
from bentod.record.reader import Recording
from bentod.record.session import Header
from bentod.replay.altered import altered, relearner
from bentod.replay.comparison import Comparison, compared
from bentod.replay.relearn import ticks
from bentod.replay.sweep import Measure, Outcome, Point


def check(header: Header, tried: Sequence[Point]) -> None:
    """Before anything runs. Raises ConfigError: a combination is none that the config allows."""
    for point in tried:
        altered(header, point.changes)


def thought(file: Path, point: Point) -> Outcome:
    """Learn from a recording with the parameters of `point`. What goes wrong is told in the outcome."""
    try:
        with Recording(file) as recording:
            found = compared(ticks(recording.entries()), relearner(recording.header, point.changes))
    except BentodError as error:
        return Outcome(point, failed=str(error))
    except Exception as error:  # noqa: BLE001 -- whatever is wrong with one combination, the others count
        return Outcome(point, failed=f"{type(error).__name__}: {error}")
    return Outcome(point, _measures(found), found.ticks, found.equal)


def _measures(found: Comparison) -> tuple[Measure, ...]:
    joints = [Measure(f"{e.joint}@{e.timescale}", e.live, e.again) for e in found.errors]
    own = [Measure(e.name, e.live, e.again) for e in found.gvfs if isfinite(e.live + e.again)]
    return (*joints, *own)
