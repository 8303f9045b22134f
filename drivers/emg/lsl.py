"""A source that listens to a stream of the Lab Streaming Layer, to which many vendors have bridges."""

from collections.abc import AsyncIterator, Mapping
from contextlib import asynccontextmanager, suppress
from functools import partial
from typing import Annotated, Self, TypeAlias

import numpy as np
from pydantic import Field, model_validator

from bentod.contracts import Clock, EmgConfig
from bentod.errors import ConfigError, InputFileError
from bentod.frames import EmgBlock
from drivers.emg.lsl_stamps import Stamps
from drivers.emg.options import Table, parse
from drivers.emg.pacing import BLOCK_S, BUFFER_S
from drivers.emg.reader_thread import SILENT_S, Threaded, reading

try:
    import pylsl
except RuntimeError as error:  # pylsl's, where there is no liblsl for this machine
    raise ImportError(str(error), name="pylsl") from error

READ_S = 0.02
"""s that the thread waits for a block at most."""

CORRECT_S = 5.0
"""s after which the sender's clock is compared with this machine's anew."""

CLOCKS_S = 3.0
"""s that the first comparison may take; it takes 0.7."""

RATE_SHARE = 0.01
"""Share by which the stream's rate may differ from the config's."""

FOREIGN_S = 10.0
"""s from now, beyond which stamps are of no clock of LSL's."""

DTYPES: Mapping[int, type[np.number]] = {
    pylsl.cf_float32: np.float32,
    pylsl.cf_double64: np.float64,
    pylsl.cf_int32: np.int32,
    pylsl.cf_int16: np.int16,
    pylsl.cf_int8: np.int8,
    pylsl.cf_int64: np.int64,
}

VOLTS = {
    "volts": 1.0, "volt": 1.0, "v": 1.0,
    "millivolts": 1e-3, "millivolt": 1e-3, "mv": 1e-3,
    "microvolts": 1e-6, "microvolt": 1e-6, "uv": 1e-6, "µv": 1e-6, "μv": 1e-6,
    "nanovolts": 1e-9, "nanovolt": 1e-9, "nv": 1e-9,
}  # fmt: skip
"""Volts of the units that streams tell of their channels; capitals do not matter."""


Called: TypeAlias = Annotated[str, Field(min_length=1, max_length=256, pattern='^[^"]*$')]
"""Streams are looked for by XPath, which has no way to say a quotation mark."""


class Options(Table):
    """What a config may say about a stream; at least one of `stream`, `type` and `source_id`."""

    stream: Called | None = None
    """Name of the stream."""

    type: Called | None = None
    """Its type, often "EMG"."""

    source_id: Called | None = None
    """What its sender calls it, and no other."""

    channels: Annotated[tuple[Annotated[int, Field(ge=0, le=1023)], ...], Field(min_length=1)] | None = None
    """Which of its channels, in which order; by default all."""

    volts_per_unit: Annotated[float, Field(ge=1e-12, le=1e3)] | None = None
    """Volts that 1 in the stream stands for; by default what the stream tells of its channels' units."""

    open_s: Annotated[float, Field(ge=0.5, le=8.0)] = 5.0
    """How long the stream is looked for. When it finds none, liblsl sometimes takes 5 s more."""

    timeout_s: Annotated[float, Field(ge=0.1, le=5.0)] = SILENT_S
    """Time without a sample after which the stream is lost, and looked for again."""

    buffer_s: Annotated[float, Field(ge=0.05, le=10.0)] = BUFFER_S
    """How late a consumer may be before samples are dropped."""

    @model_validator(mode="after")
    def _says_which(self) -> Self:
        if not self.wanted():
            raise ValueError("say which stream: its stream (the name), type or source_id")
        return self

    def wanted(self) -> dict[str, str]:
        """What the stream must be called, by LSL's own names."""
        told = {"name": self.stream, "type": self.type, "source_id": self.source_id}
        return {key: value for key, value in told.items() if value is not None}


class Inlet:
    """One stream, read in a thread (`Device` of the reader)."""

    def __init__(self, info: pylsl.StreamInfo, options: Options, ahead: float) -> None:
        """`ahead`: s that our clock shows more than LSL's on this machine."""
        self.rate_hz = float(info.nominal_srate())
        self._inlet = pylsl.StreamInlet(info, max_buflen=int(options.buffer_s) + 1, recover=False)
        self._ahead = ahead
        self._stamps = Stamps(self.rate_hz)
        told = self._inlet.info(CLOCKS_S)
        self._picked = list(options.channels or range(info.channel_count()))
        self._scale = np.array(_scale(told, self._picked, options))
        self.channels = len(self._picked)
        size = max(1, round(BLOCK_S * self.rate_hz))
        self._counts = np.zeros((size, info.channel_count()), DTYPES[info.channel_format()])
        self._correction = float(self._inlet.time_correction(CLOCKS_S))
        self._corrected = self._now()
        self._inlet.open_stream(options.open_s)

    def read(self) -> EmgBlock | None:
        """A block of 10 ms, or of what came in 20 ms.

        Raises:
            InputFileError: the stream is gone.
        """
        try:
            _, stamps = self._inlet.pull_chunk(READ_S, len(self._counts), dest_obj=self._counts)
            self._correct()
        except RuntimeError as error:
            raise InputFileError(f"The LSL stream was lost: {error}") from error
        if not stamps:
            return None
        times = np.array(stamps) + self._correction + self._ahead
        self._check_clock(float(times[-1]))
        first, begins, lost = self._stamps.place(times)
        volts = self._counts[: len(times), self._picked] * self._scale
        return EmgBlock(first, begins, volts.astype(np.float32), lost)

    def close(self) -> None:
        """Leave the stream; liblsl ends its threads when nobody refers to the inlet any more."""
        self._inlet.close_stream()
        self._inlet = None

    def _now(self) -> float:
        """Monotonic s."""
        return float(pylsl.local_clock()) + self._ahead

    def _correct(self) -> None:
        if self._now() - self._corrected > CORRECT_S:
            self._corrected = self._now()
            with suppress(pylsl.util.TimeoutError):  # then the clocks are as they were
                self._correction = float(self._inlet.time_correction(READ_S))

    def _check_clock(self, newest: float) -> None:
        """Refuse a stamp (monotonic s) that is of another clock."""
        off = newest - self._now()
        if not abs(off) <= FOREIGN_S:
            raise InputFileError(
                f"The stamps of the LSL stream are {off:.3g} s from now; the bound is {FOREIGN_S:g} s. "
                "Its sender must stamp samples by LSL's clock."
            )


def _scale(info: pylsl.StreamInfo, picked: list[int], options: Options) -> list[float]:
    """Volts of 1 in each channel that is picked. Raises ConfigError: nobody says."""
    if options.volts_per_unit is not None:
        return [options.volts_per_unit] * len(picked)
    units = [unit or "" for unit in info.get_channel_units() or [""] * info.channel_count()]
    for channel in picked:
        if units[channel].strip().lower() not in VOLTS:
            said = f"'{units[channel]}'" if units[channel] else "nothing"
            raise ConfigError(
                f"The LSL stream says {said} of the unit of channel {channel}; give volts_per_unit.",
                "volts_per_unit",
            )
    return [VOLTS[units[channel].strip().lower()] for channel in picked]


def _found(options: Options) -> pylsl.StreamInfo:
    wanted = options.wanted()
    told = " and ".join(f"{key} '{value}'" for key, value in wanted.items())
    predicate = " and ".join(f'{key}="{value}"' for key, value in wanted.items())
    found = pylsl.resolve_bypred(predicate, 1, options.open_s)
    if not found:
        raise InputFileError(f"No LSL stream of {told} was found within {options.open_s:g} s.")
    if len(found) > 1:
        ids = ", ".join(sorted(f"'{info.source_id()}' on {info.hostname()}" for info in found))
        raise ConfigError(
            f"There are {len(found)} LSL streams of {told}; say which source_id: {ids}.", "source_id"
        )
    return found[0]


def _check(info: pylsl.StreamInfo, config: EmgConfig, options: Options) -> None:
    """Raises ConfigError: the stream is not one of even samples at the config's rate; or has few channels."""
    name, rate_hz, count = info.name(), float(info.nominal_srate()), info.channel_count()
    if info.channel_format() not in DTYPES:
        raise ConfigError(f"The LSL stream '{name}' holds text, not numbers.", "type")
    if rate_hz == pylsl.IRREGULAR_RATE:
        raise ConfigError(f"The LSL stream '{name}' has no even rate, so its samples cannot be counted.")
    if abs(rate_hz - config.rate_hz) > RATE_SHARE * rate_hz:
        raise ConfigError(
            f"The LSL stream '{name}' has {rate_hz:g} Hz, but emg.rate_hz is {config.rate_hz:g} Hz.",
            "rate_hz",
        )
    picked = options.channels or range(count)
    if max(picked) >= count:
        raise ConfigError(
            f"The LSL stream '{name}' has {count} channels, and none of number {max(picked)}.", "channels"
        )
    if len(picked) < config.channels:
        raise ConfigError(
            f"The LSL stream '{name}' gives {len(picked)} channels; the sites need {config.channels}.",
            "channels",
        )


def _opened(config: EmgConfig, options: Options, ahead: float) -> Inlet:
    """Runs in the thread."""
    try:
        info = _found(options)
        _check(info, config, options)
        return Inlet(info, options, ahead)
    except RuntimeError as error:
        raise InputFileError(f"The LSL stream cannot be opened: {error}") from error


@asynccontextmanager
async def open_emg(config: EmgConfig, clock: Clock) -> AsyncIterator[Threaded]:
    """Listen to a stream; the options are those of `Options`.

    Raises:
        ConfigError: an option is unknown or out of bounds, or the stream is not one for it.
        InputFileError: there is no such stream.
    """
    options = parse(Options, config.options)
    ahead = clock.now() - float(pylsl.local_clock())
    opening = partial(_opened, config, options, ahead)
    async with reading(opening, "The LSL stream", options.buffer_s, options.timeout_s) as source:
        yield source
