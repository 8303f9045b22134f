"""Simulated buses as processes, for tests that open a port by name."""

import selectors
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager


class Process:
    """A running bus."""

    def __init__(self, child: subprocess.Popen[str]) -> None:
        assert child.stdin
        assert child.stdout
        self.child = child
        self._stdin = child.stdin
        self._stdout = child.stdout
        self.port = self.line()

    def tell(self, command: str) -> None:
        """Type a command."""
        self._stdin.write(command + "\n")
        self._stdin.flush()

    def line(self) -> str:
        """The next line it prints."""
        return self.lines(1)[0]

    def lines(self, count: int) -> list[str]:
        """The next lines, which it prints at once."""
        with selectors.DefaultSelector() as selector:
            selector.register(self._stdout, selectors.EVENT_READ)
            assert selector.select(20), "the bus printed nothing"
        return [self._stdout.readline().strip() for _ in range(count)]

    def end_input(self) -> None:
        self._stdin.close()


@contextmanager
def running(*options: str) -> Iterator[Process]:
    child = subprocess.Popen(
        [sys.executable, "-m", "sim.bus_process", *options],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        bufsize=1,
    )
    with child:
        try:
            yield Process(child)
        finally:
            child.kill()


def eventually(happens: Callable[[], bool], at_most: float = 10.0) -> bool:
    """Whether it happens before `at_most` (s) have passed."""
    deadline = time.monotonic() + at_most
    while not (done := happens()) and time.monotonic() < deadline:
        time.sleep(0.01)
    return done


def refused(*options: str) -> str:
    """What a bus says that does not start."""
    command = [sys.executable, "-m", "sim.bus_process", *options]
    done = subprocess.run(command, capture_output=True, text=True, timeout=30, stdin=subprocess.DEVNULL)
    assert done.returncode == 1
    assert "Traceback" not in done.stderr
    return done.stderr


def ends(process: Process) -> int:
    return process.child.wait(timeout=20)
