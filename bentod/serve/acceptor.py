"""Takes connections from a listening socket: in turn with what clients ask, none while files have run out."""

import asyncio
import logging
import socket
from collections.abc import Callable

from bentod.bucket import Bucket
from bentod.gate import Gate

log = logging.getLogger(__name__)

BREATHER = 1.0
"""s to wait when the process or the machine has no file descriptor left."""


class Acceptor:
    """Calls `welcome` with each connection, while it is started."""

    def __init__(
        self,
        listener: socket.socket,
        welcome: Callable[[socket.socket], None],
        gate: Gate,
        pace: Bucket | None = None,
    ) -> None:
        self._listener = listener
        self._gate = gate
        self._open = False
        self._welcome = welcome
        self._pace = pace
        self._loop = asyncio.get_running_loop()
        self._timer: asyncio.TimerHandle | None = None
        self._complained = False
        listener.setblocking(False)

    def start(self) -> None:
        """Take connections from now on."""
        self._timer = None
        self._open = True
        self._loop.add_reader(self._listener, self._knock)

    def stop(self) -> None:
        """Take no more, at once; idempotent."""
        self._open = False
        self._loop.remove_reader(self._listener)
        if self._timer:
            self._timer.cancel()

    def _knock(self) -> None:
        self._loop.remove_reader(self._listener)
        self._gate.submit(self._take)

    def _take(self) -> bool:
        if self._open:
            self._loop.add_reader(self._listener, self._knock)
            self._accept()
        return False

    def _accept(self) -> None:
        try:
            connection, _ = self._listener.accept()
        except (BlockingIOError, ConnectionAbortedError):  # it left before it was taken
            return
        except OSError as error:
            if not self._complained:
                log.warning("No connection can be taken now: %s.", error.strerror)
            self._complained = True
            self._rest(BREATHER)
            return
        self._complained = False
        connection.setblocking(False)
        if self._pace and (wait := self._pace.take()) > 0:
            self._rest(wait)
        self._welcome(connection)

    def _rest(self, seconds: float) -> None:
        self._loop.remove_reader(self._listener)
        self._timer = self._loop.call_later(seconds, self.start)
