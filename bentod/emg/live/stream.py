"""Blocks of raw samples in, decisions out: live, and the same again from a recording."""

import time
from collections.abc import Sequence
from typing import cast

import numpy as np

from bentod.config_recognition import Recognition
from bentod.emg.classify.deciding import Deciding
from bentod.emg.classify.kinds import kind
from bentod.emg.classify.model import Model, Setting
from bentod.emg.classify.pipeline import Pipeline
from bentod.emg.conditioning import Conditioning
from bentod.emg.features.feature_list import FeatureList
from bentod.emg.features.tables import Asking
from bentod.emg.recognition import Decision, Fuse
from bentod.errors import ConfigError
from bentod.frames import Samples

MOST_WINDOWS = 16
"""Windows that are worked on in one go at most, some 2 ms with what is usual."""

TURN_S = 0.008
"""s that they may take together, as far as can be foreseen: nearest neighbours of an hour take 3 ms each."""

NEWEST = 0.2
"""Weight of the newest windows in what a window is taken to cost."""

LARGEST = 100_000
"""Samples times channels of one window; beyond, no tick would be on time."""


def deciding(table: Recognition) -> Deciding:
    """What the config wants done with a classifier's answers."""
    return Deciding(
        table.reject_below, table.votes, table.flutter, table.ramp, table.ramp_down, table.proportional
    )


def features(table: Recognition, channels: int, rate_hz: float) -> FeatureList:
    """What the config wants to be made of each window.

    Raises:
        ConfigError: that cannot be, or there is no classifier of that name to see it.
    """
    kind(table.classifier)
    values = round(table.window_s * rate_hz) * channels
    if values > LARGEST:
        raise ConfigError(
            f"emg.recognition.window_s: a window of {table.window_s:g} s has {values} values of {channels} "
            f"channels at {rate_hz:g} Hz; the bound is {LARGEST}",
            "window_s",
        )
    return FeatureList(cast("list[Asking]", list(table.features)), channels, rate_hz)


class Stream:
    """Conditions and decides by sample index; knows no time, so lateness and blocks change nothing."""

    def __init__(self, setting: Setting, channels: Sequence[int]) -> None:
        """`channels`: of the source, which are looked at. Raises ConfigError: a filter cannot be used."""
        self._channels = list(channels)
        self._conditioning = Conditioning(setting.filters, setting.rate_hz, len(self._channels))
        self._pipeline: Pipeline | None = None
        self._tail = np.zeros((0, len(self._channels)))
        self._kept = setting.segmenting.length - 1
        self._step = setting.segmenting.step
        self._next = 0
        self._cost = 0.0  # s a window

    @property
    def at_once(self) -> int:
        """Samples to be taken in one go, so that whoever else is due gets a turn soon."""
        return self._step * int(min(max(TURN_S / (self._cost + 1e-9), 1), MOST_WINDOWS))

    @property
    def next_index(self) -> int:
        """Index after the newest sample that was taken."""
        return self._next

    @property
    def due(self) -> int:
        """Index after the sample that completes the next window: what comes before it decides nothing."""
        length, step = self._kept + 1, self._step
        return max(0, (self._next - length) // step + 1) * step + length

    def use(self, model: Model | None, how: Deciding, fuse: Fuse | None = None) -> None:
        """Decide by another model (None: by none) from the next sample on.

        Filters go on as they are, and so do windows: the next one to be completed is decided by `model`.
        """
        self._pipeline = Pipeline(model, how, fuse) if model else None
        if self._pipeline and len(self._tail):
            self._pipeline.step(self._next - len(self._tail), self._tail)

    def take(self, first_index: int, samples: Samples) -> list[Decision]:
        """Decisions about the windows that these raw samples completed, in order.

        `samples`: V, shape (n, all channels), the first with index `first_index`; what is missing before it
        counts as missing.
        """
        if first_index > self._next:
            self._conditioning.skip(first_index - self._next)
            self._tail = self._tail[:0]
        self._next = first_index + len(samples)
        conditioned = self._conditioning.step(samples[:, self._channels])
        self._tail = np.concatenate((self._tail, conditioned))[-self._kept :]
        if self._pipeline is None:
            return []
        began = time.perf_counter()
        decisions = self._pipeline.step(first_index, conditioned)
        if decisions:
            each = (time.perf_counter() - began) / len(decisions)
            self._cost += NEWEST * (each - self._cost)
        return decisions
