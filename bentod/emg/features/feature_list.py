"""A list of features of windows: what a classifier is trained on, and what it then sees."""

from collections.abc import Mapping, Sequence
from typing import Self, cast

import numpy as np

from bentod.emg.features import histogram
from bentod.emg.features.parts import columns
from bentod.emg.features.tables import Asked, Asking, Histogram, read
from bentod.emg.features.workspace import Workspace, check
from bentod.emg.recognition import Table, Windows
from bentod.errors import ConfigError
from bentod.frames import Value

VERSION = 1
"""Of what `spec` says; another number means other columns or other values."""

AT_ONCE = 16384
"""Samples that are worked on in one go, so that they stay in the cache."""

KEPT = 4
"""Workspaces that are kept; more than that are only at work when threads are."""


class FeatureList:
    """Features in the order asked for; of one feature channel after channel, then segment after segment.

    May be used by several threads at once.
    """

    def __init__(self, specs: Asking | Sequence[Asking], channels: int, rate_hz: float) -> None:
        """`specs`: names of features or sets, or tables of them; `channels`: of a window; its samples' rate.

        Raises:
            ConfigError: a name or key is unknown, a value is out of bounds, a feature is asked for twice.
        """
        if channels < 1:
            raise ConfigError(
                f"features of {channels} channels cannot be had; it takes at least 1", "channels"
            )
        self.channels = channels
        self.rate_hz = rate_hz
        self._asked = read(specs, channels)
        self.names = _names(self._asked, channels)
        """Of the columns, e.g. "mav[3]", "ar_burg[0].a1", "wl[2].s4" of segment 4, "ratios[0,1]"."""
        self._idle: list[Workspace] = []

    @classmethod
    def from_spec(cls, spec: Mapping[str, Value]) -> Self:
        """The list that said `spec`.

        Raises:
            ConfigError: it is of another version, or no list of features would say it.
        """
        if spec.get("version") != VERSION or spec.get("unit") != "V":
            raise ConfigError(
                f"these features are of version {spec.get('version')!r} in {spec.get('unit')!r}; "
                f"this program knows version {VERSION} in 'V'",
                "features",
            )
        features, channels, rate = (spec.get(key) for key in ("features", "channels", "rate_hz"))
        if not isinstance(features, list) or type(channels) is not int or not isinstance(rate, int | float):
            raise ConfigError("what was kept of the features is damaged", "features")
        found = cls(cast("list[Asking]", features), channels, float(rate))
        if found.spec() != spec:
            raise ConfigError(
                "what was kept of the features is not complete, or says more than is known", "features"
            )
        return found

    def spec(self) -> dict[str, Value]:
        """All that makes the numbers what they are, in types that JSON has."""
        return {
            "version": VERSION,
            "unit": "V",
            "channels": self.channels,
            "rate_hz": self.rate_hz,
            "features": [asked.model_dump(mode="json") for asked in self._asked],
        }

    def check(self, length: int) -> None:
        """Whether windows of `length` samples can be had features of.

        Raises:
            ConfigError: they cannot be cut into that many segments, or are too short for an order.
        """
        for asked in self._asked:
            check(asked, length)

    def fit(self, windows: Windows) -> "FeatureList":
        """The same features with the bins of histograms found in `windows`; bins that are given stay.

        Raises:
            ConfigError: there is a histogram to be found, and no window.
        """
        found = [
            histogram.fitted(asked, windows) if isinstance(asked, Histogram) and not asked.low_v else asked
            for asked in self._asked
        ]
        return FeatureList([_dumped(asked) for asked in found], self.channels, self.rate_hz)

    def of(self, windows: Windows) -> Table:
        """One row a window, shape (windows, len(names)), finite; see `Features.of`.

        Raises:
            ConfigError: the windows are too short, no multiple of segments, or there are no bins yet.
            ValueError: they have other channels, or samples that are not finite.
        """
        count, channels, length = windows.shape
        if channels != self.channels:
            raise ValueError(f"windows of {channels} channels came to features of {self.channels}")
        step = max(1, AT_ONCE // (channels * length))
        if count <= step:
            return self._part(windows)
        return np.concatenate([self._part(windows[first : first + step]) for first in range(0, count, step)])

    def _part(self, windows: Windows) -> Table:
        workspace = self._take(windows.shape)
        table = workspace.of(windows)
        if len(self._idle) < KEPT:
            self._idle.append(workspace)
        return table

    def _take(self, shape: tuple[int, ...]) -> Workspace:
        """One that nobody else works in. What is taken from the list at once is taken by one thread."""
        for _ in range(len(self._idle)):
            try:
                found = self._idle.pop(0)
            except IndexError:
                break
            if found.shape == shape:
                return found
            self._idle.append(found)
        return Workspace(self._asked, shape)


def _dumped(asked: Asked) -> Mapping[str, Value]:
    return cast("Mapping[str, Value]", asked.model_dump(mode="json"))


def _names(found: tuple[Asked, ...], channels: int) -> tuple[str, ...]:
    """The second feature of a name, with another threshold, is "zc#2"."""
    names: list[str] = []
    for number, asked in enumerate(found):
        before = sum(one.name == asked.name for one in found[:number])
        names += [
            asked.name + (f"#{before + 1}" if before else "") + rest for rest in columns(asked, channels)
        ]
    return tuple(names)
