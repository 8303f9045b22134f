"""A board behind a pseudo-terminal, as a thread of the tests."""

import os
import pty
import struct
import threading
import time
import tty
from contextlib import suppress
from pathlib import Path

import numpy as np

RATE_HZ = 500.0
SIZE = 5  # samples in a frame


def checksum(data: bytes) -> int:
    """CRC-16/CCITT-FALSE, as the sketch in the docs computes it."""
    crc = 0xFFFF
    for byte in data:
        crc ^= byte << 8
        for _ in range(8):
            crc = ((crc << 1) ^ 0x1021 if crc & 0x8000 else crc << 1) & 0xFFFF
    return crc


class Board:
    """Sends counts up in channel 0, and down in channel 1, at a port that `link` leads to."""

    def __init__(self, link: Path) -> None:
        self._link = link
        self._thread: threading.Thread | None = None
        self._pulled = threading.Event()

    def plug(self) -> None:
        """Start it anew, at another port behind the same link."""
        far, near = pty.openpty()
        tty.setraw(near)
        self._link.unlink(missing_ok=True)
        self._link.symlink_to(os.ttyname(near))
        self._pulled = threading.Event()
        self._thread = threading.Thread(target=self._send, args=(far, near))
        self._thread.start()

    def unplug(self) -> None:
        """Pull the cable; idempotent."""
        self._pulled.set()
        if self._thread:
            self._thread.join()
        self._link.unlink(missing_ok=True)

    def _send(self, far: int, near: int) -> None:
        os.set_blocking(far, False)
        begun, index = time.monotonic(), 0
        while not self._pulled.wait(max(0.0, begun + (index + SIZE) / RATE_HZ - time.monotonic())):
            counts = np.arange(index, index + SIZE) % 1000
            table = np.column_stack((counts, -counts)).astype("<i2")
            body = struct.pack("<BBBI", 1, 2, SIZE, index) + table.tobytes()
            with suppress(BlockingIOError):  # nobody reads
                os.write(far, b"\xa5\x5a" + body + struct.pack("<H", checksum(body)))
            index += SIZE
        os.close(far)
        os.close(near)
