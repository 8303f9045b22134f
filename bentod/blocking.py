"""The blocking client of the daemon, for notebooks and the command line."""

import itertools
import socket
import ssl
import time
from collections import deque
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from types import TracebackType
from typing import Self

from bentod.address import Address, parse
from bentod.endpoint import (
    BACKLOG,
    GENEROUS,
    Disconnected,
    complaint,
    connecting,
    default_socket_path,
    either,
    result_of,
)
from bentod.errors import BentodError
from bentod.frames import Value
from bentod.messages import GREATEST_ID, Decoder, Message, Notification, Response, encode_request


class BlockingClient:
    """`with BlockingClient(path) as arm: arm.call("stop")`. For one thread; notifications wait until read."""

    def __init__(
        self,
        address: Path | str | None = None,
        timeout_s: float = 5.0,
        token: str | None = None,
        cafile: Path | str | None = None,
    ) -> None:
        """Connect to the daemon at `address`, or at the default one; `timeout_s` holds for every answer.

        `address`, `token` and `cafile` are as in `Client.connect`, and so is what is raised.
        """
        where = parse(address or default_socket_path())
        self._timeout = timeout_s
        self._decoder = Decoder(GENEROUS)
        self._ids = itertools.count()
        self._waiting: deque[Notification] = deque(maxlen=BACKLOG)
        tls = where.tls_context(cafile)
        with connecting(where):
            self._socket = _connected(where, tls, timeout_s)
        if not where.path:
            self._authenticate(where, token)

    def _authenticate(self, where: Address, token: str | None) -> None:
        try:
            self.call("authenticate", **where.answer(self.call("challenge"), token))
        except BentodError:
            self.close()
            raise

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Leave; what was held for this client ends."""
        self._socket.close()

    def call(self, method: str, /, *params: Value, **named: Value) -> Value:
        """Ask and wait for the answer; parameters by position or by name, not both.

        Raises:
            RpcError: the daemon refused.
            Disconnected: the connection is lost, or no answer came in time.
        """
        id_ = next(self._ids) & GREATEST_ID
        deadline = time.monotonic() + self._timeout
        self._send(encode_request(id_, method, either(params, named)))
        while message := self._next(deadline):
            if isinstance(message, Notification):
                self._waiting.append(message)
            elif isinstance(message, Response) and message.id == id_:
                return result_of(message)
        raise Disconnected(f"The daemon did not answer {method} within {self._timeout:g} s.")

    def notifications(self, timeout_s: float | None = None) -> Iterator[Notification]:
        """What subscriptions bring: "state" with a frame, "event" with an event. Ends after a silence.

        Raises:
            Disconnected: the connection is lost.
        """
        while True:
            if self._waiting:
                yield self._waiting.popleft()
                continue
            message = self._next(None if timeout_s is None else time.monotonic() + timeout_s)
            if message is None:
                return
            if isinstance(message, Notification):
                yield message

    def _next(self, deadline: float | None) -> Message | None:
        while (message := next(self._decoder, None)) is None:
            data = self._receive(deadline)
            if data is None:
                return None
            self._decoder.feed(data)
        if isinstance(message, Notification) and message.method == "error":
            raise complaint(message)
        return message

    def _send(self, data: bytes) -> None:
        try:
            self._socket.settimeout(self._timeout)
            self._socket.sendall(data)
        except OSError as error:
            self.close()  # half a message may be on its way
            raise Disconnected(f"The connection to the daemon is lost: {error}.") from error

    def _receive(self, deadline: float | None) -> bytes | None:
        try:
            self._socket.settimeout(None if deadline is None else max(deadline - time.monotonic(), 1e-3))
            data = self._socket.recv(65536)
        except TimeoutError:
            return None
        except OSError as error:
            raise Disconnected(f"The connection to the daemon is lost: {error}.") from error
        if not data:
            raise Disconnected("The daemon closed the connection.")
        return data


def _connected(where: Address, tls: ssl.SSLContext | None, timeout_s: float) -> socket.socket:
    with ExitStack() as stack:
        if where.path:
            found = stack.enter_context(socket.socket(socket.AF_UNIX))
            found.settimeout(timeout_s)
            found.connect(where.path)
        else:
            found = stack.enter_context(socket.create_connection((where.host, where.port), timeout_s))
            found.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            if tls:
                found = stack.enter_context(tls.wrap_socket(found, server_hostname=where.host))
        stack.pop_all()
    return found
