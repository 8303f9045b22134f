"""What a site does at each sample of a stretch, as whoever watches for contractions needs it."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from bentod.control.proportional import Levels, Site
from bentod.control.switching import RELEASE


class Moment(NamedTuple):
    """One site at one sample. It is neither up nor low between the two, and where nobody knows."""

    up: bool  # above the threshold
    low: bool  # quiet: below the release, and below `RELEASE` of the threshold
    share: float  # of the maximum; NaN where nobody knows
    effort: float  # 0..1


@dataclass(frozen=True, slots=True)
class Heard:
    """A stretch of all sites: levels (V before gain, shape (n, channels)), and efforts (0..1, shape (n,))."""

    sites: Mapping[str, Site]
    levels: Levels
    efforts: Mapping[str, Levels]

    def course(self, name: str) -> Iterator[Moment]:
        """One site, sample by sample."""
        site = self.sites[name]
        volts = self.levels[:, site.channel] * site.gain
        up = volts > site.threshold
        low = volts < min(site.release, RELEASE) * site.threshold
        share = volts / site.maximum
        columns = [np.ndarray.tolist(column) for column in (up, low, share, self.efforts[name])]
        return map(Moment._make, zip(*columns, strict=True))


class Side:
    """Whether a site is contracted, in the eyes of whoever counts contractions."""

    def __init__(self) -> None:
        self.on = False
        """Since it was up, until it is low."""
        self.quiet = 0
        """Samples in a row that it has been low."""
        self.unheard = 0
        """Samples in a row that it has been low or unknown."""

    def see(self, moment: Moment) -> None:
        """Take in one sample; one that nobody knows ends the quiet, and nothing else."""
        self.quiet = self.quiet + 1 if moment.low else 0
        self.unheard = self.unheard + 1 if moment.low or math.isnan(moment.share) else 0
        self.on = moment.up or (self.on and not moment.low)


def let_go(one: Side, other: Side, lapse: int) -> bool:
    """Whether both sites have been quiet for `lapse` samples; one of them may be unknown instead."""
    return min(one.unheard, other.unheard) >= lapse and max(one.quiet, other.quiet) >= lapse
