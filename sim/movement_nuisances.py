"""What wires, skin and converters do to muscle signals, each of which can be switched on."""

from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from drivers.emg.options import Table

ARTEFACT_S = 0.15
"""How long a cable that was touched swings."""


class Nuisances(Table):
    """All are off at 0."""

    hum_v: Annotated[float, Field(ge=0, le=1)] = 0.0
    """Peak of the mains hum, the same on all channels."""
    hum_hz: Annotated[float, Field(ge=45, le=65)] = 50.0
    offset_v: Annotated[float, Field(ge=0, le=1)] = 0.0
    """Standard deviation, between channels, of a constant."""
    artefacts_per_min: Annotated[float, Field(ge=0, le=600)] = 0.0
    artefact_v: Annotated[float, Field(ge=0, le=1)] = 0.0
    """Peak of the swing when a cable moves, on all channels in different shares."""
    dead: tuple[Annotated[int, Field(ge=0, le=63)], ...] = ()
    """Channels that are flat."""
    dropout: Annotated[float, Field(ge=0, le=0.9)] = 0.0
    """Share of the time in which single channels are flat, 0.3 s at once."""
    roll: Annotated[int, Field(ge=-63, le=63)] = 0
    """Electrodes by which the band was put on turned."""
    rail_v: Annotated[float, Field(ge=0, le=10)] = 0.0
    """Where the converter ends."""
    bits: Annotated[int, Field(ge=0, le=24)] = 0
    """Of the converter, between its rails; needs `rail_v`."""
    counts_v: Annotated[float, Field(ge=0, le=1e-3)] = 0.0
    """V of one count of an armband that gives whole numbers from −128 to 127; rest has exact zeros."""


MYO = Nuisances(counts_v=5e-6)
"""The Myo's numbers: for 8 channels at 200 Hz."""


def spoil(volts: NDArray[np.float64], rate_hz: float, options: Nuisances, seed: int) -> NDArray[np.float64]:
    """What arrives of `volts` (shape (samples, channels)); every nuisance has chance of its own."""
    chance = [np.random.default_rng([seed, 5, which]) for which in range(3)]
    spoilt = np.roll(volts, options.roll, axis=1)
    count, channels = spoilt.shape
    if options.hum_v:
        hum = np.sin(2 * np.pi * options.hum_hz / rate_hz * np.arange(count))
        spoilt += options.hum_v * hum[:, np.newaxis]
    spoilt += options.offset_v * chance[0].standard_normal(channels)
    spoilt += options.artefact_v * _swings(count, channels, rate_hz, options.artefacts_per_min, chance[1])
    spoilt[_flat(count, channels, rate_hz, options, chance[2])] = 0.0
    return _converted(spoilt, options)


def _swings(
    count: int, channels: int, rate_hz: float, per_min: float, random: np.random.Generator
) -> NDArray[np.float64]:
    """A decaying swing at 4 Hz for every touch."""
    swings = np.zeros((count, channels))
    time = np.arange(round(4 * ARTEFACT_S * rate_hz)) / rate_hz
    shape = np.exp(-time / ARTEFACT_S) * np.sin(2 * np.pi * 4.0 * time)
    for start in random.integers(0, count, random.poisson(per_min * count / rate_hz / 60)).tolist():
        piece = shape[: count - start, np.newaxis]
        swings[start : start + len(piece)] += piece * random.uniform(-1, 1, channels)
    return swings


def _flat(
    count: int, channels: int, rate_hz: float, options: Nuisances, random: np.random.Generator
) -> NDArray[np.bool_]:
    """Where nothing is seen."""
    piece = max(1, round(0.3 * rate_hz))
    lost = random.random((-(-count // piece), channels)) < options.dropout
    lost[:, [channel for channel in options.dead if channel < channels]] = True
    return np.repeat(lost, piece, axis=0)[:count]


def _converted(volts: NDArray[np.float64], options: Nuisances) -> NDArray[np.float64]:
    if options.rail_v:
        volts = np.clip(volts, -options.rail_v, options.rail_v)
        if options.bits:
            least = 2 * options.rail_v / 2**options.bits
            volts = np.rint(volts / least) * least
    if options.counts_v:
        volts = np.clip(np.rint(volts / options.counts_v), -128, 127) * options.counts_v
    return volts
