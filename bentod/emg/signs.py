"""Signs that a signal is no muscle's: a wire that holds one value, an amplifier that is at its rails."""

import math

import numpy as np

from bentod.frames import Samples

STRETCH_S = 0.05
"""s that are looked at: a muscle, whose band begins at 20 Hz, has turned round at least once in it."""

FEWEST = 10
"""Samples that are looked at at least; with fewer a living signal may repeat itself by chance."""

SHARE = 0.6
"""Of the samples, above which they are no muscle's if that many are at the extremes. Of 10 samples of a
living signal two are, of an 8-bit armband's at times six; clipped at its standard deviation, 32 % are."""

EACH = 0.2
"""Of the samples, above which both rails are met by an amplifier that is driven to and fro between them."""

ALIKE = 1e-3
"""Share of the greatest magnitude within which samples are the same: the least bit of a 10-bit converter."""


def stretch(rate_hz: float) -> int:
    """Samples that `lifeless` wants to see."""
    return max(FEWEST, math.ceil(STRETCH_S * rate_hz))


def lifeless(samples: Samples, channel: int, least: float, mean_free: bool = False) -> str:
    """Why the newest samples (V, shape (n, channels)) of a channel are no muscle's; empty when they may be.

    What is not louder than `least` (V, mean magnitude) asks for nothing, and may be as still as it likes.
    `mean_free`: an offset is filtered out before anybody looks at the signal, and so is no sign.
    """
    volts = samples[:, channel].astype(np.float64)
    if mean_free and len(volts):
        volts -= volts.mean()
    if len(volts) < FEWEST or not np.mean(np.abs(volts)) > least:
        return ""
    low, high = float(volts.min()), float(volts.max())
    same = ALIKE * max(abs(low), abs(high))
    lowest, highest = np.mean(volts <= low + same), np.mean(volts >= high - same)
    if max(lowest, highest) > SHARE:
        value = low if lowest > highest else high
        return f"EMG channel {channel} is stuck: of its newest {len(volts)} samples most are {value:.3g} V."
    if lowest + highest > SHARE and min(lowest, highest) > EACH:
        return (
            f"EMG channel {channel} is saturated: of its newest {len(volts)} samples most are {low:.3g} V "
            f"or {high:.3g} V."
        )
    return ""
