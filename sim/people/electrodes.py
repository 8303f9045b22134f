"""What electrodes over a simulated operator's muscles pick up: effort as volts, with the noise of EMG."""

from collections.abc import AsyncIterator, Callable

import numpy as np

from bentod.contracts import Clock
from bentod.frames import EmgBlock, Samples
from sim.people.scene import Act

REST, THRESHOLD, FULL = 2.5e-6, 10e-6, 60e-6
"""V, mean absolute values: a muscle at rest, where effort begins, a full contraction."""

PULSE = 0.15
"""s that a toggling contraction lasts; assumed."""

BLOCK = 2
"""Samples in a block."""


class Electrodes:
    """Two sites over an antagonist pair and one on the other forearm, as an `EmgSource`."""

    def __init__(self, act: Callable[[], Act], rate_hz: float, clock: Clock, seed: int) -> None:
        """`act`: what the operator does at the moment."""
        self.rate_hz = rate_hz
        self.channels = 3
        self._act = act
        self._clock = clock
        self._random = np.random.default_rng(seed)
        self._pulse_until = -1.0

    async def __aiter__(self) -> AsyncIterator[EmgBlock]:
        """Blocks as they arrive, without end."""
        begun, first = self._clock.now(), 0
        while True:
            await self._clock.sleep_until(begun + (first + BLOCK) / self.rate_hz)
            yield EmgBlock(first, begun + first / self.rate_hz, self._samples(begun + first / self.rate_hz))
            first += BLOCK

    def _samples(self, time: float) -> Samples:
        act = self._act()
        if act.toggle:
            self._pulse_until = time + PULSE
        toggling = FULL if time < self._pulse_until else REST
        means = np.array([_level(act.effort), _level(-act.effort), toggling])
        # The mean absolute value of a normal variable is sqrt(2/π) of its standard deviation.
        noise = np.sqrt(np.pi / 2) * self._random.standard_normal((BLOCK, 3))
        volts: Samples = (means * noise).astype(np.float32)
        return volts


def _level(effort: float) -> float:
    """V of a site whose muscle shares an effort of -1..1."""
    return REST if effort <= 0 else THRESHOLD + min(effort, 1.0) * (FULL - THRESHOLD)
