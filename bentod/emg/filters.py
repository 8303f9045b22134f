"""Causal filters as second-order sections, by SciPy; only `bentod.emg.conditioning` loads this."""

from collections.abc import Sequence
from typing import cast

import numpy as np
from numpy.typing import NDArray
from scipy import signal

from bentod.config_conditioning import HARMONICS, MOST_OF_NYQUIST, ORDER, Filter, Q

Array = NDArray[np.float64]

_BUTTERWORTH = {"high_pass": "highpass", "low_pass": "lowpass", "band_pass": "bandpass"}
"""Our names and SciPy's."""


class Sections:
    """A cascade of second-order sections (scipy.signal.sosfilt, direct form II transposed).

    Every sample goes through the same operations in the same order, whatever block it comes in.
    """

    def __init__(self, filters: Sequence[Filter], rate_hz: float) -> None:
        self._sos = np.concatenate([_designed(one, rate_hz) for one in filters])
        self._rest = cast("Array", signal.sosfilt_zi(self._sos))

    def at_rest(self, values: Array) -> Array:
        """The state in which each channel has been at its value (V, shape (channels,)) for ever."""
        return self._rest[:, :, np.newaxis] * values

    def run(self, values: Array, state: Array) -> tuple[Array, Array]:
        """The output (V, shape (n, channels)), and the state after it; shape (sections, 2, channels)."""
        out, after = signal.sosfilt(self._sos, values, axis=0, zi=state)
        return cast("Array", out), cast("Array", after)

    def response(self, count: int) -> Array:
        """The first `count` samples of the response to an impulse of 1."""
        impulse = np.zeros(count)
        impulse[0] = 1.0
        return cast("Array", signal.sosfilt(self._sos, impulse))


def _designed(one: Filter, rate_hz: float) -> Array:
    edges = list(one.frequencies().values())
    if one.kind != "notch":
        edge = edges if len(edges) > 1 else edges[0]
        kind = _BUTTERWORTH[one.kind]
        order = one.order or ORDER
        return cast("Array", signal.butter(order, edge, kind, fs=rate_hz, output="sos"))
    tones = [edges[0] * (i + 1) for i in range(one.harmonics or HARMONICS)]
    within = [hz for hz in tones if hz < MOST_OF_NYQUIST * rate_hz / 2]
    # The same width in Hz at each, which is what settles as soon as the first does.
    return np.concatenate([_notch(hz, (one.q or Q) * hz / edges[0], rate_hz) for hz in within])


def _notch(hz: float, q: float, rate_hz: float) -> Array:
    return cast("Array", signal.tf2sos(*signal.iirnotch(hz, q, fs=rate_hz)))
