"""The way from a command of `bentod ctl` to the daemon: connect, ask, show, end with the right exit code."""

import json
import time
from collections.abc import Callable, Collection, Iterable, Iterator
from contextlib import AbstractAsyncContextManager, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

import click

from bentod.address import CA_VARIABLE, TOKEN_VARIABLE, parse
from bentod.blocking import BlockingClient
from bentod.cli import show
from bentod.client import Client
from bentod.endpoint import Disconnected
from bentod.errors import BadRequest, BentodError, ConfigError
from bentod.frames import Value
from bentod.token_file import read_token


class Failed(click.ClickException):
    """Refused or cancelled: one line on stderr."""

    exit_code = 1


class Misused(Failed):
    """The command or a value in it must be mended."""

    exit_code = 2


class NoDaemon(Failed):
    """The daemon must be started, or looked for elsewhere."""

    exit_code = 3


ADDRESS = click.option(
    "--socket",
    metavar="PATH|ADDRESS",
    envvar="BENTOD_SOCKET",
    is_eager=True,
    help="Where the daemon listens: a path, or tls://HOST:PORT; its usual place if not given.",
)
TOKEN_FILE = click.option(
    "--token-file",
    type=click.Path(path_type=Path),
    envvar=TOKEN_VARIABLE,
    is_eager=True,
    help=f"File with the token that TCP asks for; also {TOKEN_VARIABLE}.",
)
CA_FILE = click.option(
    "--ca-file",
    type=click.Path(path_type=Path),
    envvar=CA_VARIABLE,
    is_eager=True,
    help=f"Authority of the daemon's TLS certificate; also {CA_VARIABLE}.",
)


@dataclass(frozen=True, slots=True)
class Way:
    """What the options of a command say about how to reach the daemon."""

    address: Path | str
    token_file: Path | None = None
    ca_file: Path | None = None

    def blocking(self, timeout: float) -> BlockingClient:
        """Connect, and wait `timeout` (s) for each answer. Raises as `BlockingClient` does."""
        return BlockingClient(self.address, timeout, self._token(), self.ca_file)

    def client(self) -> AbstractAsyncContextManager[Client]:
        """Connect. Raises as `Client.connect` does."""
        return Client.connect(self.address, self._token(), self.ca_file)

    def _token(self) -> str | None:
        needed = not parse(self.address).path
        return read_token(self.token_file, "--token-file") if needed and self.token_file else None


@dataclass(frozen=True, slots=True)
class Link:
    """What the options of `ctl` say."""

    way: Way
    timeout: float  # s for one answer
    as_json: bool

    @contextmanager
    def open(self) -> Iterator[BlockingClient]:
        """A connection; errors of the daemon become exit codes.

        Raises:
            Failed: the daemon refused, the request is wrong, or there is no daemon.
        """
        try:
            with self.way.blocking(self.timeout) as arm:
                yield arm
        except BentodError as error:
            raise failure(error) from error

    def do(self, method: str, /, **named: Value) -> None:
        """Ask one thing and show the answer, if there is one."""
        with self.open() as arm:
            result = arm.call(method, **named)
        if result is not None or self.as_json:
            self.show(result, show.as_text(result))

    def show(self, value: Value, text: str) -> None:
        """Print `value` as JSON or as `text`."""
        click.echo(show.as_json(value) if self.as_json else text)

    def hold(self, method: str, seconds: float, lease: float, /, **named: Value) -> None:
        """Repeat a wish, well within its lease (s), until `seconds` have passed; then let it go."""
        with self.open() as arm:
            arm.call("hello", name="ctl")
            end = time.monotonic() + seconds
            while (left := end - time.monotonic()) > 0:
                arm.call(method, **named, lease_s=lease)
                time.sleep(min(lease / 3, left))

    def watch(self, topic: str, rate_hz: float, text: Callable[[Value], str]) -> None:
        """Show the notifications of one topic, until interrupted."""
        with suppress(KeyboardInterrupt), self.open() as arm:
            arm.call("subscribe", topic=topic, rate_hz=rate_hz)
            for notification in arm.notifications():
                for entry in show.entries(notification.params):
                    self.show(entry, text(entry))


def failure(error: BentodError) -> Failed:
    """The error as an exit code and a line."""
    if isinstance(error, Disconnected):
        return NoDaemon(str(error))
    misused = error.code in (BadRequest.code, ConfigError.code)
    return Misused(str(error)) if misused else Failed(str(error))


def assigned(words: Iterable[str], texts: Collection[str] = ()) -> dict[str, Value]:
    """`key=value` words as named parameters; a value is JSON, or on, off, or else a text.

    What is named in `texts` is a text whatever it looks like.

    Raises:
        Misused: a word has no `=`.
    """
    pairs = [word.partition("=") for word in words]
    for key, sign, _ in pairs:
        if not sign:
            raise Misused(f"'{key}' is not of the form name=value.")
    return {key: value if key in texts else parsed(value) for key, _, value in pairs}


def parsed(text: str) -> Value:
    """The value that a person means by `text`."""
    if text in ("on", "off"):
        return text == "on"
    try:
        value: Value = json.loads(text)
    except ValueError:
        return text
    return value


def switch(words: tuple[str, ...]) -> tuple[bool, tuple[str, ...]]:
    """A leading "on" or "off" (on when there is neither), and the rest."""
    if words and words[0] in ("on", "off"):
        return words[0] == "on", words[1:]
    return True, words


def several(joints: tuple[str, ...]) -> Value:
    """Joints as the daemon takes them: a list, or nil for all."""
    return list(joints) or None
