"""Frames in which a board sends muscle signals over a serial line: bytes in, frames out.

A frame, whose numbers have their least byte first:

    offset  bytes   what
    0       2       0xA5 0x5A
    2       1       version of this layout, 1
    3       1       channels c, 1 to 32
    4       1       samples n, 1 to 64; at most 256 values in all
    5       4       index of the first sample since the board started, modulo 2^32
    9       2 c n   int16, all channels of the first sample, then of the next
    9+2cn   2       CRC-16/CCITT-FALSE of everything between the first two bytes and this
"""

import binascii
import struct
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

SYNC = b"\xa5\x5a"
VERSION = 1
MOST_CHANNELS = 32
MOST_SAMPLES = 64
MOST_VALUES = 256
"""In one frame: a header that is none holds up what follows for 46 ms at most, at 115 200 baud."""

_HEADER = struct.Struct("<2sBBBI")
_CRC = struct.Struct("<H")


@dataclass(frozen=True, slots=True)
class Frame:
    """Some samples of a board."""

    first: int  # index of the first sample, modulo 2^32
    counts: NDArray[np.int16]  # shape (samples, channels)


def crc16(data: bytes) -> int:
    """CRC-16/CCITT-FALSE: polynomial 0x1021, begun with 0xFFFF, not reflected."""
    return binascii.crc_hqx(data, 0xFFFF)


class Frames:
    """Finds frames among bytes, whatever else is there and however they are cut."""

    def __init__(self) -> None:
        self.skipped = 0
        """Bytes that belonged to no frame."""
        self.version = 0
        """Of the newest header that was of another version, else 0."""
        self._waiting = bytearray()

    def take(self, data: bytes) -> list[Frame]:
        """The frames that `data` completes."""
        self._waiting += data
        found: list[Frame] = []
        while (size := self._size()) is not None and size <= len(self._waiting):
            frame = self._frame(size) if size else None
            if frame:
                found.append(frame)
            else:
                size = 1
                self.skipped += 1
            del self._waiting[:size]
        return found

    def _size(self) -> int | None:
        """Bytes of the frame that begins what is waiting; 0 where none begins, None as long as it may."""
        self._find()
        if len(self._waiting) < _HEADER.size:
            return None
        _, version, channels, samples, _ = _HEADER.unpack_from(self._waiting)
        if version != VERSION:
            self.version = version
            return 0
        values: int = channels * samples
        if not (1 <= channels <= MOST_CHANNELS and 1 <= samples <= MOST_SAMPLES and values <= MOST_VALUES):
            return 0
        return _HEADER.size + 2 * values + _CRC.size

    def _find(self) -> None:
        """Skip what no frame can begin with."""
        begin = self._waiting.find(SYNC)
        if begin < 0:
            begin = len(self._waiting) - self._waiting.endswith(SYNC[:1])
        self.skipped += begin
        del self._waiting[:begin]

    def _frame(self, size: int) -> Frame | None:
        """The frame that begins what is waiting, unless a bit of it is wrong."""
        data = bytes(self._waiting[:size])
        (told,) = _CRC.unpack_from(data, size - _CRC.size)
        if crc16(data[len(SYNC) : -_CRC.size]) != told:
            return None
        _, _, channels, samples, first = _HEADER.unpack_from(data)
        counts = np.frombuffer(data, "<i2", channels * samples, _HEADER.size)
        return Frame(first, counts.reshape(samples, channels).astype(np.int16))
