"""Real processes for the tests of the whole: a daemon, the simulated bus, a terminal, and systemd's ear."""

import fcntl
import os
import pty
import selectors
import signal
import socket
import struct
import subprocess
import sys
import termios
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO, TypeAlias, TypeVar

from bentod.blocking import BlockingClient
from tests.rig import Table, table

T = TypeVar("T")
Child: TypeAlias = "subprocess.Popen[bytes]"

BENTOD = (sys.executable, "-m", "bentod")
PATIENCE = 20.0
"""s that anything may take on a busy machine, when the test is not about how long it takes."""

ON_TERMINAL = (
    "import fcntl, os, sys, termios; os.setsid(); fcntl.ioctl(0, termios.TIOCSCTTY, 0);"
    "os.execv(sys.executable, [sys.executable, *sys.argv[1:]])"
)
"""What a terminal emulator does for its first process."""


def eventually(find: Callable[[], T | None], seconds: float = PATIENCE) -> T:
    """What `find` finds, once that is true; fails after `seconds`."""
    deadline = time.monotonic() + seconds
    while not (found := find()):
        assert time.monotonic() < deadline, f"did not happen within {seconds:g} s"
        time.sleep(0.01)
    return found


def bentod(*words: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """`bentod` with `words`, run to its end."""
    command = [*BENTOD, *words]
    return subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, env=environment(folder))


def environment(folder: Path, **more: str) -> dict[str, str]:
    """Variables of a process that keeps its files in `folder` and has no supervisor but the test."""
    kept = {
        name: value for name, value in os.environ.items() if name not in ("NOTIFY_SOCKET", "WATCHDOG_PID")
    }
    return kept | {"XDG_STATE_HOME": str(folder), "XDG_RUNTIME_DIR": str(folder), "TERM": "xterm"} | more


class Systemd:
    """Hears what the daemon tells its supervisor."""

    def __init__(self, folder: Path) -> None:
        self.path = folder / "notify"
        self.said: list[str] = []
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self._socket.setblocking(False)
        self.path.unlink(missing_ok=True)
        self._socket.bind(str(self.path))

    def heard(self) -> list[str]:
        """Everything so far."""
        while True:
            try:
                self.said.append(self._socket.recv(4096).decode())
            except BlockingIOError:
                return self.said

    def pings(self) -> int:
        return self.heard().count("WATCHDOG=1")

    def close(self) -> None:
        self._socket.close()


class DaemonProcess:
    """A daemon under way, its socket, its log and its supervisor."""

    def __init__(self, folder: Path, child: Child, systemd: Systemd) -> None:
        self.socket = folder / "bentod.sock"
        self.child = child
        self.systemd = systemd
        self._log = folder / "log"

    def log(self) -> str:
        return self._log.read_text()

    def is_ready(self) -> bool:
        assert self.child.poll() is None, self.log()
        return "READY=1" in self.systemd.heard()

    def client(self) -> BlockingClient:
        return BlockingClient(self.socket)

    def state(self) -> Table:
        """The newest frame, over a connection of its own."""
        with self.client() as arm:
            return table(arm.call("get_state"))

    def ends(self, number: signal.Signals, seconds: float = PATIENCE) -> int:
        """Send a signal; the exit code that comes of it within `seconds`."""
        self.child.send_signal(number)
        return self.child.wait(seconds)


@contextmanager
def daemon(folder: Path, *options: str, watchdog_s: float = 10.0) -> Iterator[DaemonProcess]:
    """`bentod run` without a view, ready; killed at the end if the test has not ended it."""
    systemd = Systemd(folder)
    told = {"NOTIFY_SOCKET": str(systemd.path), "WATCHDOG_USEC": str(round(watchdog_s * 1e6))}
    command = [*BENTOD, "run", "--no-view", "--socket", str(folder / "bentod.sock"), *options]
    with (folder / "log").open("ab") as log, started(command, environment(folder, **told), log) as child:
        try:
            process = DaemonProcess(folder, child, systemd)
            eventually(process.is_ready)
            yield process
        finally:
            systemd.close()


@contextmanager
def started(
    command: Sequence[str],
    variables: Mapping[str, str],
    output: int | BinaryIO,
    stdin: int = subprocess.DEVNULL,
) -> Iterator[Child]:
    """A process that is killed at the end."""
    with subprocess.Popen(command, stdin=stdin, stdout=output, stderr=output, env=variables) as child:
        try:
            yield child
        finally:
            child.kill()


class BusProcess:
    """A simulated Bento Arm whose serial port can be found at `link`."""

    def __init__(self, link: Path, child: Child) -> None:
        assert child.stdin
        self.link = link
        self.child = child
        self._stdin = child.stdin

    def tell(self, command: str) -> None:
        """Type a command."""
        self._stdin.write(f"{command}\n".encode())
        self._stdin.flush()


@contextmanager
def sim_bus(folder: Path) -> Iterator[BusProcess]:
    """`bentod sim-bus --link`, ready."""
    link = folder / "port"
    command = [*BENTOD, "sim-bus", "--link", str(link)]
    with started(command, environment(folder), subprocess.DEVNULL, subprocess.PIPE) as child:
        eventually(link.exists)
        yield BusProcess(link, child)


class Terminal:
    """A terminal of 100 columns with a process on it."""

    def __init__(self, keyboard: int, screen: int, child: Child) -> None:
        self.child = child
        self.shown = ""
        """Everything that was written to it, escape sequences included."""
        self._near = keyboard
        self._far = screen
        self.settings = termios.tcgetattr(screen)

    def type(self, text: str) -> None:
        os.write(self._near, text.encode())

    def freeze(self, on: bool) -> None:
        """Stop the output, as Ctrl-S does, or let it go on."""
        termios.tcflow(self._far, termios.TCOOFF if on else termios.TCOON)

    def read(self) -> str:
        """What has been shown so far."""
        with selectors.DefaultSelector() as selector:
            selector.register(self._near, selectors.EVENT_READ)
            while selector.select(0):
                self.shown += os.read(self._near, 65536).decode(errors="replace")
        return self.shown

    def has_ended(self) -> bool:
        """Whether the process is over; reads meanwhile, so that it is not held up."""
        self.read()
        return self.child.poll() is not None

    def is_as_it_was(self) -> bool:
        """Whether the settings are those from before the process."""
        return termios.tcgetattr(self._far) == self.settings


@contextmanager
def terminal(folder: Path, *words: str) -> Iterator[Terminal]:
    """`bentod` with `words` as the first process of a terminal."""
    near, far = pty.openpty()
    try:
        fcntl.ioctl(far, termios.TIOCSWINSZ, struct.pack("HHHH", 40, 100, 0, 0))
        command = [sys.executable, "-c", ON_TERMINAL, *BENTOD[1:], *words]
        with started(command, environment(folder), far, stdin=far) as child:
            yield Terminal(near, far, child)
    finally:
        os.close(near)
        os.close(far)
