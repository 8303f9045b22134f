"""What every client shares: where the daemon is, what can go wrong there, what is believed of it."""

import os
import ssl
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from bentod.address import CA_VARIABLE, Address, shared_folder
from bentod.errors import BadRequest, BentodError
from bentod.frames import Value
from bentod.framing import Limits
from bentod.messages import Notification, Response

GENEROUS = Limits(size=4 * 1024 * 1024, items=4096, trusted=True)
"""What a client takes from the daemon it trusts: frames and tables may be long."""

BACKLOG = 1024
"""Notifications that wait for a client's own code; the oldest are dropped."""


class RpcError(BentodError):
    """The daemon answered with an error; `code` says which.

    Examples: bad_request for a velocity beyond its bound, refused for a move while the arm is paused.
    """

    def __init__(self, code: str, message: str, field: str = "") -> None:
        super().__init__(message, field)
        self.code = code


class Disconnected(BentodError):
    """There is no daemon at the other end.

    Examples: it was never started, it listens on another path, it ended, it does not answer in time.
    """

    code = "disconnected"


def default_socket_path() -> Path:
    """Where daemon and clients meet when nobody says otherwise."""
    if service := os.environ.get("RUNTIME_DIRECTORY"):
        return Path(service.split(":")[0], "bentod.sock")
    if user := os.environ.get("XDG_RUNTIME_DIR"):
        return Path(user, "bentod", "bentod.sock")
    return shared_folder() / "bentod.sock"


@contextmanager
def connecting(address: Address) -> Iterator[None]:
    """Around the attempt to connect to `address`.

    Raises:
        ConfigError: somebody else could be listening there.
        Disconnected: it failed.
    """
    address.check()
    try:
        yield
    except ssl.SSLCertVerificationError as error:
        raise Disconnected(
            f"{address.text} cannot prove who it is: {error.verify_message}. Name the authority of its "
            f"certificate in {CA_VARIABLE}.",
            "socket",
        ) from error
    except TimeoutError as error:
        raise Disconnected(f"No daemon answers at {address.text} in time.", "socket") from error
    except OSError as error:
        reason = error.strerror or str(error)
        raise Disconnected(f"No daemon answers at {address.text}: {reason}.", "socket") from error


def either(params: tuple[Value, ...], named: dict[str, Value]) -> Value:
    """Parameters as they are sent: by position or by name.

    Raises:
        BadRequest: both were given.
    """
    if params and named:
        raise BadRequest("Give the parameters by position or by name, not both.")
    return named or list(params)


def rpc_error(raw: Value) -> RpcError:
    """The error in a response, whatever its shape: other servers may answer with a mere text."""
    if not isinstance(raw, dict):
        return RpcError("error", str(raw))
    return RpcError(*(str(raw.get(key, "")) for key in ("code", "message", "field")))


def result_of(response: Response) -> Value:
    """What was asked for.

    Raises:
        RpcError: the response is an error.
    """
    if response.error is not None:
        raise rpc_error(response.error)
    return response.result


def complaint(message: Notification) -> RpcError:
    """The error that the daemon closes a connection with."""
    match message.params:
        case [raw]:
            return rpc_error(raw)
    return rpc_error(message.params)
