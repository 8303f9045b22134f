"""Tones without clicks, and sound as WAV: mono, 16 bits, 22,050 samples a second, as espeak-ng speaks."""

import io
import wave
from collections.abc import Sequence
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from bentod.errors import BentodError

RATE_HZ = 22_050
EDGE = 0.01
"""s in which a tone rises and falls, as a raised cosine: an edge that is steeper is heard as a click."""

PENTATONIC = (0, 2, 4, 7, 9)
LOWEST_HZ = 220.0
NOTES = 20
"""That differ: four octaves."""

Sound: TypeAlias = NDArray[np.float64]
"""Samples within ±1, shape (n,)."""


class BadWav(BentodError):
    """A WAV cannot be played.

    Examples: it is compressed, it is cut off, it is no WAV at all.
    """

    code = "wav"


def note(index: int) -> float:
    """The pitch (Hz) of the joint of this index: neighbours are easy to tell apart, and never clash."""
    octave, step = divmod(index % NOTES, len(PENTATONIC))
    return LOWEST_HZ * float(2 ** (octave + PENTATONIC[step] / 12))


def tone(pitch: float, seconds: float) -> Sound:
    """A sine of `pitch` (Hz), with soft edges."""
    count = round(seconds * RATE_HZ)
    times = np.arange(count) / RATE_HZ
    edge = min(EDGE, seconds / 2)
    inside = np.clip(np.minimum(times, seconds - times) / edge, 0.0, 1.0)
    sound: Sound = np.sin(2 * np.pi * pitch * times) * (1 - np.cos(np.pi * inside)) / 2
    return sound


def joined(parts: Sequence[Sound], gap: float, longest: float) -> Sound:
    """One after another with `gap` (s) between them; what is longer than `longest` (s) ends softly there."""
    silence = np.zeros(round(gap * RATE_HZ))
    pieces = [piece for part in parts for piece in (silence, part)][1:]
    sound = np.concatenate(pieces) if pieces else np.zeros(0)
    most = round(longest * RATE_HZ)
    if len(sound) <= most:
        return sound
    edge = round(EDGE * RATE_HZ)
    sound = sound[:most]
    sound[-edge:] *= (1 + np.cos(np.linspace(0, np.pi, edge))) / 2
    return sound


def to_pcm(sound: Sound) -> bytes:
    """Samples as they are sent to a sound card: 16 bits, the least first."""
    return bytes(np.round(np.clip(sound, -1.0, 1.0) * 32_767).astype("<i2").tobytes())


def to_wav(sound: Sound) -> bytes:
    """A whole WAV file."""
    buffer = io.BytesIO()
    with wave.open(buffer, "wb") as file:
        file.setnchannels(1)
        file.setsampwidth(2)
        file.setframerate(RATE_HZ)
        file.writeframes(to_pcm(sound))
    return buffer.getvalue()


def from_wav(data: bytes, longest: float) -> Sound:
    """The first `longest` (s) of a WAV at our own rate, all its channels as one.

    Raises:
        BadWav: it is not one of 8 to 32 bits.
    """
    try:
        with wave.open(io.BytesIO(data)) as file:
            channels, width, rate = file.getnchannels(), file.getsampwidth(), file.getframerate()
            raw = file.readframes(min(file.getnframes(), round(longest * rate)))
        whole = len(raw) - len(raw) % (channels * width)
        samples = _unpacked(raw[:whole], width).reshape(-1, channels).mean(axis=1)
    except (wave.Error, EOFError, ValueError, ZeroDivisionError) as error:
        raise BadWav(f"this is not a WAV of 8 to 32 bits: {str(error) or type(error).__name__}") from error
    if not len(samples):
        raise BadWav("the WAV holds no sound")
    return _resampled(samples, rate)


def _unpacked(raw: bytes, width: int) -> Sound:
    """Samples within ±1 of whole numbers of `width` bytes, the least first; of one byte they are unsigned."""
    if width == 1:
        return np.frombuffer(raw, np.uint8) / 128.0 - 1.0
    wide = np.zeros((len(raw) // width, 4), np.uint8)
    wide[:, 4 - width :] = np.frombuffer(raw, np.uint8).reshape(-1, width)
    return wide.view("<i4").ravel() / 2.0**31


def _resampled(samples: Sound, rate: int) -> Sound:
    if rate == RATE_HZ:
        return samples
    count = max(1, round(len(samples) * RATE_HZ / rate))
    return np.interp(np.arange(count) * rate / RATE_HZ, np.arange(len(samples)), samples)
