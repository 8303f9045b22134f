"""A scripted wearer: muscles that follow a program, and the voltage that electrodes over them pick up."""

from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from bentod.frames import Samples
from drivers.emg.options import Table
from drivers.emg.pacing import BLOCK_S, BUFFER_S
from sim.movements import Prompted

POSITIVE, NEGATIVE, TOGGLE = 0, 1, 2
"""Channels: the muscle that moves a joint up, its antagonist, and the toggle site on the other forearm."""

NOISE_SAMPLES = 2**15
"""Length of the noise before it repeats: 164 s at 200 Hz."""


class Step(NamedTuple):
    """One line of the program; every muscle that it does not name is at rest meanwhile."""

    channel: Annotated[int, Field(ge=0, le=63)]
    level: Annotated[float, Field(ge=0.0, le=1.0)]  # share of the full contraction
    seconds: Annotated[float, Field(ge=0.01, le=60.0)]
    also: Annotated[int, Field(ge=0, le=63)] | None = None  # another channel, contracted just as much


CIRCUIT = (
    Step(POSITIVE, 0.0, 0.8),  # whoever is to move an arm that is released must be seen at rest first
    Step(POSITIVE, 1.0, 1.2),  # joint A there
    Step(POSITIVE, 0.0, 0.6),
    Step(TOGGLE, 1.0, 0.2),
    Step(TOGGLE, 0.0, 0.4),
    Step(POSITIVE, 1.0, 1.2),  # joint B there
    Step(POSITIVE, 0.0, 0.8),
    Step(NEGATIVE, 1.0, 1.2),  # and back
    Step(NEGATIVE, 0.0, 0.6),
    Step(TOGGLE, 1.0, 0.2),
    Step(TOGGLE, 0.0, 0.4),
    Step(NEGATIVE, 1.0, 1.2),  # joint A back
)
"""There and back with a group of two joints, in the order of thesis 5.4: 8.8 s, two toggles, no net way."""


class Options(Table):
    """What a config may say about the simulated wearer and the wires to them."""

    seed: Annotated[int, Field(ge=0, le=2**32 - 1)] = 1
    program: Annotated[tuple[Step, ...], Field(min_length=1, max_length=200)] = CIRCUIT
    """Steps of [channel, level, seconds], or with another channel at the end, repeated without end."""

    movements: Prompted | None = None
    """Prompted movements of the wrist instead of the program and its muscles."""

    lag_s: Annotated[float, Field(ge=0.0, le=0.5)] = 0.07
    """Time constant from the intent to the activation of a muscle."""

    rest_v: Annotated[float, Field(ge=0.0, le=1e-3)] = 2.5e-6
    """Mean absolute value of a muscle at rest."""

    full_v: Annotated[float, Field(ge=0.0, le=1e-2)] = 60e-6
    """Mean absolute value that a full contraction adds."""

    exponent: Annotated[float, Field(ge=0.5, le=3.0)] = 1.5
    """Amplitude grows as activation to this power; 1.5 is an assumption, for want of a measured value."""

    hum_v: Annotated[float, Field(ge=0.0, le=1e-3)] = 0.0
    """Peak of the mains hum, the same on all channels."""

    hum_hz: Annotated[float, Field(ge=45.0, le=65.0)] = 50.0
    dropout: Annotated[float, Field(ge=0.0, le=0.9)] = 0.0
    """Share of the blocks that are lost on the way."""

    block_s: Annotated[float, Field(ge=0.0001, le=0.05)] = BLOCK_S
    """Length of a block as it arrives."""

    buffer_s: Annotated[float, Field(ge=0.05, le=10.0)] = BUFFER_S
    """How late a consumer may be before blocks are dropped."""


class Wearer:
    """Voltage as a pure function of the sample index, so that nothing depends on how it is cut into blocks.

    Not modelled: fatigue, crosstalk, motion artefacts, firing of single motor units, the wearer's own
    scatter from one contraction to the next. The wearer has been repeating the program for ever.
    """

    def __init__(self, options: Options, rate_hz: float, channels: int) -> None:
        self._rate_hz = rate_hz
        self._hum = options.hum_v, options.hum_hz
        intent, rest = (np.random.default_rng([options.seed, stream]) for stream in (0, 1))
        activation = _activation(options, rate_hz, channels)
        self._amplitude = options.full_v * activation**options.exponent
        self._muscle = _noise(intent, rate_hz, channels)
        self._rest = options.rest_v * _noise(rest, rate_hz, channels)

    def read(self, first: int, count: int) -> Samples:
        """Samples `first` to `first + count` (V)."""
        index = np.arange(first, first + count)
        noise = index % NOISE_SAMPLES
        volts = self._amplitude[index % len(self._amplitude)] * self._muscle[noise] + self._rest[noise]
        peak, hum_hz = self._hum
        if peak:
            volts += peak * np.sin(2 * np.pi * hum_hz / self._rate_hz * index)[:, np.newaxis]
        return volts.astype(np.float32)


def _activation(options: Options, rate_hz: float, channels: int) -> NDArray[np.float64]:
    """One lap of muscle activation, 0..1, shape (samples, channels): the program through a first-order lag.

    The lag is applied to the spectrum of one lap, H = (1 - d) / (1 - d e^(-jω)), d = e^(-1 / (τ f)), which
    is the response to the program repeated for ever.
    """
    ends = np.rint(np.cumsum([step.seconds for step in options.program]) * rate_hz).astype(int)
    intent = np.zeros((ends[-1], channels))
    for start, end, step in zip([0, *ends[:-1]], ends, options.program, strict=True):
        intent[start:end, [step.channel, step.channel if step.also is None else step.also]] = step.level
    decay = np.exp(-1 / (options.lag_s * rate_hz)) if options.lag_s else 0.0
    omega = 2 * np.pi * np.fft.rfftfreq(len(intent))
    lag = (1 - decay) / (1 - decay * np.exp(-1j * omega))
    lagged = np.fft.irfft(np.fft.rfft(intent, axis=0) * lag[:, np.newaxis], n=len(intent), axis=0)
    return np.clip(lagged, 0.0, 1.0)


def _noise(random: np.random.Generator, rate_hz: float, channels: int) -> NDArray[np.float64]:
    """Noise with the band of surface EMG, 20 to 450 Hz at 24 dB an octave; mean absolute value 1."""
    spectrum = np.fft.rfft(random.standard_normal((NOISE_SAMPLES, channels)), axis=0)
    frequency = np.maximum(np.fft.rfftfreq(NOISE_SAMPLES, 1 / rate_hz), 1e-9)
    band = 1 / np.sqrt((1 + (20.0 / frequency) ** 8) * (1 + (frequency / 450.0) ** 8))
    noise = np.fft.irfft(spectrum * band[:, np.newaxis], n=NOISE_SAMPLES, axis=0)
    return np.asarray(noise / np.mean(np.abs(noise), axis=0))
