"""A source of simulated muscle signals, which can be broken on purpose."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import numpy as np

from bentod.contracts import Clock, EmgConfig
from bentod.errors import ConfigError
from bentod.frames import EmgBlock, Samples
from drivers.emg.options import parse
from drivers.emg.pacing import Pacer, Slot
from sim.emg_wearer import TOGGLE, Options, Wearer

RATES_HZ = (50.0, 10_000.0)
"""Bounds of the sampling rate: above twice the lowest frequency of the band, below what a table can hold."""

MOST_VALUES = 5e6
"""Samples times channels of one lap of the program, which is held in memory."""


class Synthetic:
    """A scripted wearer behind a wire. Faults are attributes that may change while it runs."""

    def __init__(self, options: Options, rate_hz: float, channels: int, clock: Clock) -> None:
        self.rate_hz = rate_hz
        self.channels = channels
        self.stall = False
        """Nothing arrives; what is taken meanwhile is lost."""
        self.nan = False
        """Every sample is not a number."""
        self.end = False
        """The source ends."""
        self._wearer = Wearer(options, rate_hz, channels)
        self._pacer = Pacer(clock, rate_hz, options.block_s, options.buffer_s)
        self._dropout = options.dropout
        self._lost = 0  # samples since the last block that arrived
        self._random = np.random.default_rng([options.seed, 2])

    async def __aiter__(self) -> AsyncIterator[EmgBlock]:
        """Blocks at their deadlines, for ever unless `end` is set."""
        while True:
            slot = await self._pacer.next()
            if self.end:
                return
            self._lost += slot.dropped
            if self.stall or self._random.random() < self._dropout:
                self._lost += slot.size
                continue
            lost, self._lost = self._lost, 0
            yield EmgBlock(slot.first, slot.time, self._read(slot), lost)

    def _read(self, slot: Slot) -> Samples:
        samples = self._wearer.read(slot.first, slot.size)
        if self.nan:
            samples[:] = np.nan
        return samples


@asynccontextmanager
async def open_emg(config: EmgConfig, clock: Clock) -> AsyncIterator[Synthetic]:
    """Open a simulated wearer; the options are those of `Options`.

    It has a channel for every muscle of the program and for every site, at least three.

    Raises:
        ConfigError: an option is unknown or out of bounds, or the rate or the program is.
    """
    options = parse(Options, config.options)
    low, high = RATES_HZ
    if not low <= config.rate_hz <= high:
        raise ConfigError(
            f"Simulated EMG cannot run at {config.rate_hz:g} Hz; it must be from {low:g} to {high:g} Hz.",
            "rate_hz",
        )
    channels = max(TOGGLE + 1, config.channels, *(step.channel + 1 for step in options.program))
    values = sum(step.seconds for step in options.program) * config.rate_hz * channels
    if values > MOST_VALUES:
        raise ConfigError(
            f"The EMG option 'program' makes {values:.3g} values a lap; the bound is {MOST_VALUES:.3g}.",
            "program",
        )
    yield Synthetic(options, config.rate_hz, channels, clock)
