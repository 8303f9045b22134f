"""Reads a session: all its parts as one, lazily, in the order of recording."""

import re
from collections.abc import Collection, Iterator
from functools import cached_property
from pathlib import Path
from types import TracebackType
from typing import Self, TypeVar

from bentod.errors import RecordingError
from bentod.frames import ClientCommand, EmgBlock, Event, Frame
from bentod.record.info import combined
from bentod.record.part_reader import PartReader
from bentod.record.session import KINDS, SUFFIX, Entry, Header, Info

_PART = re.compile(r"(?P<session>.+)\.\d{3,}" + re.escape(SUFFIX))

_Kind = TypeVar("_Kind", Frame, EmgBlock, Event, ClientCommand)


class Recording:
    """A session, from any of its parts or from a folder that holds nothing else. Use it with `with`.

    What is read is what was put, exactly. What cannot be read is left out, and `info` says so.

    Raises:
        RecordingError: there is no recording, or it is of a newer version.
    """

    def __init__(self, path: Path | str, *, alone: bool = False) -> None:
        """`alone`: read this file only, not the other parts of its session."""
        self._alone = alone
        self._problems: list[str] = []
        self._parts: list[PartReader] = []
        files = [Path(path)] if alone else parts_of(Path(path))
        for file in files:
            self._open(file, last=file == files[-1])
        self._parts.sort(key=lambda part: part.header.part)
        self.header: Header = self._parts[0].header

    @property
    def files(self) -> tuple[Path, ...]:
        """The files that are read, in the order of their parts."""
        return tuple(part.path for part in self._parts)

    @cached_property
    def info(self) -> Info:
        """What there is and what is missing. Fast if the files were closed; of others everything is read."""
        parts = [part.info() for part in self._parts]
        expected = () if self._alone else range(1, parts[-1].part + 1)
        return combined(parts, expected, self._problems)

    def entries(
        self,
        start: float | None = None,
        end: float | None = None,
        kinds: Collection[type[Entry]] = KINDS,
    ) -> Iterator[Entry]:
        """What was put, in the order in which it was, from `start` up to, without, `end` (monotonic s)."""
        for part in self._parts:
            for entry in part.recorded(kinds, start, end):
                if isinstance(entry, KINDS) and _within(entry.time, start, end):
                    yield entry

    def frames(self, start: float | None = None, end: float | None = None) -> Iterator[Frame]:
        """The frames of all ticks."""
        return self._only(Frame, start, end)

    def emg(self, start: float | None = None, end: float | None = None) -> Iterator[EmgBlock]:
        """The raw samples; a block counts as of its first one."""
        return self._only(EmgBlock, start, end)

    def events(self, start: float | None = None, end: float | None = None) -> Iterator[Event]:
        """What happened."""
        return self._only(Event, start, end)

    def commands(self, start: float | None = None, end: float | None = None) -> Iterator[ClientCommand]:
        """What clients asked for."""
        return self._only(ClientCommand, start, end)

    def close(self) -> None:
        """Give the files back."""
        for part in self._parts:
            part.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _only(self, kind: type[_Kind], start: float | None, end: float | None) -> Iterator[_Kind]:
        for entry in self.entries(start, end, (kind,)):
            if isinstance(entry, kind):
                yield entry

    def _open(self, file: Path, last: bool) -> None:
        """Open a part. One of several that cannot be read is a problem; if it is all there is, an error."""
        try:
            self._parts.append(PartReader(file))
        except RecordingError as error:
            if last and not self._parts:
                raise
            self._problems.append(str(error))
        except BaseException:
            self.close()
            raise


def parts_of(path: Path) -> list[Path]:
    """The files of a session, in their order: from any of its parts, or from its folder.

    Raises:
        RecordingError: there is none, or the folder has several.
    """
    if path.is_dir():
        return _session_in(path)
    if not path.exists():
        raise RecordingError(f"{path} does not exist.")
    match = _PART.fullmatch(path.name)
    return _session(path.parent, match["session"]) if match else [path]


def _session(folder: Path, session: str) -> list[Path]:
    found = [
        file for file in folder.iterdir() if (m := _PART.fullmatch(file.name)) and m["session"] == session
    ]
    return sorted(found, key=lambda file: (len(file.name), file.name))


def _session_in(folder: Path) -> list[Path]:
    sessions = sorted({m["session"] for file in folder.iterdir() if (m := _PART.fullmatch(file.name))})
    if not sessions:
        raise RecordingError(f"There is no recording in {folder}.")
    if len(sessions) > 1:
        raise RecordingError(
            f"There are {len(sessions)} sessions in {folder}; name a file of the one to read, "
            f"e.g. of the latest: {sessions[-1]}."
        )
    return _session(folder, sessions[0])


def _within(time: float, start: float | None, end: float | None) -> bool:
    return (start is None or time >= start) and (end is None or time < end)
