"""A source of simulated muscle signals, which can be broken on purpose."""

from collections.abc import AsyncIterator, Collection, Mapping
from contextlib import asynccontextmanager

import numpy as np

from bentod.contracts import Clock, EmgConfig
from bentod.errors import ConfigError
from bentod.frames import EmgBlock, Samples
from drivers.emg.options import parse
from drivers.emg.pacing import Pacer, Slot
from sim.clock import DriftingClock
from sim.emg_wearer import TOGGLE, Options, Wearer
from sim.movement_signals import Moving
from sim.movements import Prompted
from sim.obeying import Obeying

RATES_HZ = (50.0, 10_000.0)
"""Bounds of the sampling rate: above twice the lowest frequency of the band, below what a table can hold."""

MOST_VALUES = 5e6
"""Samples times channels of one lap of the program, which is held in memory."""

RAIL = 1e-3
"""V at which the converter ends."""

DRIVEN = 1e4
"""Amplification of a channel that is saturated: even a muscle at rest is at the rails."""


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
        self.stuck: Mapping[int, float] = {}
        """V, by channel that gives nothing else."""
        self.saturated: Collection[int] = ()
        """Channels that are driven to both rails."""
        self.late = 0.0
        """s by which blocks come later than they could, with the times at which they were taken."""
        self.relaxed = False
        """The wearer is at rest, whatever the program says."""
        movements = options.movements
        self.obeying = Obeying(movements, rate_hz) if movements and movements.obeys else None
        """Who makes what `prompt` asks for; None: nobody heeds it."""
        alone = movements if movements and not movements.obeys else None
        self.moving = Moving(alone, rate_hz) if alone else None
        """Who makes prompted movements, and can tell which is truly made at a sample; None: another."""
        self._wearer = self.obeying or self.moving or Wearer(options, rate_hz, channels)
        self._resting = _resting(options, rate_hz, channels)
        self._own = DriftingClock(clock)
        self._pacer = Pacer(self._own, rate_hz, options.block_s, options.buffer_s)
        self._dropout = options.dropout
        self._lost = 0  # samples since the last block that arrived
        self._random = np.random.default_rng([options.seed, 2])

    def prompt(self, label: str) -> None:
        """Have the wearer make this movement until another is asked for, if they obey."""
        if self.obeying:
            self.obeying.prompt(label)

    @property
    def drift(self) -> float:
        """Share by which the source's own clock is fast, from which it takes its rate and its time stamps."""
        return self._own.drift

    @drift.setter
    def drift(self, share: float) -> None:
        self._own.drift = share

    async def __aiter__(self) -> AsyncIterator[EmgBlock]:
        """Blocks at their deadlines, for ever unless `end` is set."""
        while True:
            slot = await self._pacer.next()
            if self.late:
                await self._own.sleep_until(slot.time + slot.size / self.rate_hz + self.late)
            if self.end:
                return
            self._lost += slot.dropped
            if self.stall or self._random.random() < self._dropout:
                self._lost += slot.size
                continue
            lost, self._lost = self._lost, 0
            yield EmgBlock(slot.first, slot.time, self._read(slot), lost)

    def _read(self, slot: Slot) -> Samples:
        samples = (self._resting if self.relaxed else self._wearer).read(slot.first, slot.size)
        for channel in self.saturated:
            samples[:, channel] = np.clip(DRIVEN * samples[:, channel], -RAIL, RAIL)
        for channel, volts in self.stuck.items():
            samples[:, channel] = volts
        if self.nan:
            samples[:] = np.nan
        return samples


def _resting(options: Options, rate_hz: float, channels: int) -> Wearer | Moving:
    """The same person, who does nothing."""
    if options.movements is None:
        return Wearer(options.model_copy(update={"full_v": 0.0}), rate_hz, channels)
    idle = {"effort": 0.0, "load_share": 0.0, "repetitions": 1}
    return Moving(options.movements.model_copy(update=idle), rate_hz)


def _electrodes(movements: Prompted, config: EmgConfig) -> int:
    """Channels of prompted movements; none is added, which would move the others."""
    if config.channels > movements.electrodes:
        raise ConfigError(
            f"The EMG option 'movements.electrodes' is {movements.electrodes}, but the config reads channel "
            f"{config.channels - 1}, counted from 0.",
            "movements.electrodes",
        )
    return movements.electrodes


@asynccontextmanager
async def open_emg(config: EmgConfig, clock: Clock) -> AsyncIterator[Synthetic]:
    """Open a simulated wearer; the options are those of `Options`.

    It has a channel for every muscle of the program and for every site, at least three; for prompted
    movements as many as there are electrodes.

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
    if options.movements is not None:
        yield Synthetic(options, config.rate_hz, _electrodes(options.movements, config), clock)
        return
    named = [it for step in options.program for it in (step.channel, step.also) if it is not None]
    channels = max(TOGGLE + 1, config.channels, max(named) + 1)
    values = sum(step.seconds for step in options.program) * config.rate_hz * channels
    if values > MOST_VALUES:
        raise ConfigError(
            f"The EMG option 'program' makes {values:.3g} values a lap; the bound is {MOST_VALUES:.3g}.",
            "program",
        )
    yield Synthetic(options, config.rate_hz, channels, clock)
