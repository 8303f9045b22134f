"""One recording after the other: begun and ended while the arm goes on."""

import asyncio
import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import TracebackType
from typing import Self

from bentod.contracts import Clock
from bentod.errors import Refused
from bentod.frames import Value
from bentod.record.disk import Disk
from bentod.record.provenance import begun
from bentod.record.recorder import Recorder
from bentod.record.scribe import Limits
from bentod.record.session import Entry, Header

OPENING = 3.0
"""s that a disk may take to open a file before it is said that it does not."""


class Takes:
    """A context manager. What is put while it is entered goes to the recording under way, if one is.

    Nothing that the loop calls ever waits or raises, as with the `Recorder`: what waits for a disk are
    threads. `start` and `stop` are for clients, and one of them at a time.
    """

    def __init__(self, template: Callable[[], Header], disk: Disk, limits: Limits, clock: Clock) -> None:
        """`template`: what all recordings have in common. It may take long, and is asked once."""
        self._template = template
        self._common: Header | None = None
        self._disk = disk
        self._limits = limits
        self._clock = clock
        self._newest: Recorder | None = None
        self._header: Header | None = None  # of the newest
        self._before: Recorder | None = None
        self._ended = math.inf  # monotonic s, when the newest was ended or ended by itself
        self._busy = False
        self._over = False

    def begin(self, learned: bytes = b"") -> None:
        """Record from now on, without a look at what the disk says; `learned`: as in `Header`."""
        self._common = self._template()
        header = begun(self._common, self._clock, learned=learned)
        self._adopt(header, Recorder(header, self._disk, self._limits).__enter__())

    async def start(self, note: str) -> None:
        """Record into a new file, once it is open; only then the one before it ends. No tick is lost.

        Raises:
            Refused: the disk does not take it, in which case what was recorded goes on being recorded; or
                another recording is just being begun or ended.
        """
        with self._alone():
            if self._common is None:
                self._common = await asyncio.to_thread(self._template)
            header = begun(self._common, self._clock, note)
            recorder = Recorder(header, self._disk, self._limits).__enter__()
            try:
                await self._open(recorder)
                self._adopt(header, recorder)
            finally:
                if recorder is not self._newest:
                    recorder.close(0.0)
            if self._before:
                await asyncio.to_thread(self._before.close)

    async def stop(self) -> None:
        """End the recording, and return once its file is whole.

        Raises:
            Refused: nothing is recorded; or another recording is just being begun or ended.
        """
        with self._alone():
            recorder = self.needed()
            self._ended = self._clock.now()
            await asyncio.to_thread(recorder.close)

    def needed(self) -> Recorder:
        """What records. Raises Refused: nothing does."""
        if self._newest is None or not self.recording:
            raise Refused("nothing is recorded")
        return self._newest

    @property
    def recording(self) -> bool:
        """Whether what is put is recorded."""
        return self._newest is not None and self._ended == math.inf and not self._newest.problem

    def put(self, entry: Entry) -> None:
        """Record an entry, if there is a recording."""
        if self._newest and self._ended == math.inf:
            self._newest.put(entry)

    def take_events(self) -> list[str]:
        """Sentences since the last call, as those of the `Recorder`."""
        if self._newest and self._newest.problem and self._ended == math.inf:
            self._ended = self._clock.now()
        known = [recorder for recorder in (self._before, self._newest) if recorder]
        return [sentence for recorder in known for sentence in recorder.take_events()]

    def describe(self) -> dict[str, Value]:
        """How the newest recording goes, or went, as clients see it."""
        if self._newest is None or self._header is None:
            return {"recording": False, "file": "", "problem": "", "note": "", "duration_s": 0.0}
        status, header = self._newest.status, self._header
        return {
            "recording": self.recording,
            "file": str(status.file or ""),
            "problem": status.problem,
            "note": header.note,
            "started": header.started,
            "started_wall": header.started_wall,
            "duration_s": min(self._clock.now(), self._ended) - header.started,
            "bytes": status.bytes,
            "waiting": status.waiting,
            "written": status.written.total,
            "dropped": status.dropped.total,
        }

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._over = True
        if self._newest:
            self._newest.close()

    def _adopt(self, header: Header, recorder: Recorder) -> None:
        self._before, self._newest = self._newest, recorder
        self._header = header
        self._ended = math.inf

    async def _open(self, recorder: Recorder) -> None:
        """Wait until the file is open. Raises Refused: it cannot be, or the daemon is ending."""
        opened = await asyncio.to_thread(recorder.wait_until_open, OPENING)
        if recorder.problem:
            raise Refused(f"nothing new is recorded: {recorder.problem}")
        if not opened:
            raise Refused(f"nothing new is recorded: the disk opened no file within {OPENING:g} s")
        if self._over:
            raise Refused("the daemon is ending")

    @contextmanager
    def _alone(self) -> Iterator[None]:
        if self._busy:
            raise Refused("a recording is just being begun or ended: ask again")
        self._busy = True
        try:
            yield
        finally:
            self._busy = False
