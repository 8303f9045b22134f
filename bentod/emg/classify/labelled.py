"""Signals of which is known what the wearer did, and the windows of them that say just one thing."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bentod.config_conditioning import Filter
from bentod.emg.conditioning import Conditioning
from bentod.emg.recognition import Segmenting, Windows
from bentod.emg.segmenting import complete, cut
from bentod.errors import ConfigError

Names = NDArray[np.str_]
Numbers = NDArray[np.int64]
Chosen = NDArray[np.bool_] | NDArray[np.intp]


@dataclass(frozen=True, slots=True)
class Piece:
    """Samples without a gap, and what was done at each. `label` is empty where that is not known."""

    samples: NDArray[np.floating]  # V, shape (n, channels); NaN where missing
    labels: Names  # shape (n,)
    repetitions: Numbers  # which time the class was prompted, shape (n,)
    conditions: Names  # e.g. of the load, shape (n,)


@dataclass(frozen=True, slots=True)
class Recorded:
    """Labelled signals from one source."""

    rate_hz: float
    pieces: tuple[Piece, ...]

    @property
    def channels(self) -> int:
        """Of every piece."""
        return int(self.pieces[0].samples.shape[1])


@dataclass(frozen=True, slots=True)
class LabelledWindows:
    """Conditioned windows, in order of time, each with one label."""

    windows: Windows
    labels: Names  # shape (windows,)
    repetitions: Numbers  # shape (windows,)
    conditions: Names  # shape (windows,)

    def __len__(self) -> int:
        return len(self.windows)

    def where(self, chosen: Chosen) -> "LabelledWindows":
        """Some of them."""
        return LabelledWindows(
            self.windows[chosen], self.labels[chosen], self.repetitions[chosen], self.conditions[chosen]
        )


def windows_of(
    recorded: Sequence[Recorded], segmenting: Segmenting, filters: Sequence[Filter] = ()
) -> LabelledWindows:
    """All windows of labelled samples without an edge or a gap in them.

    Each piece is conditioned from its beginning, as a stream is when it begins.

    Raises:
        ConfigError: the recordings differ in rate or channels, a filter cannot be used, or no window is left.
    """
    _alike(recorded)
    parts = [
        _of_piece(piece, segmenting, Conditioning(filters, found.rate_hz, found.channels).step)
        for found in recorded
        for piece in found.pieces
    ]
    together = LabelledWindows(
        np.concatenate([part.windows for part in parts]),
        np.concatenate([part.labels for part in parts]),
        np.concatenate([part.repetitions for part in parts]),
        np.concatenate([part.conditions for part in parts]),
    )
    if not len(together):
        raise ConfigError(f"there is no window of {segmenting.length} samples with one label and no gap")
    return together


def _alike(recorded: Sequence[Recorded]) -> None:
    found = {(one.rate_hz, one.channels) for one in recorded}
    if len(found) != 1:
        told = " and ".join(f"{channels} channels at {rate:g} Hz" for rate, channels in sorted(found))
        raise ConfigError(f"recordings must agree in rate and channels; there is {told or 'none'}")


def _of_piece(
    piece: Piece,
    segmenting: Segmenting,
    condition: Callable[[NDArray[np.floating]], NDArray[np.float64]],
) -> LabelledWindows:
    conditioned = condition(piece.samples)
    codes = _runs(piece.labels, piece.repetitions, piece.conditions)
    windows = cut(conditioned, segmenting)
    starts = np.arange(len(windows)) * segmenting.step
    one = codes[starts] == codes[starts + segmenting.length - 1]
    named = piece.labels[starts] != ""
    kept = np.flatnonzero(one & named & complete(conditioned, segmenting))
    begins = starts[kept]
    return LabelledWindows(
        windows[kept], piece.labels[begins], piece.repetitions[begins], piece.conditions[begins]
    )


def _runs(*told: NDArray[np.generic]) -> NDArray[np.intp]:
    """Number of the stretch, in which nothing changes, that each sample is in."""
    changed = np.zeros(len(told[0]), np.bool_)
    for values in told:
        changed[1:] |= values[1:] != values[:-1]
    return np.cumsum(changed)


def counted(labels: Names) -> Numbers:
    """Which time each label has come up, from 0, for recordings that do not say it."""
    runs = _runs(labels)
    seen: dict[str, int] = {}
    numbers = np.zeros(len(labels), np.int64)
    for start, stop in _edges(runs):
        label = str(labels[start])
        numbers[start:stop] = seen.get(label, 0)
        seen[label] = seen.get(label, 0) + 1
    return numbers


def _edges(runs: NDArray[np.intp]) -> Iterable[tuple[int, int]]:
    starts = np.flatnonzero(np.diff(runs, prepend=-1))
    return zip(starts.tolist(), [*starts[1:].tolist(), len(runs)], strict=False)
