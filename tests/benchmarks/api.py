"""What a request costs on the Unix socket while the daemon ticks at 200 Hz, against a bare echo server.

Both in processes of their own, asked in turns by the same client: request by request, so that whatever
disturbs the machine falls on both. What waits for the tick is told apart. CALLS: of each kind.
"""

import os
import socket
import statistics
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack, closing, contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

import msgpack

from bentod.frames import Value
from bentod.lateness.histogram import percentile
from bentod.messages import encode_request
from tests.benchmarks.harness import Row, at_most, main
from tests.rig import CONFIGS, number, table
from tests.system.processes import DaemonProcess, daemon, eventually

RATE_HZ = 200
CALLS = int(os.environ.get("CALLS", "4000"))
FIRST = 200
"""Calls before the first that counts."""
MOVES, FRAMES = 400, 200
COSTS = ("read", "think", "write", "publish")


class Caller:
    """One connection; as little as a client can do."""

    def __init__(self, path: Path) -> None:
        self._socket = socket.socket(socket.AF_UNIX)
        self._socket.settimeout(5.0)
        self._socket.connect(str(path))
        self._unpacker = msgpack.Unpacker()
        self._id = 0

    def call(self, method: str, params: object) -> Value:
        """The answer's result."""
        self._id += 1
        self._socket.sendall(encode_request(self._id, method, params))
        while True:
            self._unpacker.feed(self._socket.recv(65536))
            for message in self._unpacker:
                assert message[:3] == [1, self._id, None], message
                result: Value = message[3]
                return result

    def timed(self, method: str, params: object) -> float:
        """How long the answer took (s)."""
        began = time.perf_counter()
        self.call(method, params)
        return time.perf_counter() - began

    def close(self) -> None:
        self._socket.close()


@contextmanager
def echo(folder: Path) -> Iterator[Path]:
    """A bare echo server in a process of its own."""
    path = folder / "echo.sock"
    with subprocess.Popen([sys.executable, "-m", "tests.benchmarks.rigs.echo", str(path)]) as process:
        try:
            eventually(path.exists)
            yield path
        finally:
            process.kill()


def config(folder: Path) -> Path:
    """The shipped simulation at 200 Hz, without bytes and without a wearer."""
    text = (CONFIGS / "sim.toml").read_text()
    head, _, rest = text.partition("[emg]")
    tail = rest[rest.index("[learn]") :]
    text = f"{head}{tail}".replace('"sim-dynamixel"', '"sim"')
    text += "\n[access]\nrequests_per_s = 100_000\n"  # else its bound is what is measured
    file = folder / "config.toml"
    file.write_text(text.replace("rate_hz = 30\n", f"rate_hz = {RATE_HZ}\n", 1))
    return file


def rows() -> Iterator[Row]:
    """About half a minute."""
    with ExitStack() as stack:
        folder = Path(stack.enter_context(TemporaryDirectory()))
        process = stack.enter_context(daemon(folder, "--config", str(config(folder))))
        arm = stack.enter_context(closing(Caller(process.socket)))
        bare = stack.enter_context(closing(Caller(stack.enter_context(echo(folder)))))
        yield from _compared(arm, bare)
        yield from _moves(arm)
        yield from _ticks(process)


def _ticks(process: DaemonProcess) -> Iterator[Row]:
    """What is in the way of the slowest requests: nothing else is done during most of a tick."""
    frames = [process.state() for _ in range(FRAMES)]
    took = [sum(number(table(frame["costs"]), phase) for phase in COSTS) for frame in frames]
    yield Row("a tick takes, median", statistics.median(took) * 1e3, "ms")
    yield Row("  its share of the daemon's time", statistics.fmean(took) * RATE_HZ * 100, "%")
    yield Row("ticks missed meanwhile", number(frames[-1], "missed"), "")


def _compared(arm: Caller, bare: Caller) -> Iterator[Row]:
    bare.call("keep", arm.call("get_info", []))
    pairs = {
        "a small request (unsubscribe)": (("unsubscribe", ["state"]), ("echo", ["state"])),
        "get_info": (("get_info", []), ("kept", [])),
    }
    for what, (ours, theirs) in pairs.items():
        took = [(arm.timed(*ours), bare.timed(*theirs)) for _ in range(FIRST + CALLS)][FIRST:]
        for share in (0.5, 0.99):
            mine, base = (percentile(list(values), share) * 1e6 for values in zip(*took, strict=True))
            yield at_most(f"{what}, p{share * 100:g} / of a bare echo as long", mine / base, "", 2)
            yield Row("  bentod", mine, "µs")
            yield Row("  echo", base, "µs")


def _moves(arm: Caller) -> Iterator[Row]:
    """A request that is answered when the servos have been written."""
    took: list[float] = []
    for turn in range(MOVES):
        time.sleep(turn % 7 * 1e-3)  # another phase of the tick each time
        way = 0.2 if turn % 100 < 50 else -0.2
        took.append(arm.timed("move", {"joint": "gripper", "velocity": way}))
    for share in (0.5, 0.99):
        yield Row(
            f"move, answered after the tick that does it, p{share * 100:g}",
            percentile(took, share) * 1e3,
            "ms",
        )
    yield Row("  in periods, mean", statistics.fmean(took) * RATE_HZ, "")


if __name__ == "__main__":
    main("api", rows())
