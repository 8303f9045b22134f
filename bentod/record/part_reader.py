"""Reads one file of a session: lazily, chunk by chunk, whether or not it is whole."""

from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass, field
from functools import cached_property
from itertools import chain
from pathlib import Path
from typing import cast

from bentod.errors import RecordingError
from bentod.record.codec import TOPICS, Recorded
from bentod.record.decode import brief, decode
from bentod.record.disk import is_being_written
from bentod.record.headers import read_header
from bentod.record.info import PartInfo
from bentod.record.mcap_file import ChunkAt, Contents, DamagedError, McapFile, Message
from bentod.record.session import KINDS, Counts, Header, Mark, Report
from bentod.record.tally import Counter

_MARGIN = 1000
"""ns by which the log times of messages may differ from the times in them, which are not rounded."""


class PartReader:
    """One file of a session.

    Raises:
        RecordingError: it cannot be read at all.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        try:
            self.file = McapFile(path)
        except OSError as error:
            raise RecordingError(f"{path} cannot be opened: {error.strerror}.") from error
        try:
            if not self.file.is_mcap():
                raise RecordingError(f"{path} is not an MCAP file.")
            head = self.file.head()
            self.header: Header = read_header(str(path), head.metadata, head.attachments)
        except BaseException:
            self.file.close()
            raise
        self.kinds = {number: TOPICS[topic] for number, topic in head.channels.items() if topic in TOPICS}
        self.damaged: dict[int, str] = {}
        """Sentences, by the place of the chunk that cannot be read."""

    def close(self) -> None:
        """Give the file back."""
        self.file.close()

    @cached_property
    def contents(self) -> Contents:
        """The chunks."""
        return self.file.contents()

    def recorded(
        self, kinds: Collection[type[Recorded]], start: float | None = None, end: float | None = None
    ) -> Iterator[Recorded]:
        """What is of these kinds, from about `start` to about `end` (monotonic s), without damaged chunks."""
        for kind, data in self._messages(kinds, *self._log_times(start, end)):
            yield decode(kind, data)

    def _log_times(self, start: float | None, end: float | None) -> tuple[int, int]:
        low = 0 if start is None else self.header.log_time(start) - _MARGIN
        high = 1 << 64 if end is None else self.header.log_time(end) + _MARGIN
        return low, high

    def _messages(
        self, kinds: Collection[type[Recorded]], low: int = 0, high: int = 1 << 64
    ) -> Iterator[tuple[type[Recorded], bytes]]:
        """Kind and bytes of messages, in the order of recording; `low`, `high`: log times."""
        wanted = {number: kind for number, kind in self.kinds.items() if kind in kinds}
        chunks = (c for c in self.contents.chunks if c.start <= high and c.end >= low and _holds(c, wanted))
        for message in chain.from_iterable(map(self._whole, chunks)):
            if message.channel in wanted and low <= message.time <= high:
                yield wanted[message.channel], message.data

    def _whole(self, chunk: ChunkAt) -> Iterable[Message]:
        try:
            return self.file.messages(chunk)
        except DamagedError as error:
            self.damaged[chunk.offset] = f"{self.path.name}: {error}."
            return ()

    def info(self) -> PartInfo:
        """What there is: from the report at its end, or, without one, by going through everything."""
        survey = _Survey()
        if self.contents.closed:
            survey = self._survey((Report, Mark))
        if not (survey.reports and survey.reports[-1].closing):
            survey = self._survey(TOPICS.values())
            survey.counter.drop(survey.reports[-1].tally.dropped if survey.reports else Counts())
            tally = survey.counter.tally()
        else:
            tally = survey.reports[-1].tally
        ends = [report.text for report in survey.reports if report.closing and report.text]
        return PartInfo(
            path=self.path,
            part=self.header.part,
            bytes=self.file.size,
            closed=self.contents.closed,
            live=not self.contents.closed and is_being_written(self.path),
            lost=self.contents.lost,
            tally=tally,
            marks=tuple(survey.marks),
            problems=(*ends, *self.damaged.values()),
        )

    def _survey(self, kinds: Collection[type[Recorded]]) -> "_Survey":
        found = _Survey()
        for kind, data in self._messages(kinds):
            if kind in KINDS:
                found.counter.add(kind, brief(kind, data))
            elif kind is Report:
                found.reports.append(cast("Report", decode(kind, data)))
            else:
                found.marks.append(cast("Mark", decode(kind, data)))
        return found


@dataclass(slots=True)
class _Survey:
    """What one way through a file brings."""

    counter: Counter = field(default_factory=Counter)
    reports: list[Report] = field(default_factory=list)
    marks: list[Mark] = field(default_factory=list)


def _holds(chunk: ChunkAt, wanted: Collection[int]) -> bool:
    return not chunk.channels or not chunk.channels.isdisjoint(wanted)
