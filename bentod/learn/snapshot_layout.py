r"""The bytes of a snapshot: what stands where, and the checks that every one of them passes.

Little-endian, without gaps:

    offset  bytes
    0       8      89 47 56 46 0D 0A 1A 0A ("\x89GVF\r\n\x1a\n": what a transfer as text would change)
    8       4      format, unsigned: 1
    12      4      n, unsigned: length of the text
    16      32     SHA-256 of the 16 bytes before it and of the text
    48      n      text, JSON: {"header": …, "arrays": [{"name", "dtype", "shape", "sha256"}, …]}
    48 + n         the arrays' numbers, in the order of the text, row by row; the file ends where they end

"dtype" is what `numpy.dtype` takes, e.g. "<f8": `numpy.fromfile(file, dtype, count)` reads one array.
JSON is as Python writes it: numbers that are not finite are NaN, Infinity and -Infinity.
"""

import hashlib
import json
import math
import struct
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from bentod.errors import SnapshotError
from bentod.frames import Value

Array: TypeAlias = NDArray[np.generic]

FORMAT = 1
"""The newest that is understood."""

MAGIC = b"\x89GVF\r\n\x1a\n"

LONGEST_TEXT = 1 << 26
"""Bytes; twenty thousand questions take some six millions."""

LARGEST = 1 << 33
"""Bytes of a whole file."""

MOST_ARRAYS = 1 << 16
MOST_DIMENSIONS = 8
LONGEST_NAME = 512  # characters
KINDS = ("<f8", "<f4", "<i8", "<i4", "<i2", "|i1", "<u8", "<u4", "<u2", "|u1", "|b1")

PAUSE = 50e-6
"""s in which others may run Python, again and again while a long text is made."""

_RUN = 64  # pieces between two pauses; about twenty questions

_START = struct.Struct("<8sII")
_DIGEST = 32  # bytes
BEGINNING = _START.size + _DIGEST
"""Bytes before the text."""


@dataclass(frozen=True, slots=True)
class Place:
    """One array of a file, before its numbers are read."""

    name: str
    kind: str  # one of `KINDS`
    shape: tuple[int, ...]
    digest: str  # SHA-256 of its numbers, hexadecimal

    @property
    def size(self) -> int:
        """Bytes."""
        return np.dtype(self.kind).itemsize * math.prod(self.shape)


@dataclass(frozen=True, slots=True)
class Beginning:
    """What the first `BEGINNING` bytes say."""

    length: int  # of the text, bytes
    digest: bytes
    start: bytes  # what the digest covers besides the text


def stored(name: str, array: Array) -> Array:
    """`array` as its bytes are written. Raises ValueError: its name or its kind of numbers has no place."""
    if not 0 < len(name) <= LONGEST_NAME:
        raise ValueError(f"An array's name has 1 to {LONGEST_NAME} characters, not {len(name)}.")
    little: Array = array.astype(array.dtype.newbyteorder("<"), order="C", copy=False)
    if little.dtype.str not in KINDS or array.ndim > MOST_DIMENSIONS:
        raise ValueError(
            f"The array '{name}' is of {array.ndim} dimensions of {array.dtype}: "
            f"a snapshot holds up to {MOST_DIMENSIONS} dimensions of numbers."
        )
    return little


def raw(array: Array) -> memoryview:
    """The bytes of an array that `stored` returned, without a copy."""
    return array.reshape(-1).view(np.uint8).data


def beginning(header: Mapping[str, Value], arrays: Mapping[str, Array]) -> Iterator[bytes]:
    """All that stands before the numbers of `arrays` (as `stored` returns them), in two pieces.

    Raises:
        ValueError: there is too much of it, or something in `header` has no form in JSON.
    """
    if len(arrays) > MOST_ARRAYS:
        raise ValueError(f"A snapshot holds up to {MOST_ARRAYS} arrays, not {len(arrays)}.")
    places = [_told(name, array) for name, array in arrays.items()]
    text = "".join(_unhurried(_pieces({"header": dict(header), "arrays": places}, depth=4))).encode()
    if len(text) > LONGEST_TEXT:
        raise ValueError(f"The text of a snapshot is up to {LONGEST_TEXT} bytes long, not {len(text)}.")
    start = _START.pack(MAGIC, FORMAT, len(text))
    yield start + hashlib.sha256(start + text).digest()
    yield text


def _told(name: str, array: Array) -> Value:
    shape: list[Value] = list(array.shape)
    digest = hashlib.sha256(raw(array)).hexdigest()
    return {"name": name, "dtype": array.dtype.str, "shape": shape, "sha256": digest}


def _pieces(value: Value, depth: int) -> Iterator[str]:
    """JSON bit by bit: written in one go, that of thousands of questions would hold up every other thread."""
    if isinstance(value, dict) and depth:
        for mark, (key, item) in zip(_marks("{"), value.items(), strict=False):
            yield f"{mark}{json.dumps(str(key))}: "
            yield from _pieces(item, depth - 1)
        yield "}" if value else "{}"
    elif isinstance(value, list) and depth:
        for mark, item in zip(_marks("["), value, strict=False):
            yield mark
            yield from _pieces(item, depth - 1)
        yield "]" if value else "[]"
    else:
        yield _json(value)


def _unhurried(pieces: Iterator[str]) -> Iterator[str]:
    for place, piece in enumerate(pieces):
        if place % _RUN == _RUN - 1:
            time.sleep(PAUSE)
        yield piece


def _marks(first: str) -> Iterator[str]:
    yield first
    while True:
        yield ", "


def _json(value: Value) -> str:
    try:
        return json.dumps(value)
    except (TypeError, RecursionError) as error:
        raise ValueError(f"The header of a snapshot cannot hold this: {error}.") from error


def begun(data: bytes) -> Beginning:
    """What the first bytes of a file say. Raises SnapshotError: they are not those of a snapshot."""
    if data[: len(MAGIC)] != MAGIC[: len(data)] or not data:
        raise SnapshotError("this is no snapshot: it does not begin as one does")
    if len(data) < BEGINNING:
        raise SnapshotError(f"it is cut off after {len(data)} bytes, before its header")
    _, version, length = _START.unpack_from(data)
    if version > FORMAT:
        raise SnapshotError(f"it is of format {version}; this bentod reads up to {FORMAT}")
    if version < 1 or length > LONGEST_TEXT:
        raise SnapshotError(f"its first bytes are damaged: format {version}, {length} bytes of text")
    return Beginning(length, data[_START.size : BEGINNING], data[: _START.size])


def understood(first: Beginning, text: bytes, rest: int) -> tuple[dict[str, Value], list[Place]]:
    """Header and arrays, from the text and the number of bytes that follow it.

    Raises:
        SnapshotError: a byte of them has changed, the arrays are not what follows, or cannot be that large.
    """
    if hashlib.sha256(first.start + text).digest() != first.digest:
        raise SnapshotError("its header is damaged: the checksum does not match")
    try:
        told = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise SnapshotError(f"its header is not valid JSON: {error}") from error
    header = told.get("header") if isinstance(told, dict) else None
    arrays = told.get("arrays") if isinstance(told, dict) else None
    if not isinstance(header, dict) or not isinstance(arrays, list) or len(arrays) > MOST_ARRAYS:
        raise SnapshotError("its header holds something else than a header and a list of arrays")
    places = [_place(entry) for entry in arrays]
    if len({place.name for place in places}) < len(places):
        raise SnapshotError("its header names an array twice")
    _must_fit(places, rest)
    return header, places


def _place(entry: Value) -> Place:
    told = entry if isinstance(entry, dict) else {}
    name, kind, shape, digest = (told.get(key) for key in ("name", "dtype", "shape", "sha256"))
    if not isinstance(name, str) or kind not in KINDS or not isinstance(digest, str):
        raise SnapshotError(f"its header describes an array that cannot be: {str(entry)[:100]}")
    return Place(name, str(kind), _shape(name, shape), digest)


def _shape(name: str, shape: Value) -> tuple[int, ...]:
    lengths = [length for length in shape if type(length) is int] if isinstance(shape, list) else []
    possible = isinstance(shape, list) and len(lengths) == len(shape) <= MOST_DIMENSIONS
    if not possible or min(lengths, default=0) < 0 or math.prod(max(n, 1) for n in lengths) > LARGEST:
        raise SnapshotError(f"its array '{name[:100]}' cannot have the shape {str(shape)[:100]}")
    return tuple(lengths)


def _must_fit(places: Sequence[Place], rest: int) -> None:
    expected = sum(place.size for place in places)
    if rest < expected:
        raise SnapshotError(f"it is cut off: {expected - rest} of {expected} bytes of its arrays are missing")
    if rest > expected:
        raise SnapshotError(f"{rest - expected} bytes follow its end")
