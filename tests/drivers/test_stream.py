import asyncio
import contextlib
import errno
import os
import pty
import termios
import tty
from collections.abc import Iterator
from pathlib import Path

import pytest
import serial

from bentod.errors import BusError
from drivers.stream import CHUNK, SerialStream, explain, open_serial

pytestmark = pytest.mark.real_time


class Far:
    """The far end of a pseudo-terminal."""

    def __init__(self) -> None:
        self.fd, near = pty.openpty()
        tty.setraw(near)
        self.port = os.ttyname(near)
        self._near = near

    def hang_up(self) -> None:
        """Both ends that this process holds; closing again is no harm."""
        for fd in (self.fd, self._near):
            with contextlib.suppress(OSError):
                os.close(fd)


@pytest.fixture
def far() -> Iterator[Far]:
    far = Far()
    yield far
    far.hang_up()


class Ear:
    """What a listener hears."""

    def __init__(self, stream: SerialStream) -> None:
        self.heard = b""
        self.lost: list[str] = []
        self._news = asyncio.Event()
        stream.listen(self._on_bytes, self._on_lost)

    async def news(self) -> None:
        async with asyncio.timeout(5):
            await self._news.wait()
        self._news.clear()

    def _on_bytes(self, data: bytes) -> None:
        self.heard += data
        self._news.set()

    def _on_lost(self, reason: str) -> None:
        self.lost.append(reason)
        self._news.set()


async def test_bytes_go_both_ways_unchanged(far: Far) -> None:
    everything = bytes(range(256))
    with contextlib.closing(open_serial(far.port, 1_000_000)) as stream:
        ear = Ear(stream)
        stream.write(everything)
        assert os.read(far.fd, CHUNK) == everything
        os.write(far.fd, everything)
        while len(ear.heard) < 256:
            await ear.news()
        assert ear.heard == everything


async def test_a_port_has_the_rate_that_was_asked_for(far: Far) -> None:
    with contextlib.closing(open_serial(far.port, 57_600)):
        assert termios.tcgetattr(far.fd)[4] == termios.B57600


async def test_a_hang_up_is_told_once_in_a_sentence(far: Far) -> None:
    with contextlib.closing(open_serial(far.port, 1_000_000)) as stream:
        ear = Ear(stream)
        far.hang_up()
        await ear.news()
        for _ in range(3):
            await asyncio.sleep(0)
        assert ear.lost == [f"Serial port {far.port}: the line hung up; was the adapter unplugged?"]
        with pytest.raises(BusError, match="hung up"):
            stream.write(b"hello")
        assert len(ear.lost) == 1


async def test_a_write_that_finds_the_line_gone_tells_it_too(far: Far) -> None:
    with contextlib.closing(open_serial(far.port, 1_000_000)) as stream:
        ear = Ear(stream)
        far.hang_up()
        with pytest.raises(BusError, match="hung up"):
            stream.write(b"hello")
        assert len(ear.lost) == 1


async def test_a_jammed_line_drops_what_it_does_not_take(far: Far) -> None:
    with contextlib.closing(open_serial(far.port, 1_000_000)) as stream:
        ear = Ear(stream)
        for _ in range(200):
            stream.write(bytes(1024))
        assert ear.lost == []


async def test_a_closed_port_hears_nothing_and_takes_nothing(far: Far) -> None:
    stream = open_serial(far.port, 1_000_000)
    ear = Ear(stream)
    stream.close()
    stream.close()
    os.write(far.fd, b"late")
    await asyncio.sleep(0)
    assert (ear.heard, ear.lost) == (b"", [])
    with pytest.raises(BusError, match="it was closed"):
        stream.write(b"hello")


async def test_a_port_is_for_one_program(far: Far) -> None:
    with (
        contextlib.closing(open_serial(far.port, 1_000_000)),
        pytest.raises(BusError, match="another program holds it"),
    ):
        open_serial(far.port, 1_000_000)


async def test_a_port_that_is_not_there_is_told_with_advice(tmp_path: Path) -> None:
    with pytest.raises(BusError, match="no such port; is the adapter plugged in") as caught:
        open_serial(str(tmp_path / "ttyUSB0"), 1_000_000)
    assert caught.value.field == "port"


async def test_a_file_is_not_a_port(tmp_path: Path) -> None:
    path = tmp_path / "file"
    path.touch()
    with pytest.raises(BusError, match="it is not a serial port"):
        open_serial(str(path), 1_000_000)


@pytest.mark.parametrize(
    ("error", "advice"),
    [
        (PermissionError(errno.EACCES, "denied"), "dialout"),
        (serial.SerialException(errno.EBUSY, "busy"), "close that program"),
        (termios.error(errno.EIO, "I/O error"), "the line hung up"),
        (ValueError("Failed to set custom baud rate"), "Failed to set custom baud rate"),
        (NotImplementedError(), "NotImplementedError"),
    ],
)
async def test_every_foreign_error_becomes_a_sentence(error: Exception, advice: str) -> None:
    text = explain("/dev/ttyUSB0", error)
    assert text.startswith("Serial port /dev/ttyUSB0: ")
    assert advice in text
