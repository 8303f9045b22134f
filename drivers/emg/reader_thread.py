"""A source whose library blocks: a thread of its own reads, and a bounded queue leads to the event loop."""

import asyncio
import atexit
import logging
import threading
from collections import deque
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager, closing, suppress
from dataclasses import dataclass, replace
from typing import Protocol, TypeAlias

from bentod.errors import BentodError, InputFileError
from bentod.frames import EmgBlock
from drivers.emg.pacing import BUFFER_S

log = logging.getLogger(__name__)

CLOSE_S = 0.08
"""s that closing waits for the thread. A call into a library that takes longer is left alone to end, and the
thread gives the device back then."""

OPEN_S = 15.0
"""s that opening may take; the handshake of a wireless board takes several."""

EXIT_S = 2.0
"""s that the end of the process waits for a device that is still being given back."""

SILENT_S = 0.5
"""Usual time without a sample after which a source has broken."""


class Device(Protocol):
    """What the thread reads. It is opened, read and closed in that thread and nowhere else."""

    rate_hz: float
    channels: int

    def read(self) -> EmgBlock | None:
        """The next block, or None when there was none within some 20 ms; a stop waits for it.

        Raises:
            InputFileError: the device broke.
        """
        ...

    def close(self) -> None:
        """Give the device back. Raises nothing."""
        ...


OpenDevice: TypeAlias = Callable[[], Device]
"""Runs in the thread.

Raises:
    ConfigError: an option does not fit the device.
    InputFileError: the device cannot be used.
"""


class Backlog:
    """Blocks on their way from the thread to the loop.

    When more than `most` samples wait, everything but the newest block is lost, and counted in the next
    block that is taken: who is that late has no use for what is old.
    """

    def __init__(self, most: int) -> None:
        self._most = most
        self._lock = threading.Lock()
        self._blocks: deque[EmgBlock] = deque()
        self._waiting = 0  # samples
        self._lost = 0  # samples
        self._full = False

    def put(self, block: EmgBlock) -> None:
        """Add the newest block; never waits."""
        with self._lock:
            self._blocks.append(block)
            self._waiting += len(block.samples)
            self._full |= self._waiting > self._most
            while self._full and len(self._blocks) > 1:
                gone = self._blocks.popleft()
                self._waiting -= len(gone.samples)
                self._lost += gone.dropped + len(gone.samples)

    def take(self) -> EmgBlock | None:
        """The oldest block; None when there is none."""
        with self._lock:
            if not self._blocks:
                return None
            block = self._blocks.popleft()
            self._waiting -= len(block.samples)
            lost, self._lost, self._full = self._lost, 0, False
        return replace(block, dropped=block.dropped + lost) if lost else block


@dataclass(frozen=True, slots=True)
class Opened:
    """What the loop may know of a device."""

    rate_hz: float
    channels: int


class Threaded:
    """The source at the loop's end of the queue. A device that is silent for too long has broken."""

    def __init__(self, reader: "_Reader", opened: Opened, silent_s: float) -> None:
        self.rate_hz = opened.rate_hz
        self.channels = opened.channels
        self._reader = reader
        self._silent_s = silent_s

    async def __aiter__(self) -> AsyncIterator[EmgBlock]:
        """Blocks as they arrive; what was read before an error comes before the error."""
        while True:
            try:
                async with asyncio.timeout(self._silent_s):
                    block = await self._reader.next()
            except TimeoutError:
                raise InputFileError(
                    f"{self._reader.title} has given no sample for {self._silent_s:g} s."
                ) from None
            yield block


class _Reader:
    """The thread, and what it tells the loop."""

    def __init__(self, open_device: OpenDevice, title: str, buffer_s: float) -> None:
        self.title = title
        self._open = open_device
        self._buffer_s = buffer_s
        self._backlog = Backlog(0)
        self._loop = asyncio.get_running_loop()
        self._opened: asyncio.Future[Opened] = self._loop.create_future()
        self._news = asyncio.Event()
        self._ended = asyncio.Event()
        self._error: BentodError | None = None
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name=f"EMG {title}", daemon=True)

    async def open(self) -> Opened:
        self._thread.start()
        try:
            async with asyncio.timeout(OPEN_S):
                return await self._opened
        except TimeoutError:
            raise InputFileError(f"{self.title} has not opened within {OPEN_S:g} s.") from None

    async def next(self) -> EmgBlock:
        while True:
            self._news.clear()
            over = self._ended.is_set()
            block = self._backlog.take()
            if block is not None:
                return block
            if over:
                raise self._error or InputFileError(f"{self.title} was closed.")
            await self._news.wait()

    async def close(self) -> None:
        """Give the thread a moment to end; the loop is never held up for longer."""
        self._stop.set()
        try:
            async with asyncio.timeout(CLOSE_S):
                await self._ended.wait()
            self._thread.join(CLOSE_S)  # it has said its last word
        except TimeoutError:
            log.info("%s is still being closed.", self.title)
            atexit.register(self._thread.join, EXIT_S)

    def _run(self) -> None:
        try:
            with closing(self._open()) as device:
                self._read(device)
        except BentodError as error:
            self._error = error
        except Exception as error:
            log.exception("%s broke", self.title)
            self._error = InputFileError(f"{self.title} broke: {type(error).__name__}: {error}.")
        self._tell(self._end)

    def _read(self, device: Device) -> None:
        self._backlog = Backlog(round(self._buffer_s * device.rate_hz))
        self._tell(self._begin, Opened(device.rate_hz, device.channels))
        while not self._stop.is_set():
            block = device.read()
            if block is not None and len(block.samples):
                self._backlog.put(block)
                self._tell(self._news.set)

    def _tell(self, what: Callable[..., None], *told: Opened) -> None:
        with suppress(RuntimeError):  # the loop is gone, and nobody waits for news
            self._loop.call_soon_threadsafe(what, *told)

    def _begin(self, opened: Opened) -> None:
        if not self._opened.done():
            self._opened.set_result(opened)

    def _end(self) -> None:
        self._ended.set()
        self._news.set()
        atexit.unregister(self._thread.join)
        if not self._opened.done() and self._error:
            self._opened.set_exception(self._error)


@asynccontextmanager
async def reading(
    open_device: OpenDevice, title: str, buffer_s: float = BUFFER_S, silent_s: float = SILENT_S
) -> AsyncIterator[Threaded]:
    """A source that reads the device which `open_device` opens, in a thread of its own.

    `title` begins its sentences, e.g. "The LSL stream 'EMG'". `buffer_s`: how late a consumer may be before
    blocks are dropped; `silent_s`: s without a sample after which iteration raises.

    Raises:
        ConfigError: an option does not fit the device.
        InputFileError: the device cannot be used, or does not open in time.
    """
    reader = _Reader(open_device, title, buffer_s)
    try:
        opened = await reader.open()
        yield Threaded(reader, opened, silent_s)
    finally:
        await reader.close()
