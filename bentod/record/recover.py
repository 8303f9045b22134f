"""Mends a file that was cut off: every whole chunk as it is, and a new end. The old file is kept."""

import os
from collections import defaultdict
from dataclasses import dataclass
from pathlib import Path
from typing import cast

from bentod.errors import RecordingError, Refused
from bentod.record.container import Container
from bentod.record.decode import brief, decode
from bentod.record.disk import File, is_being_written
from bentod.record.mcap_file import ChunkAt, DamagedError
from bentod.record.part_reader import PartReader
from bentod.record.session import KINDS, Counts, Report
from bentod.record.tally import Counter
from bentod.record.wire import encoder
from bentod.whole_file import sync_folder

ASIDE = ".cut"
"""What is added to the name of the file that was mended."""


@dataclass(frozen=True, slots=True)
class Recovered:
    """What came of mending one file."""

    path: Path
    aside: Path | None  # the file as it was found; None: it was whole, nothing was done
    entries: Counts  # that are in the file now
    end: float  # monotonic s of the latest of them; nan if there is none
    torn: int  # bytes at the end that were no whole record
    damaged: tuple[str, ...]  # sentences about chunks that could not be read
    missing: int  # messages that were written before the last whole chunk, but are in none

    def __str__(self) -> str:
        if self.aside is None:
            return f"{self.path} is whole; there is nothing to mend."
        parts = [
            f"{self.path} is mended: it has {self.entries.total} entries; the old file is {self.aside.name}."
        ]
        if self.torn:
            parts.append(f"Its last {self.torn} bytes were torn and are lost.")
        parts += self.damaged
        if self.missing:
            parts.append(f"{self.missing} messages are missing in between.")
        return " ".join(parts)


def recover(path: Path) -> Recovered:
    """Mend a file in place. If anything goes wrong on the way, the file stays as it was.

    Raises:
        Refused: it is still being recorded.
        RecordingError: nothing of it can be read, or there is no room for a second copy.
    """
    if path.exists() and is_being_written(path):
        raise Refused(f"{path} is still being recorded; end the daemon that writes it first.")
    reader = PartReader(path)
    try:
        return _mend(reader, path)
    except OSError as error:
        raise RecordingError(f"{path} cannot be mended: {error.strerror}.") from error
    finally:
        reader.close()


def _mend(reader: PartReader, path: Path) -> Recovered:
    temporary = path.with_name(f".{path.name}.mending")
    temporary.unlink(missing_ok=True)  # of an earlier attempt that was cut off itself
    try:
        copy = _Copy(reader, File(temporary))
        copy.chunks()
        if reader.contents.closed and not copy.damaged:
            return copy.result(None)
        copy.finish()
        aside = _free_name(path)
        os.link(path, aside)
        os.replace(temporary, path)
        sync_folder(path.parent)
        return copy.result(aside)
    finally:
        temporary.unlink(missing_ok=True)


class _Copy:
    """The new file."""

    def __init__(self, reader: PartReader, sink: File) -> None:
        self.damaged: list[str] = []
        self._reader = reader
        self._sink = sink
        self._counter = Counter()
        self._dropped = Counts()
        self._next: int | None = None
        self._missing = 0
        self._latest = 0
        version = reader.header.versions.get("bentod", "")
        self._container = Container(sink, f"bentod {version} (mended)")
        for record in reader.file.head_records():
            self._container.copy(reader.file.raw(record))

    def chunks(self) -> None:
        """Copy those that are whole."""
        for chunk in self._reader.contents.chunks:
            try:
                self._chunk(chunk)
            except DamagedError as error:
                self.damaged.append(f"{str(error).capitalize()}.")

    def finish(self) -> None:
        """Add what the end of a file has."""
        channel = next((n for n, kind in self._reader.kinds.items() if kind is Report), None)
        if channel is not None:
            self._counter.drop(self._dropped)
            text = "The recording was cut off here, and mended."
            report = Report(self._counter.end, text, True, self._counter.tally())
            self._container.message(channel, self._next or 0, self._latest, encoder("Report")(report))
        self._container.finish()
        self._sink.sync()
        self._sink.close()

    def result(self, aside: Path | None) -> Recovered:
        """What to tell."""
        return Recovered(
            path=self._reader.path,
            aside=aside,
            entries=self._counter.written,
            end=self._counter.end,
            torn=self._reader.contents.lost,
            damaged=tuple(self.damaged),
            missing=self._missing,
        )

    def _chunk(self, chunk: ChunkAt) -> None:
        file = self._reader.file
        offsets: dict[int, list[int]] = defaultdict(list)
        for message in file.messages(chunk):
            offsets[message.channel] += (message.time, message.offset)
            self._follow(message.sequence)
            kind = self._reader.kinds.get(message.channel)
            if kind in KINDS:
                self._counter.add(kind, brief(kind, message.data))
            elif kind is Report:
                self._dropped = cast("Report", decode(kind, message.data)).tally.dropped
        self._latest = chunk.end
        self._container.chunk(file.raw(chunk), file.chunk(chunk), offsets)

    def _follow(self, sequence: int) -> None:
        if self._next is not None:
            self._missing += (sequence - self._next) & 0xFFFFFFFF
        self._next = (sequence + 1) & 0xFFFFFFFF


def _free_name(path: Path) -> Path:
    """A name beside `path` that nothing has."""
    names = (f"{path.name}{ASIDE}{number or ''}" for number in range(1000))
    return next(path.with_name(name) for name in names if not path.with_name(name).exists())
