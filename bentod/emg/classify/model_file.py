r"""A model as one file that is whole or refused.

    offset  bytes
    0       8      89 45 4D 47 0D 0A 1A 0A ("\x89EMG\r\n\x1a\n": what a transfer as text would change)
    8       32     SHA-256 of all that follows
    40             an archive as `numpy.savez` writes it, without pickles: "header", JSON in UTF-8 as an array
                   of bytes, and the classifier's arrays

The same model makes the same bytes.
"""

import hashlib
from io import BytesIO
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from bentod.emg.classify import model_header
from bentod.emg.classify.model import Model
from bentod.errors import BentodError, SnapshotError
from bentod.whole_file import replacing

MAGIC = b"\x89EMG\r\n\x1a\n"
_START = len(MAGIC) + hashlib.sha256().digest_size

LARGEST = 1 << 30
"""Bytes of a whole file; the nearest neighbours keep every training row."""

_OWN = "classifier."
"""Begins the names of the classifier's arrays in the archive."""


def content(model: Model) -> bytes:
    """The bytes of a model's file. Raises ValueError: something in its specification has no form in JSON."""
    arrays: dict[str, NDArray[np.generic]] = {
        "header": np.frombuffer(model_header.written(model).encode(), np.uint8)
    }
    arrays |= {_OWN + name: array for name, array in sorted(model.classifier.arrays().items())}
    archive = BytesIO()
    np.savez(archive, allow_pickle=False, **arrays)
    body = archive.getvalue()
    return MAGIC + hashlib.sha256(body).digest() + body


def write(path: Path, model: Model) -> int:
    """Put a model in the place of `path`; what stood there stays until all is written. Returns its bytes.

    Raises:
        OSError: the disk does not take it.
    """
    data = content(model)
    path.parent.mkdir(parents=True, exist_ok=True)
    with replacing(path) as file:
        file.write(data)
    return len(data)


def read(path: Path) -> Model:
    """The model in `path`.

    Raises:
        SnapshotError: it cannot be read, is not whole, or is of features or a classifier that are not here.
    """
    try:
        with path.open("rb") as file:
            data = file.read(LARGEST + 1)
        return understood(data)
    except OSError as error:
        raise SnapshotError(f"{path}: cannot be read: {error.strerror or error}") from error
    except BentodError as error:
        raise SnapshotError(f"{path}: {error}") from error


def understood(data: bytes) -> Model:
    """The model that a file of these bytes holds. Raises BentodError: it is none that can be used here."""
    if data[: len(MAGIC)] != MAGIC:
        raise SnapshotError("this is no model of muscle signals: it does not begin as one does")
    if len(data) > LARGEST:
        raise SnapshotError(f"it is longer than {LARGEST} bytes")
    body = data[_START:]
    if hashlib.sha256(body).digest() != data[len(MAGIC) : _START]:
        raise SnapshotError("it is cut off or damaged: the checksum does not match")
    try:
        with np.load(BytesIO(body), allow_pickle=False) as archive:
            arrays = {name: archive[name] for name in archive.files}
    except Exception as error:
        # NumPy, zipfile and zlib raise whatever occurs to them about a file that somebody else has made.
        raise SnapshotError(f"what it holds is no archive of arrays: {error}") from error
    header = model_header.understood(arrays.pop("header", np.empty(0, np.uint8)).tobytes())
    own = {name.removeprefix(_OWN): array for name, array in arrays.items()}
    return model_header.model(header, own)
