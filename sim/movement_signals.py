"""The voltage of prompted movements by sample index, and the movement that is truly made at each."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bentod.errors import ConfigError
from bentod.frames import Samples
from sim.movement_nuisances import spoil
from sim.movements import REST, Array, Prompt, Prompted, lap_samples, person, prompts

TIRED = 0.7
"""Frequencies of a tired muscle, as a share of a fresh one's."""

SLOW_HZ = 2.0
"""Below this a held contraction wavers."""

MOST_VALUES = 2e7
"""Samples times channels of one session, which is held in memory."""

STRIDE_RAD = 0.05
"""Between places of the band from which its gains are interpolated."""

MOST_ACTIVE = 1.3
"""Activation above which no muscle goes, whatever it is asked for."""


class Moving:
    """A person who makes prompted movements, again and again: one session is repeated without end.

    Nothing depends on how samples are cut into blocks. Equal options give equal signals and labels.
    """

    def __init__(self, options: Prompted, rate_hz: float) -> None:
        """`rate_hz`: samples a second.

        Raises:
            ConfigError: the session is too long to be held in memory.
        """
        self.rate_hz = rate_hz
        self.length = lap_samples(options, rate_hz)
        """Samples of one session."""
        if self.length * options.electrodes > MOST_VALUES:
            raise ConfigError(
                f"The EMG option 'movements' makes {self.length * options.electrodes:.3g} values; "
                f"the bound is {MOST_VALUES:.3g}.",
                "movements",
            )
        self.prompts: list[Prompt] = prompts(options, rate_hz)
        self.samples: Samples = _signals(options, self.prompts, rate_hz, self.length)
        """V, of one session, shape (length, channels)."""
        self._onsets = np.array([prompt.onset for prompt in self.prompts])
        self._releases = np.array([prompt.release for prompt in self.prompts])
        self._movements = np.array([prompt.movement for prompt in self.prompts])
        self._shown = np.array([prompt.shown for prompt in self.prompts])

    def read(self, first: int, count: int) -> Samples:
        """Samples `first` to `first + count` (V, shape (count, channels))."""
        return self.samples[np.arange(first, first + count) % self.length]

    def label_at(self, index: int) -> str:
        """The movement that is really being made at a sample, from when the muscles begin to let them go."""
        return str(self.labels(np.array([index]))[0])

    def labels(self, indices: NDArray[np.int64]) -> NDArray[np.str_]:
        """`label_at` each of them, shape (indices,)."""
        at = indices % self.length
        place = np.searchsorted(self._onsets, at, side="right") - 1
        made = (place >= 0) & (at < self._releases[place])
        return np.where(made, self._movements[place], REST)

    def prompt_at(self, index: int) -> str:
        """What is asked for at a sample: the truth, but for reaction times."""
        at = index % self.length
        place = int(np.searchsorted(self._shown, at, side="right")) - 1
        return self.prompts[place].movement if place >= 0 and at < self.prompts[place].hidden else REST


def _signals(options: Prompted, shown: list[Prompt], rate_hz: float, length: int) -> Samples:
    """Each muscle is a source of noise of its own, of which every electrode sees a share."""
    random = np.random.default_rng([options.session, 6])
    who, time = person(options.person), np.arange(length) / length
    activation = _activation(options, shown, rate_hz, length, random)
    voltage = options.full_v * (1 + options.drift.amplitude * time)
    places, trim = placed(options)
    gains = trim[:, np.newaxis] * np.array([who.gains(place) for place in places])
    volts = np.zeros((length, options.electrodes))
    for muscle, corners in enumerate(who.corners):
        amplitude = voltage * np.minimum(activation[:, muscle], MOST_ACTIVE) ** options.exponent
        source = amplitude * _muscle(random, length, rate_hz, corners, options.drift.fatigue * time)
        for channel in range(options.electrodes):
            seen = np.interp(time, np.linspace(0, 1, len(places)), gains[:, channel, muscle])
            volts[:, channel] += seen * source
    volts += options.rest_v * noise(random, length, rate_hz, spectrum(50.0, 110.0), options.electrodes)
    return spoil(volts, rate_hz, options.nuisances, options.session).astype(np.float32)


def placed(options: Prompted) -> tuple[Array, Array]:
    """Angles of the electrodes during a session (rad, shape (times, electrodes)), and their gains."""
    day = np.random.default_rng([options.person, options.day, 7])
    even = 2 * np.pi * np.arange(options.electrodes) / options.electrodes
    begin = even + options.scatter.day * day.standard_normal()
    trim = np.exp(options.scatter.day * day.standard_normal(options.electrodes))
    turn = options.drift.rotation_rad
    return begin + np.linspace(0, turn, 2 + round(abs(turn) / STRIDE_RAD))[:, np.newaxis], trim


def _activation(
    options: Prompted, shown: list[Prompt], rate_hz: float, length: int, random: np.random.Generator
) -> Array:
    """Of each muscle, as a share of its greatest, shape (length, muscles)."""
    who, scatter = person(options.person), options.scatter
    tonic = options.load_share * who.tonic[options.load]
    activation = np.zeros((length, len(tonic)))
    for prompt in shown:
        whole = options.effort * np.exp(scatter.effort * random.standard_normal())
        each = np.exp(scatter.synergy * random.standard_normal(len(tonic)))
        shape, first = _envelope(prompt, round(options.ramp_s * rate_hz))
        contraction = shape[:, np.newaxis] * (whole * each * who.synergies[prompt.movement])
        activation[first : first + len(shape)] += contraction[: length - first]
    wavering = noise(random, length, rate_hz, lambda hz: (hz < SLOW_HZ).astype(np.float64), len(tonic))
    return np.asarray((activation + tonic) * np.exp(scatter.hold * wavering))


def _envelope(prompt: Prompt, ramp: int) -> tuple[Array, int]:
    """The shape of a contraction, 0..1 and smooth at both ends, and the index at which it begins."""
    rise = 0.5 - 0.5 * np.cos(np.pi * (np.arange(ramp) + 0.5) / max(ramp, 1))
    held = max(0, prompt.release - prompt.onset - ramp)
    return np.concatenate([rise, np.ones(held), rise[::-1]]), prompt.onset


def _muscle(random: np.random.Generator, length: int, rate_hz: float, corners: Array, tired: Array) -> Array:
    """A fresh and a tired muscle's noise, of which `tired` (0..1 at each sample) is the latter's power."""
    low, high = corners.tolist()
    fresh = noise(random, length, rate_hz, spectrum(low, high), 1)[:, 0]
    if not tired.any():
        return fresh
    weary = noise(random, length, rate_hz, spectrum(TIRED * low, TIRED * high), 1)[:, 0]
    return np.asarray(np.sqrt(1 - tired) * fresh + np.sqrt(tired) * weary)


def spectrum(low_hz: float, high_hz: float) -> Callable[[Array], Array]:
    """Magnitude by frequency of a muscle's noise, with corners at `low_hz` and `high_hz`.

    Shwedyk, Balasubramanian and Scott (1977): P(f) ∝ f² / ((f² + f_l²)(f² + f_h²)²). Amplifiers pass the
    band from 20 to 450 Hz, at 24 dB an octave.
    """

    def magnitude(hz: Array) -> Array:
        power = hz**2 / ((hz**2 + low_hz**2) * (hz**2 + high_hz**2) ** 2)
        return np.asarray(np.sqrt(power / ((1 + (20.0 / hz) ** 8) * (1 + (hz / 450.0) ** 8))))

    return magnitude


def noise(
    random: np.random.Generator, length: int, rate_hz: float, magnitude: Callable[[Array], Array], count: int
) -> Array:
    """Noises of root mean square 1 that begin again without a seam, shape (length, count)."""
    hz = np.maximum(np.fft.rfftfreq(length, 1 / rate_hz), 1e-9)
    shape = (len(hz), count)
    coloured = magnitude(hz)[:, np.newaxis] * (
        random.standard_normal(shape) + 1j * random.standard_normal(shape)
    )
    noise = np.fft.irfft(coloured, n=length, axis=0)
    return np.asarray(noise / np.sqrt(np.mean(noise**2, axis=0)))
