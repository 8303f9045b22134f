"""Tells systemd how the daemon is, and lets it see that the tick is alive."""

import os
import socket
from collections.abc import Mapping
from types import TracebackType
from typing import Self


class Supervisor:
    """The line to whoever started the daemon; silent when nobody listens. Never waits, never raises.

    Each call is one datagram (man sd_notify). It is sent without a connection, so that a supervisor that
    comes back is heard again.
    """

    def __init__(self, address: str = "", interval: float = 0.0) -> None:
        self._address = f"\0{address[1:]}" if address.startswith("@") else address
        self._interval = interval
        self._next_ping = float("-inf")
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) if address else None
        if self._socket is not None:
            self._socket.setblocking(False)

    @classmethod
    def from_environment(cls, environment: Mapping[str, str]) -> Self:
        """The supervisor that systemd's variables name: NOTIFY_SOCKET, WATCHDOG_USEC, WATCHDOG_PID."""
        address = environment.get("NOTIFY_SOCKET", "")
        if not address.startswith(("/", "@")):  # the only two kinds that are sockets of this machine
            return cls()
        return cls(address, _watchdog(environment) / 2)

    def ready(self) -> None:
        """The arm is open and the tick runs."""
        self._send("READY=1")

    def status(self, text: str) -> None:
        """Show `text`, one line, in `systemctl status`."""
        self._send(f"STATUS={' '.join(text.split())}")

    def stopping(self) -> None:
        """The end has begun."""
        self._send("STOPPING=1")

    def tick(self, now: float) -> None:
        """Feed the watchdog, at most twice in its time. `now`: monotonic s.

        Only the tick may call this: fed by a timer, the watchdog would outlive a tick that is stuck.
        """
        if self._interval > 0 and now >= self._next_ping and self._send("WATCHDOG=1"):
            self._next_ping = now + self._interval

    def close(self) -> None:
        """Give the socket back; idempotent."""
        if self._socket is not None:
            self._socket.close()
            self._socket = None

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _send(self, message: str) -> bool:
        if self._socket is None:
            return False
        try:
            self._socket.sendto(message.encode(), self._address)
        except OSError:  # gone, or its queue is full; the arm matters more
            return False
        return True


def _watchdog(environment: Mapping[str, str]) -> float:
    """Seconds that the watchdog waits for a sign of this process; 0 when it does not."""
    if environment.get("WATCHDOG_PID", str(os.getpid())) != str(os.getpid()):
        return 0.0
    microseconds = environment.get("WATCHDOG_USEC", "")
    return int(microseconds) / 1e6 if microseconds.isdecimal() else 0.0
