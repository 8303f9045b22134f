"""Files that are whole or not there: what is written takes its place only once it is on the disk."""

import errno
import os
import re
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO, cast

MODE = 0o640
"""Of files: the owner writes, the group reads; how somebody moves is about a person."""

TEMPORARY = ".new"
"""Ends the name of a file that is still being written; its first letter is a dot."""


@contextmanager
def replacing(path: Path, mode: int = MODE, aside: Path | None = None) -> Iterator[BinaryIO]:
    """A file to be written, which then takes the place of `path`; what stood there goes to `aside`, if given.

    After a power cut every file is whole: `path` is the old one or the new; or, where there is an `aside`, it
    is missing and that is the old one. What is raised while it is written leaves all as it was.

    Raises:
        OSError: the disk does not take it.
    """
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.", suffix=TEMPORARY)
    try:
        with os.fdopen(handle, "wb") as file:
            yield cast("BinaryIO", file)
            file.flush()
            os.fchmod(file.fileno(), mode)
            os.fsync(file.fileno())
        if aside is not None and path.exists():
            os.replace(path, aside)
        os.replace(name, path)
    except BaseException:
        os.unlink(name)
        raise
    sync_folder(path.parent)


def sweep_up(path: Path) -> None:
    """Remove what is left of files that were being written to `path` when the power failed."""
    left = re.compile(rf"\.{re.escape(path.name)}\.\w{{8}}{re.escape(TEMPORARY)}")
    with suppress(OSError), os.scandir(path.parent) as found:
        for entry in found:
            if left.fullmatch(entry.name):
                os.unlink(entry)


def sync_folder(folder: Path) -> None:
    """Have names that changed in `folder` survive a power cut, where the file system can."""
    number = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    try:
        os.fsync(number)
    except OSError as error:
        if error.errno != errno.EINVAL:
            raise
    finally:
        os.close(number)
