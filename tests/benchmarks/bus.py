"""The servo bus: rounds a second, CPU of a round, harm to a tick beside it, against the official SDK."""

import json
import statistics
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import cast

import dynamixel_sdk as sdk

from tests.benchmarks.harness import Row, at_least, at_most, main
from tests.system.bus_processes import running

SECONDS = 5.0
ROUNDS = 3

Result = dict[str, float]


def rows() -> Iterator[Row]:
    """About two minutes: each reader in a process of its own, by turns, on the same simulated bus."""
    with TemporaryDirectory() as folder:
        link = str(Path(folder, "bus"))
        with running("--link", link):
            _no_return_delay(link)
            yield from _measured(link)


def _measured(link: str) -> Iterator[Row]:
    free = [_reader("ours", link, 0) for _ in range(ROUNDS)]
    yield at_least(
        "rounds a second, as fast as they go", _median(free, lambda r: r["rounds"] / r["seconds"]), "1/s", 200
    )
    paced = [_reader("ours", link, 200) for _ in range(ROUNDS)]
    yield at_most("rounds lost at 200 Hz", 100 * _median(paced, lambda r: r["lost"] / r["rounds"]), "%", 0.1)
    ours, sdk_ = _by_turns(link, 100)
    alone = _median([_reader("nobody", link, 100) for _ in range(ROUNDS)], _cpu)
    cpu = [_median(results, _cpu) - alone for results in (ours, sdk_)]
    yield at_least("CPU of a round at 100 Hz, SDK / ours", cpu[1] / cpu[0], "", 5)
    yield Row("  ours", cpu[0], "µs")
    yield Row("  SDK's bulk read in a thread", cpu[1], "µs")
    late = [_median(results, lambda r: 1e6 * r["late_p99"]) for results in (ours, sdk_)]
    yield Row("  lateness p99 of the tick beside it, SDK / ours", late[1] / late[0], "")
    yield Row("    ours", late[0], "µs")
    yield Row("    SDK's", late[1], "µs")
    ours, sdk_ = _by_turns(link, 250)
    yield at_most("rounds missed at 250 Hz, ours", _missed(ours), "%", 0)
    yield Row("  SDK's", _missed(sdk_), "%")


def _cpu(result: Result) -> float:
    """Microseconds a round, the tick beside it included."""
    return 1e6 * result["cpu"] / result["rounds"]


def _missed(results: Sequence[Result]) -> float:
    return 100 * _median(results, lambda r: r["missed"] / (r["missed"] + r["rounds"]))


def _by_turns(link: str, rate_hz: float) -> tuple[list[Result], list[Result]]:
    pairs = [(_reader("ours", link, rate_hz), _reader("sdk", link, rate_hz)) for _ in range(ROUNDS)]
    return [pair[0] for pair in pairs], [pair[1] for pair in pairs]


def _reader(which: str, link: str, rate_hz: float) -> Result:
    words = [sys.executable, "-m", "tests.benchmarks.rigs.readers", which, link, str(rate_hz), str(SECONDS)]
    done = subprocess.run(words, capture_output=True, text=True, timeout=60, check=True)
    return cast("Result", json.loads(done.stdout.splitlines()[-1]))


def _median(results: Sequence[Result], value: Callable[[Result], float]) -> float:
    return statistics.median(value(result) for result in results)


def _no_return_delay(link: str) -> None:
    """As `bentod doctor --fix` would: 500 µs a reply is the default."""
    line, packets = sdk.PortHandler(link), sdk.PacketHandler(1.0)
    assert line.openPort()
    assert line.setBaudRate(1_000_000)
    for id_ in (1, 2, 3, 4, 5):
        packets.write1ByteTxRx(line, id_, 24, 0)
        assert packets.write1ByteTxRx(line, id_, 5, 0)[0] == sdk.COMM_SUCCESS
    line.closePort()


if __name__ == "__main__":
    main("bus", rows())
