"""Byte streams: what a bus needs of a serial port, and the port itself."""

from collections.abc import Callable
from typing import Protocol


class ByteStream(Protocol):
    """A line that carries bytes both ways and never blocks."""

    def listen(self, on_bytes: Callable[[bytes], None], on_lost: Callable[[str], None]) -> None:
        """Call `on_bytes` with what arrives, and `on_lost` once, with a sentence, when the line is gone."""
        ...

    def write(self, data: bytes) -> None:
        """Hand `data` to the line.

        Raises:
            BusError: the line is gone.
        """
        ...

    def close(self) -> None:
        """Give the line back; idempotent."""
        ...
