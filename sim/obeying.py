"""A person who makes the movement that is asked for at the time, as in a guided collection."""

import numpy as np
from numpy.typing import NDArray

from bentod.frames import Samples
from sim.movement_signals import MOST_ACTIVE, SLOW_HZ, noise, placed, spectrum
from sim.movements import Array, Prompted, person

LAP_S = 30.0
"""Length of the noise before it repeats, without a seam."""


def _slow(hz: Array) -> Array:
    """Magnitude by frequency of what wavers."""
    return np.asarray(hz < SLOW_HZ, np.float64)


class Obeying:
    """The muscles of `Prompted` options, asked for one movement after the other.

    What is asked for at the same samples gives the same signal, in whatever blocks it is read.
    """

    def __init__(self, options: Prompted, rate_hz: float) -> None:
        self.asked = ""
        self._options = options
        self._rate_hz = rate_hz
        self._who = person(options.person)
        self._random = np.random.default_rng([options.session, 8])
        length = round(LAP_S * rate_hz)
        corners = self._who.corners.tolist()
        muscles = [noise(self._random, length, rate_hz, spectrum(*ends), 1)[:, 0] for ends in corners]
        slow = noise(self._random, length, rate_hz, _slow, len(muscles))
        self._sources = np.stack(muscles, axis=1)
        self._wavering = np.exp(options.scatter.hold * slow)
        self._skin = options.rest_v * noise(
            self._random, length, rate_hz, spectrum(50.0, 110.0), options.electrodes
        )
        places, trim = placed(options)
        self._gains = trim[:, np.newaxis] * self._who.gains(places[0])
        self._tonic = options.load_share * self._who.tonic[options.load]
        self._from = self._to = np.zeros(len(muscles))
        self._onset = 0  # sample from which on the muscles go from one to the other
        self._ramp = max(1, round(options.ramp_s * rate_hz))
        self._next = 0

    def prompt(self, label: str) -> None:
        """Make this movement after a reaction time; one that nobody knows is rest."""
        self._from = self._contraction(np.array([self._next]))[0]
        low, high = sorted(self._options.reaction_s)
        self._onset = self._next + round(self._random.uniform(low, high) * self._rate_hz)
        self.asked = label
        shares = self._who.synergies.get(label)
        scatter = self._options.scatter
        whole = self._options.effort * np.exp(scatter.effort * self._random.standard_normal())
        each = np.exp(scatter.synergy * self._random.standard_normal(len(self._from)))
        self._to = np.zeros(len(self._from)) if shares is None else whole * each * shares

    def read(self, first: int, count: int) -> Samples:
        """Samples `first` to `first + count` (V, shape (count, electrodes))."""
        self._next = first + count
        indices = np.arange(first, first + count)
        places = indices % len(self._sources)
        activation = (self._contraction(indices) + self._tonic) * self._wavering[places]
        amplitude = self._options.full_v * np.minimum(activation, MOST_ACTIVE) ** self._options.exponent
        volts = (amplitude * self._sources[places]) @ self._gains.T + self._skin[places]
        return np.asarray(volts, np.float32)

    def _contraction(self, indices: NDArray[np.int_]) -> Array:
        """Activation by what was asked for, shape (samples, muscles)."""
        way = np.clip((indices - self._onset) / self._ramp, 0.0, 1.0)
        share = (0.5 - 0.5 * np.cos(np.pi * way))[:, np.newaxis]
        return np.asarray(self._from + (self._to - self._from) * share)
