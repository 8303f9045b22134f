"""Reads MCAP files of which any part may be missing: what a killed process or a power cut left behind."""

import os
import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from types import TracebackType
from typing import NamedTuple, Self

import zstandard
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Attachment, Channel, Chunk, Metadata

from bentod.record.container import MAGIC, MESSAGE

FOOTER = 9 + 20 + len(MAGIC)
"""Bytes from the footer to the end of the file."""

LARGEST = 1 << 26
"""Bytes of a chunk, uncompressed; one that says it is larger is damaged."""

_RECORD = struct.Struct("<BQ")
_TIMES = struct.Struct("<QQ")
_INDEX = struct.Struct("<QQQQI")
_PLACE = struct.Struct("<HQ")


class DamagedError(Exception):
    """A chunk is not what was written: its checksum or its compression is wrong."""


@dataclass(frozen=True, slots=True)
class Raw:
    """A whole record in a file."""

    opcode: int
    offset: int
    length: int  # with its opcode and length


@dataclass(frozen=True, slots=True)
class ChunkAt:
    """A chunk in a file."""

    offset: int
    length: int
    start: int  # log time of its first message, ns since the epoch
    end: int
    channels: frozenset[int]


@dataclass(frozen=True, slots=True)
class Head:
    """What stands before the first chunk."""

    metadata: dict[str, dict[str, str]]
    attachments: dict[str, bytes]
    channels: dict[int, str]  # topics


@dataclass(frozen=True, slots=True)
class Contents:
    """What is in a file."""

    chunks: tuple[ChunkAt, ...]
    closed: bool  # it has its index
    lost: int  # bytes at the end that are no whole record


class Message(NamedTuple):
    """One message of a chunk."""

    channel: int
    sequence: int
    time: int  # ns since the epoch
    data: bytes
    offset: int  # in the uncompressed chunk


class McapFile:
    """One file, open for reading. Nothing of it is kept in memory."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._number = os.open(path, os.O_RDONLY | os.O_CLOEXEC)
        self.size = os.fstat(self._number).st_size

    def close(self) -> None:
        """Give the file back."""
        number, self._number = self._number, -1
        if number >= 0:
            os.close(number)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def is_mcap(self) -> bool:
        """Whether it begins as such a file does."""
        return self._read(0, len(MAGIC)) == MAGIC

    def records(self, start: int = len(MAGIC)) -> Iterator[Raw]:
        """The records from `start` on, until one is not whole."""
        at = start
        while at + _RECORD.size <= self.size:
            opcode, length = _RECORD.unpack(self._read(at, _RECORD.size))
            if opcode == 0 or at + _RECORD.size + length > self.size:
                return
            yield Raw(opcode, at, _RECORD.size + length)
            at += _RECORD.size + length

    def head(self) -> Head:
        """What stands before the first chunk, as far as it is there."""
        head = Head({}, {}, {})
        for record in self.head_records():
            _note(head, record.opcode, self._body(record))
        return head

    def head_records(self) -> Iterator[Raw]:
        """The records before the first chunk."""
        for record in self.records():
            if record.opcode in (Opcode.CHUNK, Opcode.DATA_END):
                return
            yield record

    def contents(self) -> Contents:
        """The chunks: from the index at the end of the file, or by going through it."""
        start = self._summary()
        if not start:
            return self._scanned()
        chunks = [
            self._indexed(record) for record in self.records(start) if record.opcode == Opcode.CHUNK_INDEX
        ]
        return Contents(tuple(chunks), closed=True, lost=0)

    def raw(self, record: "ChunkAt | Raw") -> bytes:
        """The bytes of a record."""
        return self._read(record.offset, record.length)

    def chunk(self, chunk: ChunkAt) -> Chunk:
        """A chunk, still compressed."""
        found: Chunk = Chunk.read(_stream(self.raw(chunk)[_RECORD.size :]))
        return found

    def messages(self, chunk: ChunkAt) -> Iterator[Message]:
        """The messages of a chunk, in the order in which they were written.

        Raises:
            DamagedError: it is not what was written.
        """
        try:
            plain = _unpacked(self.chunk(chunk))
        except (DamagedError, zstandard.ZstdError, McapError, UnicodeDecodeError, MemoryError) as error:
            raise DamagedError(f"the chunk at byte {chunk.offset} is damaged: {error}") from error
        return _messages(plain)

    def _scanned(self) -> Contents:
        chunks: list[ChunkAt] = []
        end, closed = len(MAGIC), False
        for record in self.records():
            end = record.offset + record.length
            if record.opcode == Opcode.CHUNK:
                start, last = _TIMES.unpack(self._read(record.offset + _RECORD.size, _TIMES.size))
                chunks.append(ChunkAt(record.offset, record.length, start, last, frozenset()))
            elif record.opcode == Opcode.DATA_END:
                break
        return Contents(tuple(chunks), closed, self.size - end)

    def _summary(self) -> int:
        """Where the index begins; 0 if there is none that can be trusted."""
        tail = self._read(max(self.size - FOOTER, 0), FOOTER)
        if len(tail) < FOOTER or tail[0] != Opcode.FOOTER or not tail.endswith(MAGIC):
            return 0
        start, _, crc = struct.unpack_from("<QQI", tail, 9)
        if not 0 < start < self.size:
            return 0
        covered = self._read(start, self.size - FOOTER - start + 25)
        return start if zlib.crc32(covered) == crc else 0

    def _indexed(self, record: Raw) -> ChunkAt:
        body = self._body(record)
        start, end, offset, length, size = _INDEX.unpack_from(body)
        places = _PLACE.iter_unpack(body[_INDEX.size : _INDEX.size + size])
        return ChunkAt(offset, length, start, end, frozenset(channel for channel, _ in places))

    def _body(self, record: Raw) -> bytes:
        return self._read(record.offset + _RECORD.size, record.length - _RECORD.size)

    def _read(self, offset: int, length: int) -> bytes:
        return os.pread(self._number, length, offset)


def _note(head: Head, opcode: int, body: bytes) -> None:
    stream = _stream(body)
    if opcode == Opcode.METADATA:
        metadata = Metadata.read(stream)
        head.metadata[metadata.name] = metadata.metadata
    elif opcode == Opcode.ATTACHMENT:
        attachment = Attachment.read(stream)
        head.attachments[attachment.name] = attachment.data
    elif opcode == Opcode.CHANNEL:
        channel = Channel.read(stream)
        head.channels[channel.id] = channel.topic


def _stream(body: bytes) -> ReadDataStream:
    return ReadDataStream(BytesIO(body))


def _unpacked(chunk: Chunk) -> bytes:
    if chunk.compression not in ("", "zstd"):
        raise DamagedError(f"it is compressed with '{chunk.compression}', which we never use")
    if chunk.uncompressed_size > LARGEST:
        raise DamagedError(f"it says that it has {chunk.uncompressed_size} bytes; {LARGEST} is the bound")
    plain = (
        zstandard.ZstdDecompressor().decompress(chunk.data, chunk.uncompressed_size)
        if chunk.compression
        else chunk.data
    )
    if zlib.crc32(plain) != chunk.uncompressed_crc:
        raise DamagedError("its checksum is wrong")
    return plain


def _messages(plain: bytes) -> Iterator[Message]:
    at = 0
    while at < len(plain):
        opcode, length = _RECORD.unpack_from(plain, at)
        end = at + _RECORD.size + length
        if opcode == Opcode.MESSAGE:
            _, _, channel, sequence, time, _ = MESSAGE.unpack_from(plain, at)
            yield Message(channel, sequence, time, plain[at + MESSAGE.size : end], at)
        at = end
