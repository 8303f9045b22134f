"""A source that plays a recording of muscle signals at its own rate."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Annotated

import numpy as np
from pydantic import Field

from bentod.contracts import Clock, EmgConfig
from bentod.errors import ConfigError, InputFileError
from bentod.frames import EmgBlock, Samples
from drivers.emg.options import Table, parse
from drivers.emg.pacing import BLOCK_S, BUFFER_S, Pacer, Slot
from drivers.emg.recording import Recording, load


class Options(Table):
    """What a config may say about a replay."""

    file: Annotated[str, Field(min_length=1)]
    """Path of the recording, .npz or .csv; "~" is the home folder."""

    array: Annotated[str, Field(min_length=1)] | None = None
    """Name of the array in an .npz file; by default "emg", else its only 2-D array."""

    rate_hz: Annotated[float, Field(ge=1.0, le=100_000.0)] | None = None
    """Sampling rate, when the file does not state it; by default that of the daemon's config."""

    volts_per_unit: Annotated[float, Field(ge=1e-12, le=1e3)] | None = None
    """Volts that 1 in the file stands for; by default 1e-6 for whole numbers and 1.0 for others."""

    loop: bool = True
    """Begin again at the end; the index runs on."""

    speed: Annotated[float, Field(ge=0.1, le=100.0)] = 1.0
    """Seconds of the recording in a second."""

    block_s: Annotated[float, Field(ge=0.0001, le=0.05)] = BLOCK_S
    """Length of a block as it arrives."""

    buffer_s: Annotated[float, Field(ge=0.05, le=10.0)] = BUFFER_S
    """How late a consumer may be before blocks are dropped."""


class Replay:
    """A recording that is being played.

    `rate_hz` is the rate at which the samples arrive, so it includes the speed; windows count samples
    and stay what they were.
    """

    def __init__(self, samples: Samples, loop: bool, rate_hz: float, pacer: Pacer) -> None:
        self.rate_hz = rate_hz
        self.channels = samples.shape[1]
        self._samples = samples
        self._loop = loop
        self._pacer = pacer

    async def __aiter__(self) -> AsyncIterator[EmgBlock]:
        """Blocks at their deadlines; ends with the recording unless it is played in a loop."""
        while True:
            slot = await self._pacer.next()
            samples = self._cut(slot)
            if not len(samples):
                return
            yield EmgBlock(slot.first, slot.time, samples, slot.dropped)

    def _cut(self, slot: Slot) -> Samples:
        """The samples of `slot`, fewer or none at the end of a recording that is played once."""
        if not self._loop:
            return self._samples[slot.first : slot.first + slot.size].copy()
        rows = np.arange(slot.first, slot.first + slot.size) % len(self._samples)
        return self._samples[rows]


@asynccontextmanager
async def open_emg(config: EmgConfig, clock: Clock) -> AsyncIterator[Replay]:
    """Open a recording; the options are those of `Options`.

    Raises:
        ConfigError: an option is unknown or out of bounds, or contradicts the file.
        InputFileError: the file cannot be used.
    """
    options = parse(Options, config.options)
    recording, rate_hz = _recording(options, config)
    rate_hz *= options.speed
    pacer = Pacer(clock, rate_hz, options.block_s, options.buffer_s)
    yield Replay(recording.samples, options.loop, rate_hz, pacer)


def _recording(options: Options, config: EmgConfig) -> tuple[Recording, float]:
    """The recording and its own rate (Hz)."""
    path = Path(options.file).expanduser()
    recording = load(path, options.array, options.volts_per_unit)
    channels = recording.samples.shape[1]
    if channels < config.channels:
        raise InputFileError(f"{path}: it has {channels} channels; the sites need {config.channels}.")
    return recording, _rate(path, recording, options, config)


def _rate(path: Path, recording: Recording, options: Options, config: EmgConfig) -> float:
    stated, wanted = recording.rate_hz, options.rate_hz
    if stated is None:
        return wanted or config.rate_hz
    if wanted is not None and abs(wanted - stated) > 0.01 * stated:
        raise ConfigError(
            f"The EMG option 'rate_hz' is {wanted:g} Hz, but {path} states {stated:g} Hz; "
            "leave it out, or use 'speed' to play faster or slower.",
            "rate_hz",
        )
    return stated
