"""How late a tick starts at 30 Hz: the daemon's clock, the event loop's timers, and a naive sleep."""

import asyncio
import time
from collections.abc import Callable, Coroutine, Iterator

from bentod.clock import SystemClock
from tests.benchmarks.harness import Row, at_most, interleave, main, percentile

PERIOD = 1 / 30  # s
TICKS = 30  # in a burst
ROUNDS = 7


async def by_clock(clock: SystemClock) -> list[float]:
    """Lateness (s) of ticks at absolute deadlines."""
    start, late = clock.now(), []
    for tick in range(1, TICKS + 1):
        deadline = start + tick * PERIOD
        await clock.sleep_until(deadline)
        late.append(clock.now() - deadline)
    return late


async def by_sleep() -> list[float]:
    """Lateness (s) of each sleep alone: that such a loop also drifts is not even counted."""
    late = []
    for _ in range(TICKS):
        deadline = time.monotonic() + PERIOD
        await asyncio.sleep(PERIOD)
        late.append(time.monotonic() - deadline)
    return late


def rows() -> Iterator[Row]:
    """About 20 s of ticks, a second of each kind in turn."""
    kernel, loop = SystemClock(), SystemClock(precise=False)
    kinds = {
        "timerfd": Kind(lambda: by_clock(kernel)),
        "call_at": Kind(lambda: by_clock(loop)),
        "sleep": Kind(by_sleep),
    }
    interleave({name: kind.burst for name, kind in kinds.items()}, ROUNDS)
    kernel.close()
    for name, kind in kinds.items():
        yield Row(f"lateness at 30 Hz, {name}, p50", percentile(kind.late, 0.5) * 1e6, "µs")
        yield Row(f"lateness at 30 Hz, {name}, p90", percentile(kind.late, 0.9) * 1e6, "µs")
        yield Row(f"lateness at 30 Hz, {name}, p99", percentile(kind.late, 0.99) * 1e6, "µs")
        yield Row(f"CPU at 30 Hz, {name}", kind.cpu / (len(kind.late) * PERIOD) * 100, "%")
    for share in (0.5, 0.99):
        ratio = percentile(kinds["timerfd"].late, share) / percentile(kinds["sleep"].late, share)
        yield at_most(f"p{share * 100:g} of timerfd / of sleep", ratio, "", 0.5)


class Kind:
    """One way to tick, and what was seen of it."""

    def __init__(self, ticks: Callable[[], Coroutine[object, object, list[float]]]) -> None:
        self._ticks = ticks
        self.late: list[float] = []  # s
        self.cpu = 0.0  # s

    def burst(self) -> float:
        """CPU (s) of one burst."""
        before = time.process_time()
        self.late += asyncio.run(self._ticks())
        self.cpu += (spent := time.process_time() - before)
        return spent


if __name__ == "__main__":
    main("clock", rows())
