"""A pseudo-terminal that stands for the serial port of a simulated bus."""

import asyncio
import os
import pty
import termios
import tty
from collections.abc import Callable
from pathlib import Path

from bentod.errors import ConfigError

CHUNK = 4096
"""bytes taken from the port at once, so that no client can keep the loop from the servos."""

RATES = {
    getattr(termios, name): int(name[1:]) for name in dir(termios) if name[0] == "B" and name[1:].isdigit()
}
"""bit/s by the termios constant; rates without a constant cannot be told apart."""


class Terminal:
    """A raw pty whose far end stays open, so that clients come and go; it can vanish and come back."""

    def __init__(self, link: Path | None, on_bytes: Callable[[bytes], None]) -> None:
        self._link = link
        self._on_bytes = on_bytes
        self._loop = asyncio.get_running_loop()
        self._near = self._far = -1
        self._path = Path()

    def plug(self) -> str:
        """Open a port and return its path; it may be another one each time.

        Raises:
            ConfigError: the link cannot be made, or something that is not a link stands in its place.
        """
        self._near, self._far = pty.openpty()
        tty.setraw(self._far)
        os.set_blocking(self._near, False)
        self._loop.add_reader(self._near, self._readable)
        self._path = Path(os.ttyname(self._far))
        self._point_link()
        return str(self._path)

    def pull(self) -> None:
        """Hang up on whoever holds the port; idempotent."""
        if self._near < 0:
            return
        self._loop.remove_reader(self._near)
        self._remove_link()
        os.close(self._near)
        os.close(self._far)
        self._near = self._far = -1

    def baud(self) -> int | None:
        """bit/s that the client asked for, which the pty itself ignores; None when it cannot be told."""
        return RATES.get(termios.tcgetattr(self._far)[5])

    def write(self, data: bytes) -> None:
        """Hand `data` to the client; what nobody reads is dropped once the pty is full."""
        if self._near < 0:
            return
        try:
            os.write(self._near, data)
        except BlockingIOError:
            return

    def _readable(self) -> None:
        self._on_bytes(os.read(self._near, CHUNK))

    def _point_link(self) -> None:
        if self._link is None:
            return
        self._remove_link()
        try:
            self._link.symlink_to(self._path)
        except OSError as error:
            raise ConfigError(f"--link {self._link} cannot be made: {error.strerror}.", "link") from error

    def _remove_link(self) -> None:
        """Remove the link, also that of a bus that was killed, but none that leads elsewhere."""
        link = self._link
        if link is not None and link.is_symlink() and link.readlink().parent == self._path.parent:
            link.unlink()
