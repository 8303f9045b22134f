"""The quiet cue: one soft tone without end, whose pitch says which joint is selected (thesis 5.6.6)."""

from collections.abc import Callable, Mapping

import numpy as np

from bentod.voice.tones import RATE_HZ, to_pcm

CHUNK = 1024
"""Samples that are made at a time: 46 ms, within which pitch and loudness glide, so that nothing clicks."""


class Hum:
    """Asked for chunk after chunk, forever."""

    def __init__(self, volume: float, pitches: Mapping[str, float], selected: Callable[[], str]) -> None:
        """`volume`: share of full scale; `pitches`: Hz, by what `selected` may say; nothing: silence."""
        self._volume = volume
        self._pitches = pitches
        self._selected = selected
        self._pitch = 0.0  # Hz at the end of the last chunk
        self._level = 0.0  # share of full scale, likewise
        self._phase = 0.0  # rad, likewise

    def chunk(self) -> bytes:
        """The next samples, as a sound card takes them; empty while there is nothing to be heard."""
        pitch = self._pitches.get(self._selected(), 0.0)
        level = self._volume if pitch else 0.0
        if not level and not self._level:
            return b""
        pitch = pitch or self._pitch
        begin = self._pitch if self._level else pitch  # out of silence it need not glide
        steps = np.arange(1, CHUNK + 1) / CHUNK
        phases = self._phase + 2 * np.pi * np.cumsum(begin + (pitch - begin) * steps) / RATE_HZ
        levels = self._level + (level - self._level) * steps
        self._pitch, self._level, self._phase = pitch, level, float(phases[-1] % (2 * np.pi))
        return to_pcm(levels * np.sin(phases))
