"""The folder of recordings: files that are made once and only appended to, and how much room is left."""

import fcntl
import os
import time
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from bentod.record.container import Sink
from bentod.record.session import SUFFIX
from bentod.whole_file import sync_folder

MODE = 0o640
"""Of files: the owner writes, the group reads; a recording is about a person."""

FOLDER_MODE = 0o750

GB = 1e9


@dataclass(frozen=True, slots=True)
class Budget:
    """What recordings may use."""

    folder: float  # bytes, all recordings in the folder together
    free: float  # bytes that stay free on the disk


class Disk(Protocol):
    """What the recorder writes to. Calls raise OSError, and may take as long as they like."""

    def create(self, name: str) -> Sink:
        """A new file; it is an error if there is one of this name."""
        ...

    def path(self, name: str) -> Path:
        """Where that file is."""
        ...

    def used(self) -> int:
        """Bytes of all recordings in the folder."""
        ...

    def free(self) -> int:
        """Bytes that the disk has left for us."""
        ...


class Folder:
    """A folder on a real disk; it is made when the first file is."""

    def __init__(self, path: Path) -> None:
        self._path = path

    def create(self, name: str) -> Sink:
        """A new file, locked while it is written."""
        self._path.mkdir(mode=FOLDER_MODE, parents=True, exist_ok=True)
        return File(self.path(name))

    def path(self, name: str) -> Path:
        """Where that file is."""
        return self._path / name

    def used(self) -> int:
        """Bytes of all recordings in the folder."""
        return sum(_sizes(self._path)) if self._path.is_dir() else 0

    def free(self) -> int:
        """Bytes that the disk has left for us."""
        there = next(folder for folder in (self._path, *self._path.absolute().parents) if folder.exists())
        found = os.statvfs(there)
        return found.f_bavail * found.f_frsize


class File:
    """One file that is appended to."""

    def __init__(self, path: Path) -> None:
        flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC | os.O_NOFOLLOW
        self._number = os.open(path, flags, MODE)
        os.fchmod(self._number, MODE)  # whatever the umask
        with suppress(OSError):  # some file systems know no locks
            fcntl.flock(self._number, fcntl.LOCK_EX | fcntl.LOCK_NB)
        sync_folder(path.parent)

    def write(self, data: bytes) -> None:
        """Append all of `data`, in as many pieces as the system wants."""
        left = memoryview(data)
        while left:
            left = left[os.write(self._number, left) :]

    def sync(self) -> None:
        """Have the disk take it."""
        os.fsync(self._number)

    def close(self) -> None:
        """Give the file back, and its lock."""
        number, self._number = self._number, -1
        if number >= 0:
            os.close(number)


def is_being_written(path: Path) -> bool:
    """Whether a recorder has this file open."""
    number = os.open(path, os.O_RDONLY | os.O_CLOEXEC)
    try:
        fcntl.flock(number, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    except OSError:  # this file system knows no locks
        return False
    finally:
        os.close(number)
    return False


def _sizes(folder: Path) -> Iterator[int]:
    with os.scandir(folder) as found:
        for entry in found:
            if entry.name.endswith(SUFFIX) and entry.is_file(follow_symlinks=False):
                yield entry.stat(follow_symlinks=False).st_size


def default_folder(environment: Mapping[str, str]) -> Path:
    """Where recordings go if the config does not say: systemd's state directory, or the user's."""
    if service := environment.get("STATE_DIRECTORY"):
        return Path(service.split(":")[0]) / "recordings"
    if state := environment.get("XDG_STATE_HOME"):
        return Path(state) / "bentod" / "recordings"
    return Path(environment.get("HOME", "/tmp")) / ".local/state/bentod/recordings"  # noqa: S108


def session_name(wall: float, chance: int) -> str:
    """The name of a session that starts at `wall` (s since the epoch): its time in UTC and some chance."""
    return f"{time.strftime('%Y-%m-%dT%H-%M-%SZ', time.gmtime(wall))}-{chance & 0xFFFF:04x}"


def part_name(session: str, part: int) -> str:
    """The name of one part's file; parts stand in their order in a listing."""
    return f"{session}.{part:03d}{SUFFIX}"
