"""Byte streams: what a bus needs of a serial port, and the port itself."""

import asyncio
import errno
import logging
import os
import termios
from collections.abc import Callable
from typing import Protocol

import serial

from bentod.errors import BusError

log = logging.getLogger(__name__)

CHUNK = 4096
"""bytes: more than a bus of servos can have under way."""

ADVICE = {
    errno.ENOENT: "there is no such port; is the adapter plugged in?",
    errno.ENXIO: "there is no device behind it; is the adapter plugged in?",
    errno.ENODEV: "there is no device behind it; is the adapter plugged in?",
    errno.EACCES: "access is denied; add the user to the group that owns the port, often dialout",
    errno.EPERM: "access is denied; add the user to the group that owns the port, often dialout",
    errno.EBUSY: "another program holds it; close that program",
    errno.EAGAIN: "another program holds it; close that program",
    errno.ENOTTY: "it is not a serial port",
    errno.EINVAL: "it does not take these settings, perhaps not this baud rate",
    errno.EIO: "the line hung up; was the adapter unplugged?",
    errno.EBADF: "it was closed",
}
"""What errors of the system, pyserial and termios mean for a person; the one table of that kind."""

FOREIGN = (OSError, termios.error, ValueError, OverflowError, NotImplementedError)
"""What opening, configuring, reading and writing a port raise; pyserial's own error is an OSError."""


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


def explain(port: str, error: BaseException) -> str:
    """A sentence about a foreign exception of a port."""
    number = _number(error) or _number(error.__context__)  # pyserial wraps errors of termios as text
    advice = ADVICE.get(number, "") or str(error) or type(error).__name__
    return f"Serial port {port}: {advice}" + ("" if advice.endswith("?") else ".")


def _number(error: BaseException | None) -> int:
    """The errno of a foreign exception, 0 when it has none."""
    number = error.errno if isinstance(error, OSError) else (*getattr(error, "args", ()), 0)[0]
    return number if isinstance(number, int) else 0


class SerialStream:
    """A serial port on the event loop."""

    def __init__(self, port: serial.Serial) -> None:
        self._port = port
        self._name = str(port.port)
        self._fd = port.fileno()
        self._lost = ""
        self._on_bytes: Callable[[bytes], None] = lambda data: None
        self._on_lost: Callable[[str], None] = lambda reason: None

    def listen(self, on_bytes: Callable[[bytes], None], on_lost: Callable[[str], None]) -> None:
        """Begin to deliver what arrives."""
        self._on_bytes = on_bytes
        self._on_lost = on_lost
        asyncio.get_running_loop().add_reader(self._fd, self._readable)

    def write(self, data: bytes) -> None:
        """Send at once; what a jammed line does not take is dropped.

        Nothing is kept for later, because a goal must not reach a servo long after it was decided on,
        and a packet that is cut short fails its checksum.
        """
        if self._lost:
            raise BusError(self._lost)
        try:
            os.write(self._fd, data)
        except BlockingIOError:
            return
        except OSError as error:
            self._lose(explain(self._name, error))
            raise BusError(self._lost) from error

    def close(self) -> None:
        """Close the port; `on_lost` is not called for it."""
        if self._port.is_open:
            self._detach()
            self._lost = self._lost or explain(self._name, OSError(errno.EBADF, "closed"))
            self._port.close()

    def _readable(self) -> None:
        try:
            data = os.read(self._fd, CHUNK)
        except (BlockingIOError, InterruptedError):
            return
        except OSError as error:
            self._lose(explain(self._name, error))
            return
        if data:
            self._on_bytes(data)
        else:
            self._lose(explain(self._name, OSError(errno.EIO, "end of file")))

    def _lose(self, reason: str) -> None:
        if not self._lost:
            self._lost = reason
            self._detach()
            self._on_lost(reason)

    def _detach(self) -> None:
        asyncio.get_running_loop().remove_reader(self._fd)


def open_serial(port: str, baud: int) -> SerialStream:
    """A serial port, 8N1, for this program alone; the caller closes it.

    Raises:
        BusError: it cannot be opened; the text says what to do.
    """
    try:
        device = serial.Serial(port, baud, timeout=0, write_timeout=0, exclusive=True)
    except FOREIGN as error:
        raise BusError(explain(port, error), field="port") from error
    _hurry(device)
    return SerialStream(device)


def _hurry(device: serial.Serial) -> None:
    """Have a USB adapter pass bytes on at once instead of after 16 ms, where it can."""
    try:
        device.set_low_latency_mode(True)
    except FOREIGN as error:
        log.info("Serial port %s keeps its latency timer: %s", device.port, error)
