"""The server proper needs what only the extra `web` brings, so it is loaded by name."""

from collections.abc import Awaitable, Callable
from socket import socket
from typing import TypeAlias, cast

from bentod.dashboard.actor import Connect
from bentod.dashboard.doorkeeper import Tokens
from bentod.dashboard.place import Place
from bentod.registry import resolve

Serve: TypeAlias = Callable[[Place, socket, Tokens, Connect, Callable[[], None]], Awaitable[None]]
"""`bentod.dashboard.serving.serve`."""


def load_server() -> Serve:
    """The server. Raises ConfigError: what it needs is not installed."""
    return cast("Serve", resolve("bentod.dashboard.serving:serve"))
