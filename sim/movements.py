"""People who make prompted movements of the wrist, with what electrodes round their forearm pick up.

A check of software, and no evidence about people: where muscles lie, how they work together and what a load
adds are plausible guesses of ours, scattered from person to person.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from drivers.emg.options import Table
from sim.movement_nuisances import Nuisances

REST = "rest"
MOVEMENTS = (
    *("wrist_flexion", "wrist_extension", "radial_deviation"),
    *("ulnar_deviation", "pronation", "supination"),
)
"""Six motions of the wrist, as in Fig. 3.3 of the thesis, whose text does not name them."""

Load: TypeAlias = Literal["unloaded", "5 lb", "15 lb", "hammer"]
LOADS: tuple[Load, ...] = ("unloaded", "5 lb", "15 lb", "hammer")
"""What is held meanwhile (thesis 3.4)."""

Array: TypeAlias = NDArray[np.float64]

ANGLES = np.deg2rad([20.0, 65.0, 110.0, 190.0, 230.0, 275.0, 320.0, 350.0])
"""Of the muscles round the forearm: flexor carpi radialis, finger flexors, flexor carpi ulnaris, extensor
carpi ulnaris, extensor digitorum, extensor carpi radialis, supinator with brachioradialis, pronator teres."""

SYNERGIES: Mapping[str, tuple[float, ...]] = {
    "wrist_flexion": (0.7, 0.4, 0.7, 0.1, 0.05, 0.05, 0.0, 0.1),
    "wrist_extension": (0.05, 0.1, 0.1, 0.6, 0.6, 0.7, 0.1, 0.0),
    "radial_deviation": (0.5, 0.1, 0.0, 0.0, 0.2, 0.7, 0.2, 0.1),
    "ulnar_deviation": (0.0, 0.1, 0.7, 0.7, 0.1, 0.0, 0.0, 0.0),
    "pronation": (0.3, 0.1, 0.1, 0.1, 0.05, 0.1, 0.1, 0.8),
    "supination": (0.05, 0.1, 0.1, 0.2, 0.2, 0.2, 0.8, 0.0),
}
"""Activation of each muscle, as a share of its greatest."""

TONIC: Mapping[Load, tuple[float, ...]] = {
    "unloaded": (0.0,) * 8,
    "5 lb": (0.10, 0.22, 0.10, 0.08, 0.14, 0.12, 0.06, 0.04),
    "15 lb": (0.22, 0.48, 0.24, 0.18, 0.32, 0.28, 0.16, 0.10),
    "hammer": (0.38, 0.36, 0.08, 0.04, 0.16, 0.52, 0.20, 0.14),
}
"""What holding adds: finger flexors grip, the wrist is kept stiff. A hammer held by the end of its handle
tips towards the little finger, and the muscles on the side of the thumb hold against it."""

WIDTH = 0.35
"""How far electrodes see: gain e^((cos Δ − 1) / WIDTH) at an angle Δ from a muscle: half at 41 degrees."""


class Scatter(Table):
    """How one contraction differs from the next: shares, as standard deviations of logarithms."""

    effort: Annotated[float, Field(ge=0, le=1)] = 0.15
    """Of the whole contraction, between repetitions."""
    synergy: Annotated[float, Field(ge=0, le=1)] = 0.25
    """Of single muscles, between repetitions."""
    hold: Annotated[float, Field(ge=0, le=1)] = 0.15
    """Of single muscles, within a hold, slower than 2 Hz."""
    day: Annotated[float, Field(ge=0, le=1)] = 0.08
    """Of the gain of single electrodes, and in radians of where the band sits, between days."""


class Drift(Table):
    """What has changed by the end of a session, in proportion to time."""

    amplitude: Annotated[float, Field(ge=-0.9, le=5)] = 0.0
    """Share by which the voltage of a contraction has grown: what fatigue does at equal force."""
    fatigue: Annotated[float, Field(ge=0, le=1)] = 0.0
    """Share of the power that has moved to the spectrum of a tired muscle, 30 % lower in frequency."""
    rotation_rad: Annotated[float, Field(ge=-np.pi, le=np.pi)] = 0.0
    """How far the electrodes have turned round the forearm."""


class Prompted(Table):
    """A session of prompted movements."""

    electrodes: Annotated[int, Field(ge=1, le=64)] = 4
    """Channels, evenly round the forearm (thesis 3.4)."""
    person: Annotated[int, Field(ge=0, le=2**32 - 1)] = 1
    """Whose muscles."""
    session: Annotated[int, Field(ge=0, le=2**32 - 1)] = 1
    """Seed of the order, of all scatter, and of the noise."""
    day: Annotated[int, Field(ge=0, le=2**32 - 1)] = 0
    """Sessions of one day share what differs from day to day."""
    load: Load = "unloaded"
    load_share: Annotated[float, Field(ge=0, le=3)] = 1.0
    """Of the usual weight."""
    repetitions: Annotated[int, Field(ge=1, le=100)] = 6
    """Of each movement; the order is random."""
    hold_s: Annotated[float, Field(ge=0.5, le=30)] = 3.0
    rest_s: Annotated[float, Field(ge=0.5, le=30)] = 3.0
    reaction_s: tuple[Annotated[float, Field(ge=0, le=1)], Annotated[float, Field(ge=0, le=1)]] = (0.15, 0.45)
    """From a prompt to the muscle: least and greatest."""
    ramp_s: Annotated[float, Field(ge=0, le=2)] = 0.2
    """From rest to the whole contraction."""
    effort: Annotated[float, Field(ge=0, le=2)] = 0.8
    """Share of the greatest contraction that is made."""
    full_v: Annotated[float, Field(ge=0, le=1e-2)] = 300e-6
    """Root mean square of a muscle below an electrode that is wholly active."""
    rest_v: Annotated[float, Field(ge=0, le=1e-3)] = 5e-6
    """Root mean square of skin and amplifier."""
    exponent: Annotated[float, Field(ge=0.5, le=3)] = 1.5
    """Voltage grows as activation to this power: an assumption, for want of a measured value."""
    scatter: Scatter = Scatter()
    obeys: bool = False
    """Whether what is asked for at the time is made, rather than a session of their own."""
    drift: Drift = Drift()
    nuisances: Nuisances = Nuisances()


@dataclass(frozen=True, slots=True)
class Person:
    """The forearm of one person."""

    synergies: Mapping[str, Array]  # activation by movement, shape (muscles,)
    tonic: Mapping[Load, Array]  # activation that holding adds, shape (muscles,)
    angles: Array  # rad, of the muscles, shape (muscles,)
    reach: Array  # gain right above each muscle: how near to the skin it lies, shape (muscles,)
    corners: Array  # Hz, of each muscle's spectrum: `spectrum`, shape (muscles, 2)

    def gains(self, electrodes: Array) -> Array:
        """What electrodes at these angles (rad) see of each muscle, shape (electrodes, muscles)."""
        apart = electrodes[:, np.newaxis] - self.angles
        return np.asarray(self.reach * np.exp((np.cos(apart) - 1) / WIDTH))


def person(seed: int) -> Person:
    """One of a population: scattered about the average person."""
    random = np.random.default_rng([seed, 3])
    count = len(ANGLES)

    def scattered(shares: tuple[float, ...], by: float, floor: float = 0.0) -> Array:
        return np.asarray((np.asarray(shares) + floor) * np.exp(by * random.standard_normal(count)))

    return Person(
        {name: scattered(shares, 0.25, 0.02) for name, shares in SYNERGIES.items()},
        {load: scattered(shares, 0.3) for load, shares in TONIC.items()},
        ANGLES + 0.15 * random.standard_normal(count),
        np.exp(0.25 * random.standard_normal(count)),
        np.array([50.0, 110.0]) * np.exp(0.3 * random.standard_normal((count, 2))),
    )


@dataclass(frozen=True, slots=True)
class Prompt:
    """One contraction; all places are sample indices of the lap."""

    movement: str
    repetition: int  # from 0
    shown: int  # the movement is asked for
    onset: int  # the muscles begin
    hidden: int  # rest is asked for
    release: int  # the muscles let go, and are at rest after the ramp


def prompts(options: Prompted, rate_hz: float) -> list[Prompt]:
    """The session's contractions, with a rest before each; within a repetition the order is random."""
    random = np.random.default_rng([options.session, 4])
    found: list[Prompt] = []
    least, most = sorted(options.reaction_s)
    shown = 0.0
    for repetition in range(options.repetitions):
        for movement in random.permutation(MOVEMENTS).tolist():
            shown += options.rest_s
            begin, end = random.uniform(least, most, size=2).tolist()
            times = (shown, shown + begin, shown + options.hold_s, shown + options.hold_s + end)
            found.append(Prompt(movement, repetition, *(round(time * rate_hz) for time in times)))
            shown += options.hold_s
    return found


def lap_samples(options: Prompted, rate_hz: float) -> int:
    """Length of the session, with a rest at its end."""
    each = options.rest_s + options.hold_s
    return round((len(MOVEMENTS) * options.repetitions * each + options.rest_s + 1.0) * rate_hz)
