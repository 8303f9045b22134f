"""Keeps the page's server running: one that crashes is started again, with the same tokens and port."""

import json
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import asdict

from bentod.dashboard.doorkeeper import Tokens
from bentod.errors import BadRequest

USELESS = 2
"""Exit code of a server that will not do better next time: its error is the user's to mend."""

_FIRST_WAIT, _LONGEST_WAIT = 0.2, 30.0
"""s before a server that crashed is started again; twice as long each time."""

_WELL = 60.0
"""s after which a server counts as having run well."""


class Keeper:
    """Runs `command` again and again. Tokens go to it through a pipe: others can read arguments."""

    def __init__(
        self, command: Sequence[str], listener: int, tokens: Tokens, ready: Callable[[], None]
    ) -> None:
        """`listener`: descriptor of the socket to serve; `ready`: called when browsers are first let in."""
        self._listener = listener
        self._command = command
        self._tokens = tokens
        self._ready = ready
        self._ended = threading.Event()
        self._process: subprocess.Popen[bytes] | None = None

    def run(self) -> int:
        """Until SIGINT or SIGTERM, or until the server says that it is of no use; returns the exit code."""
        wait = _FIRST_WAIT
        with self._signals():
            while True:
                began = time.monotonic()
                code = self._once()
                if self._ended.is_set() or code in (0, USELESS):
                    return 0 if self._ended.is_set() else code
                wait = _FIRST_WAIT if time.monotonic() - began > _WELL else min(2 * wait, _LONGEST_WAIT)
                sys.stderr.write(f"bentod: the page's server ended ({_how(code)}) and is started again.\n")
                if self._ended.wait(wait):
                    return 0

    def _once(self) -> int:
        """One life of the server: its pipe stays open for as long as we live."""
        with subprocess.Popen(  # noqa: S603 -- our own program
            [*self._command, "--listener", str(self._listener)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            pass_fds=[self._listener],
        ) as process:
            self._process = process
            if self._ended.is_set():
                process.terminate()
            with suppress(BrokenPipeError):
                _tell(process, self._tokens)
            if process.stdout and process.stdout.readline():
                self._ready()
                self._ready = _nothing
            code = process.wait()
            self._process = None
        return code

    def _end(self, *_: object) -> None:
        self._ended.set()
        if self._process:
            self._process.terminate()

    @contextmanager
    def _signals(self) -> Iterator[None]:
        before = {number: signal.signal(number, self._end) for number in (signal.SIGINT, signal.SIGTERM)}
        try:
            yield
        finally:
            for number, handler in before.items():
                signal.signal(number, handler)


def own_command(arguments: Sequence[str]) -> list[str]:
    """The command line of a server with these arguments."""
    return [sys.executable, "-m", "bentod", "dashboard", *arguments]


def read_tokens() -> Tokens:
    """What the keeper says to its server on standard input. Raises BadRequest: nobody keeps this process."""
    line = b""
    while not line.endswith(b"\n") and (more := os.read(0, 4096)):
        line += more
    try:
        return Tokens(**json.loads(line))
    except (TypeError, ValueError) as error:
        raise BadRequest("--listener is for bentod dashboard itself.") from error


def _tell(process: subprocess.Popen[bytes], tokens: Tokens) -> None:
    if process.stdin:
        process.stdin.write(json.dumps(asdict(tokens)).encode() + b"\n")
        process.stdin.flush()


def _how(code: int) -> str:
    return f"signal {-code}" if code < 0 else f"exit code {code}"


def _nothing() -> None:
    """It was told already."""
