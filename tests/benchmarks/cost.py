"""What a whole tick costs, and a minute of them: the simulated arm with everything the daemon does for it."""

import asyncio
import statistics
import time
from collections.abc import AsyncIterator, Callable, Iterator, Sequence
from contextlib import AbstractContextManager, ExitStack, asynccontextmanager
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from unittest import mock

from bentod.config import Config
from bentod.messages import encode_request
from sim import clock
from sim.arm import Arm
from sim.emg_wearer import Wearer
from sim.line import Line
from tests.benchmarks.harness import Row, at_most, interleave, main
from tests.rig import PLAIN, number, running, sim_config, state

MINUTE = 60.0  # s of the arm's time
TICKS = 1_800  # in such a minute
ROUNDS = 5
SETTLED = 1.0  # s until nothing is done for the first time any more


@dataclass(slots=True)
class Minutes:
    """Simulated minutes of one kind, one of them a round."""

    config: Config
    meters: Sequence["Meter"] = ()
    cpu: list[float] = field(default_factory=list)  # s of this process
    wall: list[float] = field(default_factory=list)  # s

    def measure(self) -> float:
        """CPU (s) of one more minute."""
        cpu, wall = clock.run(minute(self.config, self.meters))
        self.cpu.append(cpu)
        self.wall.append(wall)
        return cpu

    @property
    def tick(self) -> float:
        """CPU of a tick (ms), median of the minutes."""
        return statistics.median(self.cpu) / TICKS * 1e3


class Meter:
    """CPU of one method, all of its calls together, callees included."""

    def __init__(self, owner: type, method: str) -> None:
        self.cpu = 0.0  # s
        self._owner = owner
        self._method = method
        self._original = getattr(owner, method)

    def attached(self) -> AbstractContextManager[object]:
        """Counts while entered."""
        return mock.patch.object(self._owner, self._method, self._counting())

    def _counting(self) -> Callable[..., object]:
        def counted(*args: object) -> object:
            before = time.process_time()
            try:
                return self._original(*args)
            finally:
                self.cpu += time.process_time() - before

        return counted


class Sink(asyncio.Protocol):
    """A subscriber that wants every frame and throws it away: what clients do with it is not counted."""

    def __init__(self) -> None:
        self.received = 0  # bytes

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Subscribe."""
        assert isinstance(transport, asyncio.Transport)
        transport.write(encode_request(1, "subscribe", {"topic": "state", "rate_hz": 500}))

    def data_received(self, data: bytes) -> None:
        """Count."""
        self.received += len(data)


async def minute(config: Config, meters: Sequence[Meter] = ()) -> tuple[float, float]:
    """CPU and wall time (s) of a minute of the arm under way, with one subscriber, seen by `meters`."""
    with TemporaryDirectory() as folder:
        socket = Path(folder, "bentod.sock")
        async with running(config, socket) as arm, _subscriber(socket) as sink:
            await asyncio.sleep(SETTLED)
            first = number(await state(arm), "tick")
            with ExitStack() as stack:
                for meter in meters:
                    stack.enter_context(meter.attached())
                cpu, wall = -time.process_time(), -time.perf_counter()
                await asyncio.sleep(MINUTE)
                cpu, wall = cpu + time.process_time(), wall + time.perf_counter()
            last = number(await state(arm), "tick")
    assert last - first == TICKS
    assert sink.received > 1_000 * TICKS, "a frame is longer than a kilobyte, and each must arrive"
    return cpu, wall


@asynccontextmanager
async def _subscriber(socket: Path) -> AsyncIterator[Sink]:
    transport, sink = await asyncio.get_running_loop().create_unix_connection(Sink, str(socket))
    try:
        yield sink
    finally:
        transport.close()


def rows() -> Iterator[Row]:
    """About a minute."""
    line, servos, wearer = Meter(Line, "write"), Meter(Arm, "advance"), Meter(Wearer, "read")
    whole, plain = Minutes(sim_config()), Minutes(sim_config(PLAIN))
    seen = Minutes(sim_config(), (line, servos, wearer))
    interleave({"whole": whole.measure, "plain": plain.measure, "seen": seen.measure}, ROUNDS)
    yield at_most("CPU of one whole tick", whole.tick, "ms", 2)
    yield Row("  least round", min(whole.cpu) / TICKS * 1e3, "ms")
    yield Row("  greatest round", max(whole.cpu) / TICKS * 1e3, "ms")
    parts = {"servos": servos.cpu, "bus": line.cpu - servos.cpu, "wearer": wearer.cpu}
    for name, cpu in parts.items():
        yield Row(f"  share of the simulated {name}", cpu / sum(seen.cpu) * 100, "%")
    yield Row("CPU of one tick without bytes (driver sim)", plain.tick, "ms")
    yield at_most("wall time of a simulated minute", statistics.median(whole.wall), "s", 3)
    yield Row("wall time of one without bytes (driver sim)", statistics.median(plain.wall), "s")


if __name__ == "__main__":
    main("cost", rows())
