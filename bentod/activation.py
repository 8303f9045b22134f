"""The socket that systemd already listens on, when it starts the daemon because somebody has connected."""

import os
import socket
from collections.abc import MutableMapping
from pathlib import Path

from bentod.errors import ConfigError

FIRST = 3
"""The first descriptor that is passed (man sd_listen_fds)."""

_VARIABLES = ("LISTEN_PID", "LISTEN_FDS", "LISTEN_FDNAMES")


def passed_socket(environment: MutableMapping[str, str], first: int = FIRST) -> socket.socket | None:
    """The listening Unix socket that was passed to this process; None when there is none.

    Takes the variables out of `environment`, and the socket from the processes that are started later: it
    was meant for this process only.

    Raises:
        ConfigError: something else was passed.
    """
    meant_for, count, names = (environment.pop(name, "") for name in _VARIABLES)
    if meant_for != str(os.getpid()) or count in ("", "0"):
        return None
    if count != "1":
        raise _wrong(f"{count} sockets ({names or 'without names'}); bentod takes one Unix socket")
    what = f"'{names}'" if names else f"descriptor {first}"
    try:
        listener = socket.socket(fileno=first)
    except OSError as error:
        raise _wrong(f"{what}, which is no socket: {error.strerror}") from error
    problem = _problem(listener)
    if problem:
        listener.close()
        raise _wrong(f"{what}, which {problem}")
    listener.set_inheritable(False)
    return listener


def path_of(listener: socket.socket) -> Path:
    """Where clients find `listener`."""
    return Path(os.fsdecode(listener.getsockname()))


def _problem(listener: socket.socket) -> str:
    """Why `listener` will not do; empty if it will."""
    if listener.family != socket.AF_UNIX:
        return f"is of the family {_name(listener.family)}, not AF_UNIX"
    if listener.type != socket.SOCK_STREAM:
        return f"is of the type {_name(listener.type)}, not SOCK_STREAM"
    if not listener.getsockopt(socket.SOL_SOCKET, socket.SO_ACCEPTCONN):
        return "does not listen"
    name = os.fsencode(listener.getsockname())
    if not name.startswith(b"/"):  # no file, so no permissions either: everybody could connect
        return "is not a file in a folder"
    return ""


def _name(value: int) -> str:
    return value.name if isinstance(value, socket.AddressFamily | socket.SocketKind) else str(value)


def _wrong(what: str) -> ConfigError:
    return ConfigError(f"The supervisor passed {what}. Mend the socket unit.", "LISTEN_FDS")
