"""What all steps of a calibration say together, in sentences and as keys of the config."""

import math
import statistics
from collections.abc import Collection, Sequence
from dataclasses import dataclass

from bentod.calibration.estimate import Estimate, Record, estimate
from bentod.errors import Refused

DEAD_TIME, ACCELERATION = "dead_time_s", "goal_acceleration_rad_s2"
"""Keys of a joint's hardware that are calibrated, in drivers that have them."""

ALIKE = 0.3
"""Share by which decelerations in single pairs of steps may differ from that in all."""

LOOSE = 0.002
"""s by which dead times may differ besides."""

AGREES = 0.1
"""Share by which a measured deceleration may differ from the config's and be the same."""


@dataclass(frozen=True, slots=True)
class Summary:
    """A calibrated joint."""

    whole: Estimate  # from all steps
    shortest: float  # s, the least dead time that two steps, to and fro, gave by themselves
    longest: float  # s, the greatest
    steps: int
    interval: float  # s between two readings, median
    believed: float  # rad/s², the config's acceleration; 0: unlimited

    @property
    def trusted(self) -> bool:
        """Whether the steps agree well enough for the config."""
        return _near([self.shortest, self.longest])

    @property
    def differs(self) -> bool:
        """Whether the joint slows down otherwise than the config says."""
        return abs(self.whole.deceleration - self.believed) > AGREES * self.believed

    def lines(self) -> list[str]:
        """For a person."""
        return [
            f"dead time     {self.whole.dead_time * 1e3:.1f} ms, between {self.shortest * 1e3:.1f} and "
            f"{self.longest * 1e3:.1f} ms in {self.steps} steps "
            f"(a reading every {self.interval * 1e3:.1f} ms, "
            f"{math.degrees(self.whole.error):.2f} degrees unexplained)",
            f"deceleration  {_limit(self.whole.deceleration)}"
            + (f"; the config says {_limit(self.believed)}" if self.differs else ", as the config says"),
        ]

    def values(self, known: Collection[str]) -> dict[str, float]:
        """What to write into the config, of the keys that the driver knows."""
        found = {DEAD_TIME: round(self.whole.dead_time, 4)}
        if self.differs:
            found[ACCELERATION] = round(self.whole.deceleration, 3)
        return {key: value for key, value in found.items() if key in known}


def summarise(records: Sequence[Record], joint: str, believed: float) -> Summary:
    """All steps at once, and each pair by itself for the spread.

    Raises:
        Refused: too few readings, or the joint did not move as it was told.
    """
    try:
        return _summarise(records, believed)
    except ValueError as error:
        raise Refused(f"Joint {joint} cannot be calibrated: {error}") from error


def _summarise(records: Sequence[Record], believed: float) -> Summary:
    pairs = [records[i : i + 2] for i in range(0, len(records), 2)]
    whole, single = estimate(records, believed), [estimate(pair, believed) for pair in pairs]
    if not _agree(whole, single):
        whole = estimate(records, believed, settled=True)
        single = [estimate(pair, believed, settled=True) for pair in pairs]
    intervals = [
        later - earlier
        for record in records
        for earlier, later in zip(record.times[:-1], record.times[1:], strict=True)
    ]
    return Summary(
        whole=whole,
        shortest=min(one.dead_time for one in single),
        longest=max(one.dead_time for one in single),
        steps=len(records),
        interval=float(statistics.median(intervals)),
        believed=believed,
    )


def _agree(whole: Estimate, single: Sequence[Estimate]) -> bool:
    """Whether each pair of steps says what all of them say: otherwise noise was taken for a ramp."""
    alike = all(abs(one.deceleration - whole.deceleration) <= ALIKE * whole.deceleration for one in single)
    return alike and _near([one.dead_time for one in single])


def _near(times: Sequence[float]) -> bool:
    return max(times) - min(times) <= LOOSE + ALIKE * statistics.median(times)


def _limit(acceleration: float) -> str:
    return f"{acceleration:.2f} rad/s²" if acceleration > 0 else "not limited"
