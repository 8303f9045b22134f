"""How good what was collected is, class by class, in figures and sentences."""

from collections.abc import Sequence

import numpy as np

from bentod.emg.live.alignment import Moved
from bentod.emg.live.collection import Session
from bentod.frames import Samples, Value

WEAK = 2.0
"""Times rest, below which a class is told to be weak."""

MOST_CLIPPED, MOST_MISSING = 0.01, 0.01
"""Shares of a class's samples above which somebody is told."""


def clipped(samples: Samples) -> float:
    """Greatest share, of any channel, of samples that stay at the channel's own extreme three in a row."""
    if len(samples) < 3:
        return 0.0
    volts = np.nan_to_num(samples)
    edge = (volts == volts.max(axis=0)) | (volts == volts.min(axis=0))
    held = edge[:-2] & edge[1:-1] & edge[2:] & (np.ptp(volts, axis=0) > 0)
    same = (volts[:-2] == volts[1:-1]) & (volts[1:-1] == volts[2:])
    return float((held & same).mean(axis=0).max())


def missing(samples: Samples) -> float:
    """Share of samples of which a channel is not known."""
    return float(1.0 - np.isfinite(samples).all(axis=1).mean()) if len(samples) else 0.0


def quality(session: Session, moved: Sequence[Moved]) -> dict[str, Value]:
    """By class: signal over rest, clipped and missing shares, and how much its labels were moved (s)."""
    labels = dict.fromkeys(one.prompt.label for one in moved)
    return {label: _of([one for one in moved if one.prompt.label == label], session) for label in labels}


def _of(moved: Sequence[Moved], session: Session) -> dict[str, Value]:
    samples = np.concatenate([session.samples[one.onset : one.release] for one in moved])
    over = [min(one.over_rest, 1e6) for one in moved]
    return {
        "over_rest": float(np.median(over)),
        "clipped": clipped(samples),
        "missing": missing(samples),
        "moved_s": [one.delay_s(session.rate_hz) for one in moved],
        "aligned": [one.aligned for one in moved],
        "made": [one.made for one in moved],
    }


def warnings(found: dict[str, Value], moved: Sequence[Moved], rate_hz: float) -> list[str]:
    """A sentence for whatever somebody should know before they train."""
    told = [one.text(rate_hz) for one in moved if not (one.made and one.aligned)]
    for label, values in found.items():
        if not isinstance(values, dict):
            continue
        over, cut, gone = (values[key] for key in ("over_rest", "clipped", "missing"))
        if isinstance(over, float) and over < WEAK:
            told.append(f"{label} is weak: {over:.1f} times the signal at rest.")
        if isinstance(cut, float) and cut > MOST_CLIPPED:
            told.append(f"{label} is clipped in {100 * cut:.0f} % of its samples: lower the amplification.")
        if isinstance(gone, float) and gone > MOST_MISSING:
            told.append(f"{label} lacks {100 * gone:.0f} % of its samples.")
    return told
