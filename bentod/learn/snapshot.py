"""All that was learned and the exact questions that it answers, as one file that is whole or refused."""

import hashlib
import os
import stat
from collections.abc import Mapping
from dataclasses import dataclass, field
from importlib.metadata import version
from io import BytesIO, FileIO
from pathlib import Path
from typing import Protocol, cast

import numpy as np
from numpy.typing import NDArray

from bentod.errors import SnapshotError
from bentod.frames import Value
from bentod.learn import snapshot_layout as layout
from bentod.learn.snapshot_layout import Array, Place
from bentod.whole_file import replacing

FOLDER_MODE = 0o750

_VERSION = version("bentod")


class Keepable(Protocol):
    """What learns, and can be kept from session to session."""

    def spec(self) -> Mapping[str, Value]:
        """What is asked and what it is learned from; "questions" and "representations" have names."""
        ...

    def memory(self) -> Mapping[str, NDArray[np.float64]]:
        """Copies of all that was learned."""
        ...

    def recall(self, spec: Mapping[str, Value], memory: Mapping[str, NDArray[np.float64]]) -> list[str]:
        """Go on with what `memory` told where it is of `spec`; returns questions that begin anew.

        Raises:
            SnapshotError: nothing of it can be gone on with, and the sentence says why.
        """
        ...


@dataclass(frozen=True, slots=True)
class Snapshot:
    """What was learned up to a moment. Nobody may change its arrays."""

    header: Mapping[str, Value]
    arrays: Mapping[str, Array]
    digest: str = field(default="", compare=False)  # of header and all arrays, hexadecimal; empty until read

    @property
    def spec(self) -> Mapping[str, Value]:
        """What the learners were asked; empty if the header does not say."""
        spec = self.header.get("spec")
        return spec if isinstance(spec, dict) else {}

    def give(self, learners: Keepable) -> list[str]:
        """Have `learners` go on with what was kept; see `Keepable.recall`."""
        arrays = cast("Mapping[str, NDArray[np.float64]]", self.arrays)  # they are as `memory` gave them
        return learners.recall(self.spec, arrays)


def taken(learners: Keepable, arm: str, wall: float, tick: int) -> Snapshot:
    """What `learners` know now, for keeping. `wall`: s since the epoch."""
    about: dict[str, Value] = {"arm": arm, "wall": wall, "tick": tick, "bentod": _VERSION}
    return Snapshot({**about, "spec": dict(learners.spec())}, dict(learners.memory()))


def write(path: Path, snapshot: Snapshot, aside: Path | None = None) -> int:
    """Put a snapshot in the place of `path`, and what stood there in that of `aside`. Returns its bytes.

    After a power cut every file is whole: `path` is the old one or the new; or it is missing, and the old one
    is `aside`.

    Raises:
        OSError: the disk does not take it; what was there stays.
        ValueError: something in it has no place in a snapshot.
    """
    arrays = {name: layout.stored(name, array) for name, array in snapshot.arrays.items()}
    parts = layout.beginning(snapshot.header, arrays)
    path.parent.mkdir(mode=FOLDER_MODE, parents=True, exist_ok=True)
    with replacing(path, aside=aside) as file:
        for part in parts:
            file.write(part)
        for array in arrays.values():
            file.write(layout.raw(array))
        size = file.tell()
    return size


def read(path: Path) -> Snapshot:
    """The snapshot in `path`, every byte of it checked.

    Raises:
        SnapshotError: it cannot be read, or is not whole; the sentence says what is wrong.
    """
    try:
        with open(path, "rb", buffering=0, opener=_patiently) as file:
            return _read(file)
    except OSError as error:
        raise SnapshotError(f"{path}: cannot be read: {error.strerror or error}") from error
    except MemoryError as error:
        raise SnapshotError(f"{path}: does not fit into memory") from error
    except SnapshotError as error:
        raise SnapshotError(f"{path}: {error}") from error


def parsed(data: bytes) -> Snapshot:
    """The snapshot that a file of these bytes holds. Raises SnapshotError: it is none, or not whole."""
    return _understood(BytesIO(data), len(data))


def _patiently(path: str, flags: int) -> int:
    return os.open(path, flags | os.O_CLOEXEC | os.O_NONBLOCK)  # a pipe in its place keeps nobody waiting


def _read(file: FileIO) -> Snapshot:
    found = os.fstat(file.fileno())
    if not stat.S_ISREG(found.st_mode):
        raise SnapshotError("is not a file")
    if found.st_size > layout.LARGEST:
        raise SnapshotError(f"is {found.st_size} bytes long; a snapshot has up to {layout.LARGEST}")
    return _understood(file, found.st_size)


def _understood(file: FileIO | BytesIO, size: int) -> Snapshot:
    first = layout.begun(_bytes(file, min(size, layout.BEGINNING)))
    if (rest := size - layout.BEGINNING - first.length) < 0:
        raise SnapshotError(f"it is cut off: {-rest} of {first.length} bytes of its header are missing")
    header, places = layout.understood(first, _bytes(file, first.length), rest)
    return Snapshot(header, {place.name: _array(file, place) for place in places}, first.digest.hex())


def _array(file: FileIO | BytesIO, place: Place) -> Array:
    array: Array = np.empty(place.shape, np.dtype(place.kind))
    _fill(file, layout.raw(array))
    if hashlib.sha256(layout.raw(array)).hexdigest() != place.digest:
        raise SnapshotError(f"its array '{place.name[:100]}' is damaged: the checksum does not match")
    return array


def _bytes(file: FileIO | BytesIO, size: int) -> bytes:
    data = bytearray(size)
    _fill(file, memoryview(data))
    return bytes(data)


def _fill(file: FileIO | BytesIO, room: memoryview) -> None:
    while room:
        if not (count := file.readinto(room)):
            raise SnapshotError(f"it became {len(room)} bytes shorter while it was read")
        room = room[count:]
