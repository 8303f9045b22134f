"""From how loud a site is at rest and in a contraction to its threshold and maximum: pure."""

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bentod.errors import Refused

Levels = NDArray[np.float64]
"""V after gain, one a look at the envelope; NaN where it was not known."""

SCATTER = 3.0
"""Standard deviations from the mean of rest to the threshold: of what scatters as a Gaussian does, one look
in 740 is above."""

ABOVE_REST = 1.2
"""Times the loudest 5 % of rest that the threshold is at least: an envelope's scatter has a longer tail."""

STRONGEST = 95
"""Percentile of a contraction that counts as the strongest that was held."""

SHARE = 0.8
"""Of the strongest contraction, at which effort is full: who had to do their utmost for it would tire."""

SEPARATE = 2.0
"""Times the threshold that the maximum is at least. Nearer, efforts can hardly be graded: the mean over 50 ms
of a steady contraction scatters by a quarter."""

TOGGLE = 0.3
"""Of the strongest contraction, that the threshold of a toggle site is at least: neither a rare peak of rest
nor a muscle that works along a little is meant as a toggle."""

RESTLESS = 3.0
"""Times the median of rest that its loudest 5 % are at the most, if it was rest."""

LEAST = 20
"""Looks that must be known, of rest and of a contraction each."""


@dataclass(frozen=True, slots=True)
class Setting:
    """What a site should be set to, and why."""

    site: str
    rest: float  # V after gain: mean
    scatter: float  # V after gain: standard deviation of rest
    contraction: float  # V after gain: the strongest that was held
    threshold: float  # V after gain
    maximum: float  # V after gain
    remarks: tuple[str, ...]  # sentences about what may be wrong

    @property
    def ratio(self) -> float:
        """How far the contraction stands out: maximum over threshold."""
        return self.maximum / self.threshold if self.threshold else math.inf

    @property
    def separable(self) -> bool:
        """Whether the contraction is far enough above rest to be of use."""
        return self.maximum > 0 and self.ratio >= SEPARATE

    def lines(self) -> list[str]:
        """For a person: volts as a row of a table would have them, and every remark."""
        told = (
            f"{self.site}: rest {self.rest:.3g} ± {self.scatter:.2g} V, held {self.contraction:.3g} V; "
            f"threshold_v = {self.threshold:g}, max_v = {self.maximum:g} ({self.ratio:.1f} times as much)"
        )
        return [told, *(f"  {remark}" for remark in self.remarks)]


def settings(
    rest: Mapping[str, Levels],
    contractions: Mapping[str, Mapping[str, Levels]],
    scatter: float = SCATTER,
    share: float = SHARE,
    toggles: Collection[str] = (),
) -> list[Setting]:
    """What the sites that were contracted should be set to.

    `rest`: by site, when all were at rest. `contractions`: by the site that was to be contracted, what
    every site showed meanwhile. `scatter`: standard deviations; `share`: of the strongest contraction.
    `toggles`: sites of which a contraction toggles.

    Raises:
        Refused: too little is known of a site.
    """
    least = {site: TOGGLE if site in toggles else 0.0 for site in contractions}
    found = [
        _setting(site, rest[site], seen[site], scatter, share, least[site])
        for site, seen in contractions.items()
    ]
    return [_with_company(one, contractions) for one in found]


def _setting(
    site: str, rest: Levels, contraction: Levels, scatter: float, share: float, least: float
) -> Setting:
    """`least`: of the strongest contraction, that the threshold must be."""
    still = _known(site, "at rest", rest)
    held = float(np.percentile(_known(site, "while it was contracted", contraction), STRONGEST))
    mean, deviation, loudest = float(still.mean()), float(still.std()), float(np.percentile(still, 95))
    threshold = _rounded(max(mean + scatter * deviation, ABOVE_REST * loudest, least * held))
    maximum = _rounded(share * held)
    restless = loudest > RESTLESS * float(np.median(still))
    found = Setting(site, mean, deviation, held, threshold, maximum, ())
    remarks = [
        f"{site} was not at rest all the time: at its loudest {loudest:.3g} V. Try again, and relax."
    ] * restless
    if not found.separable:
        remarks.append(
            f"{site} can hardly be told from rest: its maximum must be {SEPARATE:g} times its threshold, and "
            f"is {found.ratio:.1f} times. It is not changed. Move the electrode, or contract more strongly."
        )
    return replace(found, remarks=tuple(remarks))


def _with_company(one: Setting, contractions: Mapping[str, Mapping[str, Levels]]) -> Setting:
    """With a remark about every other contraction in which this site would have asked for something."""
    remarks = list(one.remarks)
    for other, seen in contractions.items():
        above = float(np.mean(seen[one.site] > one.threshold)) if len(seen[one.site]) else 0.0
        if other != one.site and one.separable and above > 0.1:
            remarks.append(
                f"while {other} was contracted, {one.site} was above its threshold {above:.0%} of the time"
            )
    return replace(one, remarks=tuple(remarks))


def _known(site: str, when: str, levels: Levels) -> Levels:
    known = levels[np.isfinite(levels)]
    if len(known) < LEAST:
        raise Refused(
            f"too little is known of {site} {when}: {len(known)} looks at its envelope, at least {LEAST} are "
            "needed. Measure for longer, and see whether its lead is on."
        )
    return known


def _rounded(volts: float) -> float:
    """To three digits, which is more than a muscle repeats."""
    return float(f"{volts:.3g}")
