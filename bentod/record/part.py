"""One part of a session: one file, from its header to its index."""

import math
from dataclasses import dataclass, replace
from pathlib import Path

from bentod.frames import Event, Frame, Trial, Value
from bentod.record.codec import CHANNEL_OF, CHANNELS, ENCODERS, Plots, encode_log
from bentod.record.container import CHUNK_BYTES, Container, Sink
from bentod.record.headers import write_header
from bentod.record.session import Counts, Entry, Header, Mark, Report
from bentod.record.tally import Counter, point

CHUNK_TIME = 450_000_000
"""ns that a chunk covers, however fast its entries came."""

PLOTTED = 10.0
"""Hz, at most, of the topic for plots: what is in the frames anyhow, by name."""

_LOG, _JOINTS = CHANNELS["/log"], CHANNELS["/joints"]


@dataclass(slots=True)
class Course:
    """What goes on from part to part: the numbering of messages, and what the marks last said."""

    sequence: int = 0
    trial: Trial | None = None
    meta: Value = None


class Part:
    """A file that is being written. All methods raise OSError when the disk does."""

    def __init__(self, sink: Sink, path: Path, header: Header, course: Course) -> None:
        self.path = path
        self.counter = Counter()
        self._sink = sink
        self._header = header
        self._course = course
        self._plots = Plots(header.joints)
        self._plotted = -math.inf
        self._marked = False
        self._latest = self._ns(header.started)
        version = header.versions.get("bentod", "")
        self._container = Container(sink, f"bentod {version}".strip())
        write_header(self._container, header, self._ns(header.started))
        self._start = self._container.size

    @property
    def size(self) -> int:
        """Bytes written."""
        return self._container.size

    @property
    def data(self) -> int:
        """Bytes written after the header."""
        return self._container.size - self._start

    @property
    def waiting(self) -> int:
        """Bytes that are not written yet, uncompressed."""
        return self._container.waiting

    @property
    def full(self) -> bool:
        """Whether the open chunk should be written now: for its bytes, or for the time that it covers."""
        return self._container.waiting >= CHUNK_BYTES or self._container.covers >= CHUNK_TIME

    def put(self, entry: Entry) -> None:
        """Add one entry to the open chunk.

        Raises:
            Exception: whatever an entry that does not fit the schema leads to; nothing of it was added.
        """
        data = ENCODERS[type(entry)](entry)
        time = self._ns(entry.time)
        self._latest = time
        self._add(CHANNEL_OF[type(entry)], time, data)
        self.counter.add(type(entry), point(entry))
        if isinstance(entry, Frame):
            self._derive(entry, time)
        elif isinstance(entry, Event):
            self._add(_LOG, time, encode_log(entry.kind, entry.text, time))

    def drop(self, counts: Counts, text: str) -> None:
        """Note that entries are missing here."""
        self.counter.drop(counts)
        self.report(text)

    def report(self, text: str, *, closing: bool = False) -> None:
        """Have the recorder say something of itself."""
        report = Report(self.counter.end, text, closing, self.counter.tally())
        self._add(CHANNEL_OF[Report], self._latest, ENCODERS[Report](report))
        if text:
            self._add(_LOG, self._latest, encode_log("recording", text, self._latest))

    def flush(self) -> None:
        """Hand the open chunk to the system."""
        self._container.flush()

    def sync(self) -> None:
        """Have the disk take everything that was handed over."""
        self._sink.sync()

    def finish(self, text: str = "") -> None:
        """End the file: whole, on the disk, closed. `text` says why, if it is not just its end."""
        self.report(text, closing=True)
        self._container.finish()
        self._sink.sync()
        self._sink.close()

    def abandon(self) -> None:
        """Give the file up as it is."""
        self._sink.close()

    def _derive(self, frame: Frame, time: int) -> None:
        course = self._course
        if not self._marked or frame.trial != course.trial or frame.meta is not course.meta:
            self._mark(frame, time)
        if not frame.time - self._plotted < 1 / PLOTTED - 1e-6:
            self._plotted = frame.time
            self._add(_JOINTS, time, self._plots.encode(frame))

    def _mark(self, frame: Frame, time: int) -> None:
        same = frame.trial == self._course.trial and frame.meta == self._course.meta
        self._course.trial, self._course.meta = frame.trial, frame.meta
        if self._marked and same:
            return
        self._marked = True
        mark = Mark(frame.time, frame.tick, frame.trial, frame.meta)
        self._add(CHANNEL_OF[Mark], time, ENCODERS[Mark](mark))

    def _add(self, channel: int, time: int, data: bytes) -> None:
        self._container.message(channel, self._course.sequence, time, data)
        self._course.sequence += 1

    def _ns(self, time: float) -> int:
        return self._latest if math.isnan(time) else self._header.log_time(time)


def next_header(header: Header) -> Header:
    """The header of the part after this one."""
    return replace(header, part=header.part + 1)
