"""Buffers and operations for windows of one shape, and the table that they fill."""

from collections.abc import Sequence

import numpy as np

from bentod.emg.features.parts import PARTS, columns
from bentod.emg.features.rows import LIMIT_V, Floats, Rows
from bentod.emg.features.tables import Asked, Autoregressive
from bentod.emg.recognition import Table, Windows
from bentod.errors import ConfigError


class Workspace:
    """For one thread at a time."""

    def __init__(self, asked: Sequence[Asked], shape: tuple[int, ...]) -> None:
        """`shape`: (windows, channels, samples).

        Raises:
            ConfigError: a feature cannot be had of windows of so many samples.
        """
        self.shape = shape
        windows, channels, length = shape
        widths = [len(columns(one, channels)) for one in asked]
        self._table = np.empty((windows, sum(widths)))
        self._rows: dict[int, Rows] = {}
        place = 0
        for one, width in zip(asked, widths, strict=True):
            self._add(one, self._table[:, place : place + width], (windows, channels, length))
            place += width
        for rows in self._rows.values():
            rows.marks.finish(rows.do)

    def _add(self, asked: Asked, columns: Table, shape: tuple[int, int, int]) -> None:
        windows, channels, length = shape
        check(asked, length)
        segments = asked.segments
        rows = self._rows.get(segments)
        if rows is None:
            rows = self._new(windows, channels, segments, length // segments)
        parts = segments - 1 if asked.name == "mavs" else segments
        places = {"bias": 1, "ratios": channels * (channels - 1) // 2}.get(asked.name, channels)
        values = columns.shape[1] // (places * parts)
        PARTS[asked.name](rows, asked, columns.reshape(windows, places, parts, values))

    def _new(self, windows: int, channels: int, segments: int, length: int) -> Rows:
        rows = Rows(windows, channels, segments, length)
        if not self._rows:  # all rows have the same samples
            totals = rows.total().reshape(-1)
            rows.do(_refuse, rows, totals, np.ones(totals.size))
        self._rows[segments] = rows
        return rows

    def of(self, windows: Windows) -> Table:
        """One row a window. Raises ValueError: a sample is not finite."""
        for rows in self._rows.values():
            rows.load(windows)
            rows.run()
        return self._table.copy()


def check(asked: Asked, length: int) -> None:
    """Whether windows of `length` samples can be had this feature of; ConfigError if not."""
    if length % asked.segments:
        raise ConfigError(
            f"'{asked.name}' is to cut windows of {length} samples into {asked.segments} segments; "
            f"they must be equal, and {length} is no multiple of {asked.segments}",
            "segments",
        )
    samples = length // asked.segments
    if samples < 2:
        raise ConfigError(
            f"'{asked.name}' has segments of {samples} samples; they need at least 2", "segments"
        )
    if isinstance(asked, Autoregressive) and asked.order >= samples:
        raise ConfigError(
            f"'{asked.name}' of order {asked.order} needs more than {asked.order} samples in a segment; "
            f"there are {samples}",
            "order",
        )


def _refuse(rows: Rows, totals: Floats, ones: Floats) -> None:
    """Raises ValueError: a sample is not finite."""
    if np.vecdot(totals, ones) < LIMIT_V:
        return
    windows = rows.x.reshape(*rows.shape[:2], -1)
    bad = ~(np.abs(windows) < LIMIT_V)
    if not bad.any():
        raise ValueError(f"the samples of these windows add up to {LIMIT_V:g} V or more")
    window, channel, sample = np.argwhere(bad)[0]
    raise ValueError(
        f"sample {sample} of channel {channel} in window {window} is {windows[window, channel, sample]} V; "
        "features take finite numbers"
    )
