"""What thousands of predictions cost: the engine with both kernels against numpy as it is usually written.

Peers and engine take turns within one run, and ratios are of medians over rounds. Elsewhere the times differ,
by the machine and its neighbours; the ratios hardly do.
"""

import asyncio
import statistics
import time
import tracemalloc
from collections.abc import Callable, Iterator
from itertools import islice
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from bentod.contracts import Features
from bentod.learn.kernel import Kernel, choose
from bentod.learn.lazy import Real
from tests.benchmarks.harness import Row, at_least, at_most, main, medians
from tests.benchmarks.learn_peers import Dense, OneByOne
from tests.benchmarks.learn_workloads import ARM, ARM_AT_FOUR, MANY, NEXTING, Engine, Stream, Workload
from tests.rig import running, sim_config

ROUNDS = 5
TENTH_OF_A_TICK = 1e3 / 30 / 10  # ms
PACED = 20.0  # s
WARM = 30  # steps before any is timed
MILLION = 1_000_000


class Learners(Protocol):
    """All predictions of a workload, one way or another."""

    def step(self, features: Features, signals: NDArray[np.float64], /) -> None:
        """Learn, and predict."""
        ...


Kernels = dict[str, Kernel]


def kernels() -> Kernels:
    """Those that are here, the compiled one first."""
    return {kernel.name.split()[0]: kernel for kernel in (choose("auto"), choose("numpy"))}


def timed(
    learners: Learners, stream: Stream, steps: int, clock: Callable[[], float] = time.perf_counter
) -> Callable[[], list[float]]:
    """A measure: what each of some more steps takes by `clock`, ms."""
    coming = iter(stream)
    for arrived in islice(coming, min(WARM, steps)):
        learners.step(*arrived)

    def measure() -> list[float]:
        taken = []
        for features, signals in islice(coming, steps):
            begun = clock()
            learners.step(features, signals)
            taken.append((clock() - begun) * 1e3)
        return taken

    return measure


def engines(load: Workload, dtype: type[Real]) -> dict[str, Learners]:
    """One for each kernel."""
    return {name: Engine(load, kernel, dtype) for name, kernel in kernels().items()}


def compare(
    load: Workload, dtype: type[Real], peers: dict[str, Learners], least: dict[tuple[str, str], float]
) -> Iterator[Row]:
    """`least`: how many times as fast as which peer each kernel has to be."""
    stream, kind = load.stream(), np.dtype(dtype).name
    ours = engines(load, dtype)
    slow = 4 if load is NEXTING else 60
    runs = {name: timed(learners, stream, slow) for name, learners in peers.items()}
    runs |= {name: timed(learners, stream, slow * 10) for name, learners in ours.items()}
    found = medians({name: lambda run=run: statistics.mean(run()) for name, run in runs.items()}, ROUNDS)  # type: ignore[misc]
    for name, taken in found.items():
        yield Row(f"{load.name} ({load.gvfs} GVFs), {kind}: a step, {name}", taken, "ms")
    for name in ours:
        for peer in peers:
            times, bound = found[peer] / found[name], least.get((name, peer))
            title = f"  {name} is faster than {peer} by"
            yield at_least(title, times, "times", bound) if bound else Row(title, times, "times")


def nexting(dtype: type[Real]) -> Iterator[Row]:
    """Against both peers."""
    peers: dict[str, Learners] = {"one by one": OneByOne(NEXTING), "dense numpy": Dense(NEXTING, dtype)}
    least = {("compiled", "one by one"): 60.0, ("compiled", "dense numpy"): 40.0}
    least |= {("numpy", "one by one"): 12.0, ("numpy", "dense numpy"): 8.0}
    yield from compare(NEXTING, dtype, peers, least)


def arm(load: Workload) -> Iterator[Row]:
    """A few predictions, as an arm has them; promised is only what the single group does."""
    least = {("compiled", "one by one"): 20.0, ("numpy", "one by one"): 2.0} if load is ARM else {}
    yield from compare(load, np.float64, {"one by one": OneByOne(load)}, least)


CLOCKS = {"": time.perf_counter, ", CPU": time.thread_time}
"""The second leaves out what other programs do to the processor, not what they do to its caches."""


class Fixed:
    """The same work each time, about as much as a step: how far the machine by itself spreads it."""

    def __init__(self) -> None:
        self._rows = np.ones((NEXTING.active, NEXTING.gvfs))

    def step(self, _features: Features, _signals: NDArray[np.float64], /) -> None:
        """As many numbers as a step reads and writes."""
        np.add.reduce(self._rows, axis=0)
        np.negative(self._rows, out=self._rows)


def hot() -> Iterator[Row]:
    """The spread of steps one after another, and of something that does the same each time."""
    stream = NEXTING.stream()
    for name, learners in (engines(NEXTING, np.float64) | {"fixed work": Fixed()}).items():
        for kind, clock in CLOCKS.items():
            run = timed(learners, stream, 300, clock)
            spread = statistics.median(_spread(run()) for _ in range(ROUNDS))
            title = f"nexting, hot, {name}: p99 / mean{kind}"
            yield Row(title, spread, "times") if name == "fixed work" else at_most(title, spread, "times", 2)


def paced() -> Iterator[Row]:
    """The spread at 30 Hz, in the loop of a whole daemon that drives a simulated arm in real time."""
    for name, learners in (engines(NEXTING, np.float64) | {"fixed work": Fixed()}).items():
        taken = asyncio.run(_beside_a_daemon(learners, NEXTING.stream()))
        for kind, steps in zip(CLOCKS, taken, strict=True):
            yield Row(
                f"nexting, at 30 Hz inside the daemon, {name}: mean{kind}", statistics.mean(steps), "ms"
            )
            yield Row("  p99", float(np.percentile(steps, 99)), "ms")
            spread = _spread(steps)
            yield (
                Row("  p99 / mean", spread, "times")
                if name == "fixed work"
                else at_most("  p99 / mean", spread, "times", 2)
            )


def _spread(taken: list[float]) -> float:
    return float(np.percentile(taken, 99)) / statistics.mean(taken)


async def _beside_a_daemon(learners: Learners, stream: Stream) -> list[list[float]]:
    """A step for each frame of the daemon, in its thread, right after its tick; ms, by each clock."""
    coming, taken = iter(stream), []
    with TemporaryDirectory() as folder:
        async with running(sim_config(), Path(folder, "bentod.sock")) as daemon:
            async for _ in daemon.subscribe_state(rate_hz=30):
                features, signals = next(coming)
                begun = [clock() for clock in CLOCKS.values()]
                learners.step(features, signals)
                ended = [clock() for clock in CLOCKS.values()]
                taken.append([(end - start) * 1e3 for start, end in zip(begun, ended, strict=True)])
                if len(taken) >= PACED * 30 + WARM:
                    break
    return [list(steps) for steps in zip(*taken[WARM:], strict=True)]


def many() -> Iterator[Row]:
    """20,000 predictions; the promise is the compiled kernel's."""
    stream = MANY.stream(100)
    for kind in (np.float64, np.float32):
        for name, learners in engines(MANY, kind).items():
            run = timed(learners, stream, 30)
            taken = statistics.median(statistics.mean(run()) for _ in range(ROUNDS))
            title = f"many ({MANY.gvfs} GVFs), {kind.__name__}: a step, {name}"
            yield (
                at_most(title, taken, "ms", TENTH_OF_A_TICK)
                if name == "compiled"
                else Row(title, taken, "ms")
            )


def room() -> Iterator[Row]:
    """Memory besides the weights, at its greatest while it learns."""
    for load in (NEXTING, MANY):
        for name, kernel in kernels().items():
            arrived = list(islice(load.stream(WARM), WARM))
            tracemalloc.start()
            engine = Engine(load, kernel)
            for features, signals in arrived:
                engine.step(features, signals)
            peak = tracemalloc.get_traced_memory()[1]
            tracemalloc.stop()
            yield at_most(
                f"{load.name}, {name}: memory / weights", peak / engine.weights.nbytes, "times", 1.3
            )


def growth() -> Iterator[Row]:
    """Memory from step to step; fewer of them in numpy, which takes longer."""
    for name, kernel in kernels().items():
        steps = MILLION if name == "compiled" else MILLION // 20
        engine, coming = Engine(ARM, kernel), iter(ARM.stream())
        tracemalloc.start()
        before = 0
        for number, (features, signals) in enumerate(islice(coming, steps + 1000)):
            engine.step(features, signals)
            if number == 999:
                before = tracemalloc.get_traced_memory()[0]
        grown = tracemalloc.get_traced_memory()[0] - before
        tracemalloc.stop()
        yield at_most(f"arm, {name}: growth of memory in {steps:,} steps", grown / 1024, "KiB", 1)


def rows() -> Iterator[Row]:
    """About five minutes."""
    yield from nexting(np.float64)
    yield from nexting(np.float32)
    yield from hot()
    yield from paced()
    yield from many()
    yield from room()
    yield from arm(ARM)
    yield from arm(ARM_AT_FOUR)
    yield from growth()


if __name__ == "__main__":
    main("learn", rows())
