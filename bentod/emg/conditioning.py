"""From raw samples to conditioned ones: causal filters, which gaps do not poison and blocks do not change."""

from collections.abc import Sequence
from itertools import pairwise
from typing import Protocol, TypeAlias, cast

import numpy as np
from numpy.typing import NDArray

from bentod.config_conditioning import Filter, beyond
from bentod.emg.extra import load
from bentod.errors import ConfigError
from bentod.frames import Samples

Volts: TypeAlias = NDArray[np.float64]
"""V, shape (n, channels); NaN where nothing is known."""

SETTLED = 0.05
"""A filter has settled when what it was not told can add no more than this share of its own size."""

LONGEST = 10.0
"""s in which every cascade of filters must settle."""

MOST_V = 100.0
"""A sample beyond this is a fault of the way, as NaN is: what converters give ends at 10 V."""


FILTERING = "[[emg.filters]] and the envelope low_pass"
"""What SciPy is for here, as a config says it."""


class Cascade(Protocol):
    """Filters one after the other, and what they remember; see `bentod.emg.filters.Sections`."""

    def at_rest(self, values: Volts) -> Volts:
        """The state in which each channel has been at its value (V, shape (channels,)) for ever."""
        ...

    def run(self, values: Volts, state: Volts) -> tuple[Volts, Volts]:
        """The output (V, shape (n, channels)), and the state after it; shape (sections, 2, channels)."""
        ...

    def response(self, count: int) -> Volts:
        """The first `count` samples of the response to an impulse of 1."""
        ...


class _Open(Protocol):
    def __call__(self, filters: Sequence[Filter], rate_hz: float) -> Cascade: ...


class Conditioning:
    """The filters of a config, applied to a stream or to a whole recording with the same bits.

    What is not finite, or beyond any converter, is missing. While samples are missing the filters are given
    the last one that came; the output is NaN there, and after it for as long as the unknown samples could
    still add more than `SETTLED` of their size to it. After a gap that is longer than the filters'
    memory, as at the start, they begin anew as if the first sample had been there for ever: without a step.
    """

    def __init__(self, filters: Sequence[Filter], rate_hz: float, channels: int) -> None:
        """Raises ConfigError: the rate is too low for a filter, one never settles, or SciPy is missing."""
        self._cascade = _cascade(filters, rate_hz) if filters else None
        self._memory = _Memory(self._cascade, rate_hz)
        rest = np.zeros(channels)
        self._state = self._cascade.at_rest(rest) if self._cascade else np.zeros((0, 2, channels))
        self._held = np.zeros(channels)  # V, the newest that is known
        self._missing = np.full(channels, self._memory.length)  # samples in a row, up to the filters' memory
        self._wait = np.zeros(channels, np.int64)  # samples of output that are not to be trusted yet

    @property
    def settling(self) -> int:
        """Samples until the output can be trusted at the start, and after a long gap."""
        return self._memory.length

    def step(self, samples: Samples | Volts) -> Volts:
        """All that came since the last step, conditioned; shape (n, channels), NaN where it is not known."""
        values = samples.astype(np.float64)
        with np.errstate(invalid="ignore"):
            known = np.abs(values) <= MOST_V
        if self._cascade is None:
            return np.where(known, values, np.nan)
        if known.all() and not self._missing.any():
            return self._filtered(self._cascade, values, slice(None))
        out = np.full(values.shape, np.nan)
        for channel in range(values.shape[1]):
            own = slice(channel, channel + 1)
            for start, stop in _runs(known[:, channel]):
                part = values[start:stop, own]
                step = self._filtered_anew if known[start, channel] else self._hold
                out[start:stop, own] = step(self._cascade, part, own)
        return out

    def skip(self, count: int) -> None:
        """So many samples, at least one, are missing altogether."""
        most = min(count, self._memory.length)
        self.step(np.full((most, len(self._held)), np.nan))

    def _filtered(self, cascade: Cascade, values: Volts, own: slice) -> Volts:
        """The output at samples that are known; NaN until the filters have settled."""
        if not len(values):
            return values
        out, self._state[:, :, own] = cascade.run(values, self._state[:, :, own])
        self._held[own] = values[-1]
        wait = self._wait[own]
        if wait.any():
            out[np.arange(len(values))[:, np.newaxis] < wait] = np.nan
            self._wait[own] = np.maximum(wait - len(values), 0)
        return out

    def _filtered_anew(self, cascade: Cascade, values: Volts, own: slice) -> Volts:
        """The same where samples may be missing just before."""
        missing = int(self._missing[own][0])
        if missing >= self._memory.length:
            self._state[:, :, own] = cascade.at_rest(values[0])
        if missing:
            self._wait[own] = np.maximum(self._wait[own], self._memory.after(missing))
        self._missing[own] = 0
        return self._filtered(cascade, values, own)

    def _hold(self, cascade: Cascade, values: Volts, own: slice) -> Volts:
        """The output at samples that are missing: not known; the filters go on with the last that came."""
        count, missing = len(values), int(self._missing[own][0])
        held = np.tile(self._held[own], (min(count, self._memory.length - missing), 1))
        if len(held):
            _, self._state[:, :, own] = cascade.run(held, self._state[:, :, own])
        self._wait[own] = np.maximum(self._wait[own] - count, 0)
        self._missing[own] = min(missing + count, self._memory.length)
        return np.full(values.shape, np.nan)


class _Memory:
    """How long what filters were not told can be seen in what they say.

    With the response h to an impulse, n unknown samples no larger than A add at most A Σ |h(k)|, over k from
    t + 1 to t + n, to the output t samples after them.
    """

    def __init__(self, cascade: Cascade | None, rate_hz: float) -> None:
        """Raises ConfigError: it is longer than `LONGEST`."""
        self.length = 0
        """Samples after which the filters have forgotten everything."""
        if cascade is None:
            return
        sums = np.cumsum(np.abs(cascade.response(int(LONGEST * rate_hz))))
        left = sums[-1] - sums
        if not left[len(left) // 2] < SETTLED / 4:
            raise ConfigError(
                f"The EMG filters do not settle within {LONGEST:g} s: choose a higher frequency, a lower "
                "order or a lower q.",
                "filters",
            )
        self.length = max(1, int(np.argmax(left < SETTLED)))
        self._sums = np.concatenate((sums[: 2 * self.length], np.full(2 * self.length, sums[-1])))

    def after(self, missing: int) -> int:
        """Samples of output that are not to be trusted after so many missing ones."""
        if missing >= self.length:
            return self.length
        added = self._sums[missing : missing + self.length] - self._sums[: self.length]
        return int(np.max(np.flatnonzero(added >= SETTLED) + 1, initial=0))


def _cascade(filters: Sequence[Filter], rate_hz: float) -> Cascade:
    if problems := beyond(filters, rate_hz):
        raise ConfigError("\n".join(f"emg.{problem}" for problem in problems), "filters")
    return cast("_Open", load("bentod.emg.filters:Sections", FILTERING))(filters, rate_hz)


def _runs(known: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Where stretches of samples begin and end that are all known or all missing."""
    edges = [0, *(np.flatnonzero(known[1:] != known[:-1]) + 1), len(known)]
    return [(int(start), int(stop)) for start, stop in pairwise(edges) if start < stop]
