"""Two antagonists over their own electrodes: movements to and fro, and squeezes of both that are meant."""

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from bentod.frames import Samples

LAG_S = 0.07
"""Time constant from the intent to the activation of a muscle, as of the simulated wearer."""

EXPONENT = 1.5
"""Amplitude grows as activation to this power, as of the simulated wearer: an assumption."""

Shares: TypeAlias = NDArray[np.float64]
"""Of the loudness of a strong contraction, shape (n, 2)."""


@dataclass(frozen=True, slots=True)
class Arm:
    """Loudness (mean absolute value, V) of the two at rest and in a strong contraction.

    The numbers are those of a biceps and a triceps in a recording of 105 s, in which thresholds of 15 and
    10 µV left both above theirs for 5.7 % of the time, and no toggle was meant.
    """

    rest: tuple[float, float] = (2.5e-6, 3.2e-6)
    strong: tuple[float, float] = (60e-6, 35e-6)


@dataclass(frozen=True, slots=True)
class Habits:
    """How somebody moves to and fro; pairs are the least and the most, drawn evenly between."""

    first_s: tuple[float, float] = (1.2, 3.2)  # contraction of the first muscle
    second_s: tuple[float, float] = (0.5, 1.3)  # and of the second
    share: tuple[float, float] = (0.4, 1.0)  # of a strong contraction
    rests: float = 0.5  # how many of the turns have a rest in between; the others go over at once
    rest_s: tuple[float, float] = (0.2, 0.7)
    overlap_s: tuple[float, float] = (-0.1, 0.25)  # of the intents; the muscles' own lag adds to it
    company: tuple[float, float] = (
        0.0,
        0.3,
    )  # loudness of the antagonist, as a share of the muscle that moves


@dataclass(frozen=True, slots=True)
class Squeezing:
    """How somebody squeezes both, from rest; pairs are the least and the most, drawn evenly between."""

    share: tuple[float, float] = (0.45, 1.0)  # of a strong contraction
    scatter: float = 0.15  # of each muscle about that, standard deviation of the logarithm
    length_s: tuple[float, float] = (0.25, 2.0)
    skew_s: float = 0.03  # standard deviation from the intent of one to that of the other
    rest_s: tuple[float, float] = (0.5, 1.2)


def to_and_fro(seconds: float, rate_hz: float, seed: int, habits: Habits = Habits()) -> Samples:
    """V, shape (n, 2), of somebody who moves one joint to and fro and never means a toggle."""
    draw = np.random.default_rng([seed, 1])
    intent = np.zeros((round(seconds * rate_hz), 2))
    time, muscle = 0.5, 0
    while time < seconds:
        end = time + draw.uniform(*(habits.first_s, habits.second_s)[muscle])
        own = draw.uniform(*habits.share)
        both = own * np.array([1.0, draw.uniform(*habits.company)])
        _put(intent, (time, end), both[:: 1 if muscle == 0 else -1], rate_hz)
        turns = draw.random() < habits.rests
        time = end + (draw.uniform(*habits.rest_s) if turns else -draw.uniform(*habits.overlap_s))
        muscle = 1 - muscle
    return volts(intent, rate_hz, seed)


def squeezes(
    count: int, rate_hz: float, seed: int, squeezing: Squeezing = Squeezing()
) -> tuple[Samples, list[int]]:
    """V, shape (n, 2), of somebody who squeezes so many times; the index at which each is intended."""
    draw = np.random.default_rng([seed, 2])
    onsets, stretches, time = [], [], 1.0
    for _ in range(count):
        onsets.append(round(time * rate_hz))
        skew = np.maximum(draw.normal(0.0, squeezing.skew_s) * np.array([1.0, -1.0]), 0.0)
        share = draw.uniform(*squeezing.share) * np.exp(draw.normal(0.0, squeezing.scatter, 2))
        end = time + draw.uniform(*squeezing.length_s)
        stretches += [(time + skew[i], end, np.where(np.arange(2) == i, share, 0.0)) for i in range(2)]
        time = end + draw.uniform(*squeezing.rest_s)
    intent = np.zeros((round((time + 1.0) * rate_hz), 2))
    for start, end, share in stretches:
        _put(intent, (start, end), share, rate_hz)
    return volts(intent, rate_hz, seed), onsets


def volts(intent: Shares, rate_hz: float, seed: int, arm: Arm = Arm()) -> Samples:
    """What electrodes pick up (V, shape (n, 2)) when each muscle is meant to be so loud."""
    decay = np.exp(-1 / (LAG_S * rate_hz))
    activation, now = np.empty_like(intent), np.zeros(2)
    wanted = intent ** (1 / EXPONENT)
    for i, level in enumerate(wanted):
        now = decay * now + (1 - decay) * level
        activation[i] = now
    noise = np.random.default_rng([seed, 3]).normal(0.0, np.sqrt(np.pi / 2), (2, *intent.shape))
    loud = np.array(arm.strong) * activation**EXPONENT
    return np.asarray(loud * noise[0] + np.array(arm.rest) * noise[1], np.float32)


def _put(intent: Shares, stretch: tuple[float, float], shares: Shares, rate_hz: float) -> None:
    """Let both be at least as loud as `shares` for a stretch (s)."""
    start, end = (round(time * rate_hz) for time in stretch)
    intent[start:end] = np.maximum(intent[start:end], shares)
