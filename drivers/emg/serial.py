"""A source that reads the frames of a board, such as an Arduino, from a serial port."""

import asyncio
import math
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, closing
from typing import Annotated

import numpy as np
from pydantic import Field

from bentod.contracts import Clock, EmgConfig
from bentod.errors import BusError, InputFileError
from bentod.frames import EmgBlock
from drivers.emg.options import Table, parse
from drivers.emg.pacing import BUFFER_S
from drivers.emg.reader_thread import SILENT_S, Backlog
from drivers.emg.serial_frames import VERSION, Frame, Frames
from drivers.emg.timeline import Timeline
from drivers.stream import ByteStream, open_serial

RATE_S = 3.0
"""s over which the board's rate is measured at first."""

RATE_SHARE = 0.05
"""Share by which it may differ from the config's. Blocks that come 50 ms late make it wrong by 2 %."""

LEAP_S = 10.0
"""s that a gap may last; an index that leaps further is of another board, or of the same started anew."""


class Options(Table):
    """What a config may say about a board on a serial port."""

    port: Annotated[str, Field(min_length=1)]
    """E.g. "/dev/ttyACM0", or better a name below /dev/serial/by-id that stays."""

    baud: Annotated[int, Field(ge=9600, le=4_000_000)] = 115_200
    """Of no meaning to boards that are USB devices themselves."""

    volts_per_lsb: Annotated[float, Field(ge=1e-12, le=1.0)]
    """Volts at the electrodes that 1 in a frame stands for: the converter's step over the amplification."""

    clock_slow: Annotated[float, Field(ge=0.0, le=0.02)] = 0.005
    """Share by which the board's clock may be slow for good: 0.005 for a ceramic resonator."""

    open_s: Annotated[float, Field(ge=0.1, le=15.0)] = 5.0
    """How long the first frame may take: many boards start anew when their port is opened."""

    timeout_s: Annotated[float, Field(ge=0.1, le=5.0)] = SILENT_S
    """Time without a frame after which the board is lost, and its port opened again."""

    buffer_s: Annotated[float, Field(ge=0.05, le=10.0)] = BUFFER_S
    """How late a consumer may be before samples are dropped."""


class Board:
    """What sends frames through a line. `channels` is what its first frame has."""

    def __init__(self, line: ByteStream, options: Options, rate_hz: float, clock: Clock) -> None:
        self.rate_hz = rate_hz
        self.channels = 0
        self._options = options
        self._clock = clock
        self._frames = Frames()
        self._timeline = Timeline(rate_hz, options.clock_slow)
        self._backlog = Backlog(round(options.buffer_s * rate_hz))
        self._news = asyncio.Event()
        self._heard = 0  # bytes
        self._follows: int | None = None  # index of the next sample as the board counts
        self._size = 0  # samples in the first frame
        self._began = math.nan  # monotonic s, when that came
        self._broken = ""
        line.listen(self._on_bytes, self._on_lost)

    async def first(self) -> None:
        """Wait until the board is heard. Raises InputFileError: it is not, or not understood."""
        try:
            async with asyncio.timeout(self._options.open_s):
                await self._news.wait()
        except TimeoutError:
            raise InputFileError(self._unheard()) from None
        if self._broken:
            raise InputFileError(self._broken)

    async def __aiter__(self) -> AsyncIterator[EmgBlock]:
        """Blocks as they arrive, one a frame."""
        while True:
            self._news.clear()
            while block := self._backlog.take():
                yield block
            if self._broken:
                raise InputFileError(self._broken)
            try:
                async with asyncio.timeout(self._options.timeout_s):
                    await self._news.wait()
            except TimeoutError:
                self._on_lost(f"{self._title} has sent no frame for {self._options.timeout_s:g} s.")

    @property
    def _title(self) -> str:
        return f"The board at {self._options.port}"

    def _unheard(self) -> str:
        sentence = f"{self._title} has sent no frame within {self._options.open_s:g} s"
        if self._frames.version:
            return f"{sentence} that is of version {VERSION}, but some of version {self._frames.version}."
        if self._heard:
            return f"{sentence}, though {self._heard} bytes came; is {self._options.baud} its baud rate?"
        return f"{sentence}, and nothing else; is it running?"

    def _on_lost(self, reason: str) -> None:
        self._broken = self._broken or reason
        self._news.set()

    def _on_bytes(self, data: bytes) -> None:
        self._heard += len(data)
        arrival = self._clock.now()
        try:
            for frame in self._frames.take(data):
                self._take(frame, arrival)
        except InputFileError as error:
            self._on_lost(str(error))

    def _take(self, frame: Frame, arrival: float) -> None:
        """Pass a frame on. Raises InputFileError: it cannot be of the board that sent those before."""
        samples, channels = frame.counts.shape
        if self._follows is None:
            self.channels, self._follows = channels, frame.first
            self._size, self._began = samples, arrival
        lost = (frame.first - self._follows) % 2**32
        if channels != self.channels:
            raise InputFileError(f"{self._title} sends {channels} channels now; it had {self.channels}.")
        if lost > LEAP_S * self.rate_hz:
            raise InputFileError(
                f"{self._title} went from sample {self._follows} to {frame.first}; was it started anew?"
            )
        self._follows = (frame.first + samples) % 2**32
        first, time = self._timeline.place(samples, arrival, lost)
        volts = (frame.counts * self._options.volts_per_lsb).astype(np.float32)
        self._backlog.put(EmgBlock(first, time, volts, lost))
        self._check_rate(arrival)
        if self._timeline.trouble:
            raise InputFileError(f"{self._title} {self._timeline.trouble}.")
        self._news.set()

    def _check_rate(self, arrival: float) -> None:
        """Measure once how many samples come in a second. Raises InputFileError: not what the config says."""
        elapsed = arrival - self._began
        if not (elapsed >= RATE_S or (elapsed > 0 and self._timeline.trouble)):
            return
        self._began = math.nan
        measured = (self._timeline.next_index - self._size) / elapsed
        if abs(measured - self.rate_hz) > RATE_SHARE * self.rate_hz:
            raise InputFileError(
                f"{self._title} sends {measured:.0f} samples a second; emg.rate_hz is {self.rate_hz:g} Hz."
            )


@asynccontextmanager
async def open_emg(config: EmgConfig, clock: Clock) -> AsyncIterator[Board]:
    """Open a port and wait for the board behind it; the options are those of `Options`.

    Raises:
        ConfigError: an option is missing, unknown or out of bounds.
        InputFileError: the port cannot be opened, or no frame with enough channels comes.
    """
    options = parse(Options, config.options)
    try:
        # In a thread, because a port may take its time, and the arm may be moving when it is opened again.
        line = await asyncio.to_thread(open_serial, options.port, options.baud)
    except BusError as error:
        raise InputFileError(str(error)) from error
    with closing(line):
        board = Board(line, options, config.rate_hz, clock)
        await board.first()
        if board.channels < config.channels:
            raise InputFileError(
                f"The board at {options.port} sends {board.channels} channels; "
                f"the sites need {config.channels}."
            )
        yield board
