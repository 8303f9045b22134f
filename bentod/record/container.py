"""Writes MCAP: messages in compressed chunks, an index at the end. The format: https://mcap.dev/spec.

Schemas and channels stand before the first chunk, so that a file that was cut off anywhere explains itself.
A chunk and its indexes are written by one call. What the end of the file needs of a chunk is packed when the
chunk is written: so a file of an hour is ended as fast as one of a second, and no tick waits for it.
"""

import struct
import zlib
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from io import BytesIO
from typing import Protocol

import zstandard
from mcap.data_stream import ReadDataStream, RecordBuilder
from mcap.opcode import Opcode
from mcap.records import (
    Attachment,
    AttachmentIndex,
    Channel,
    Chunk,
    ChunkIndex,
    DataEnd,
    Footer,
    Header,
    McapRecord,
    Metadata,
    MetadataIndex,
    Schema,
    Statistics,
    SummaryOffset,
)

MAGIC = b"\x89MCAP0\r\n"

MESSAGE = struct.Struct("<BQHIQQ")
"""Opcode, length, channel, sequence, log time, publish time; the data follow."""

CHUNK_BYTES = 1 << 20
"""A chunk that has grown to this size, uncompressed, should be ended."""

_OWN = 22  # bytes of a message record besides its data and its first nine
_LEVEL = 3  # of zstd: 9 saves 2 % and takes three times as long

_FOOTER_CRC = struct.Struct("<BQQQ")


class Sink(Protocol):
    """Where bytes go. A call that fails raises OSError."""

    def write(self, data: bytes) -> None:
        """Append all of `data`."""
        ...

    def sync(self) -> None:
        """Return when the disk itself has everything that was written."""
        ...

    def close(self) -> None:
        """Give it up; nothing is written after."""
        ...


class Container:
    """One MCAP file that is being written. Whatever the sink raises comes through, and ends the file."""

    def __init__(self, sink: Sink, library: str) -> None:
        self.size = 0
        """Bytes written."""
        self._sink = sink
        self._compressor = zstandard.ZstdCompressor(level=_LEVEL)
        self._schemas: list[Schema] = []
        self._channels: list[Channel] = []
        self._counts: dict[int, int] = defaultdict(int)
        self._indexes: dict[Opcode, list[bytes]] = defaultdict(list)
        self._first, self._last = 0, 0
        self._pieces: list[bytes] = []
        self._length = 0
        self._offsets: dict[int, list[int]] = defaultdict(list)
        self._times: list[int] = []
        self._write(MAGIC + _bytes(Header("", library)))

    @property
    def waiting(self) -> int:
        """Bytes in the chunk that is not written yet."""
        return self._length

    @property
    def covers(self) -> int:
        """Time from the earliest message of that chunk to its latest (ns)."""
        return self._times[1] - self._times[0] if self._times else 0

    def describe(
        self, schemas: Mapping[str, bytes], channels: Iterable[tuple[str, str, Mapping[str, str]]]
    ) -> None:
        """Name each message with its descriptors, and each topic with its message and notes."""
        numbers = {name: number for number, name in enumerate(schemas, 1)}
        self._schemas = [Schema(numbers[name], data, "protobuf", name) for name, data in schemas.items()]
        self._channels = [
            Channel(number, topic, "protobuf", dict(notes), numbers[name])
            for number, (topic, name, notes) in enumerate(channels, 1)
        ]
        self._write(_all(self._schemas) + _all(self._channels))

    def metadata(self, name: str, table: Mapping[str, str]) -> None:
        """A table of texts."""
        data = _bytes(Metadata(name, dict(table)))
        self._indexes[Opcode.METADATA_INDEX].append(_bytes(MetadataIndex(self.size, len(data), name)))
        self._write(data)

    def attachment(self, name: str, media_type: str, content: bytes, time: int) -> None:
        """A file; `time`: ns since the epoch."""
        data = _bytes(Attachment(time, time, name, media_type, content))
        index = AttachmentIndex(self.size, len(data), time, time, len(content), name, media_type)
        self._indexes[Opcode.ATTACHMENT_INDEX].append(_bytes(index))
        self._write(data)

    def copy(self, record: bytes) -> None:
        """A whole record of another file that stands before its chunks."""
        stream, start, length = ReadDataStream(BytesIO(record[9:])), self.size, len(record)
        match record[0]:
            case Opcode.SCHEMA:
                self._schemas.append(Schema.read(stream))
            case Opcode.CHANNEL:
                self._channels.append(Channel.read(stream))
            case Opcode.METADATA:
                name = Metadata.read(stream).name
                self._indexes[Opcode.METADATA_INDEX].append(_bytes(MetadataIndex(start, length, name)))
            case Opcode.ATTACHMENT:
                found = Attachment.read(stream)
                index = AttachmentIndex(
                    start,
                    length,
                    found.log_time,
                    found.create_time,
                    len(found.data),
                    found.name,
                    found.media_type,
                )
                self._indexes[Opcode.ATTACHMENT_INDEX].append(_bytes(index))
            case _:
                return
        self._write(record)

    def message(self, channel: int, sequence: int, time: int, data: bytes) -> None:
        """A message into the chunk that is open; `time`: ns since the epoch."""
        self._offsets[channel] += (time, self._length)
        self._pieces += (MESSAGE.pack(5, _OWN + len(data), channel, sequence & 0xFFFFFFFF, time, time), data)
        self._length += MESSAGE.size + len(data)
        if not self._times:
            self._times = [time, time]
        elif time < self._times[0]:
            self._times[0] = time
        elif time > self._times[1]:
            self._times[1] = time

    def flush(self) -> None:
        """Write the chunk that is open, if anything is in it."""
        if not self._pieces:
            return
        plain = b"".join(self._pieces)
        start, end = self._times
        packed = self._compressor.compress(plain)  # this and the checksum let others run Python
        chunk = Chunk("zstd", packed, end, start, zlib.crc32(plain), len(plain))
        self.chunk(_bytes(chunk), chunk, self._offsets)
        self._reset()

    def chunk(self, record: bytes, chunk: Chunk, offsets: Mapping[int, Sequence[int]]) -> None:
        """Write a whole chunk: its record, and the times and offsets of its messages by channel."""
        start = self.size
        parts, places = [record], {}
        at = start + len(record)
        for channel, flat in offsets.items():
            places[channel] = at
            parts.append(
                struct.pack(f"<BQHI{len(flat)}Q", 7, 6 + 8 * len(flat), channel, 8 * len(flat), *flat)
            )
            at += len(parts[-1])
            self._counts[channel] += len(flat) // 2
        self._write(b"".join(parts))
        self._first = min(self._first or chunk.message_start_time, chunk.message_start_time)
        self._last = max(self._last, chunk.message_end_time)
        index = ChunkIndex(
            chunk_length=len(record),
            chunk_start_offset=start,
            compression=chunk.compression,
            compressed_size=len(chunk.data),
            message_end_time=chunk.message_end_time,
            message_index_length=at - start - len(record),
            message_index_offsets=places,
            message_start_time=chunk.message_start_time,
            uncompressed_size=chunk.uncompressed_size,
        )
        self._indexes[Opcode.CHUNK_INDEX].append(_bytes(index))

    def finish(self) -> None:
        """Write what is left, and the index. The file is then whole."""
        self.flush()
        self._write(_bytes(DataEnd(0)))
        groups = {
            Opcode.SCHEMA: _all(self._schemas),
            Opcode.CHANNEL: _all(self._channels),
            Opcode.STATISTICS: _bytes(self._statistics()),
            **{opcode: b"".join(records) for opcode, records in self._indexes.items() if records},
        }
        start = at = self.size
        offsets = b""
        for opcode, group in groups.items():
            offsets += _bytes(SummaryOffset(opcode, at, len(group)))
            at += len(group)
        summary = b"".join(groups.values())
        crc = zlib.crc32(offsets, zlib.crc32(summary))
        crc = zlib.crc32(_FOOTER_CRC.pack(Opcode.FOOTER, 20, start, at), crc)
        self._write(summary + offsets + _bytes(Footer(start, at, crc)) + MAGIC)

    def _statistics(self) -> Statistics:
        return Statistics(
            attachment_count=len(self._indexes[Opcode.ATTACHMENT_INDEX]),
            channel_count=len(self._channels),
            channel_message_counts=dict(self._counts),
            chunk_count=len(self._indexes[Opcode.CHUNK_INDEX]),
            message_count=sum(self._counts.values()),
            message_end_time=self._last,
            message_start_time=self._first,
            metadata_count=len(self._indexes[Opcode.METADATA_INDEX]),
            schema_count=len(self._schemas),
        )

    def _reset(self) -> None:
        self._pieces = []
        self._length = 0
        self._offsets = defaultdict(list)
        self._times = []

    def _write(self, data: bytes) -> None:
        self._sink.write(data)
        self.size += len(data)


def _bytes(record: McapRecord) -> bytes:
    builder = RecordBuilder()
    record.write(builder)
    return bytes(builder.end())  # type: ignore[no-untyped-call]


def _all(records: Sequence[McapRecord]) -> bytes:
    return b"".join([_bytes(record) for record in records])
