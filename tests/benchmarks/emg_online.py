"""Recognition in use: what it takes of a core, when a decision is there, and whether it is a recording's."""

import asyncio
import gc
import time
from collections.abc import AsyncIterator, Callable, Iterator, Sequence
from contextlib import contextmanager

import numpy as np
from numpy.typing import NDArray

from bentod.config_conditioning import Filter
from bentod.config_recognition import Recognition
from bentod.emg.classify.labelled import Recorded, windows_of
from bentod.emg.classify.model import Model, Setting
from bentod.emg.classify.training import Recipe, trained
from bentod.emg.feed import Feed
from bentod.emg.live.alignment import aligned, labelled
from bentod.emg.live.collection import Session
from bentod.emg.live.plan import Plan
from bentod.emg.live.recogniser import Recogniser
from bentod.emg.live.stream import Stream, deciding, features
from bentod.emg.recognition import Decision
from bentod.emg.segmenting import segmenting
from bentod.frames import EmgBlock, Samples
from sim.movements import MOVEMENTS, Prompted
from sim.obeying import Obeying
from tests.benchmarks.harness import Row, at_most

RATE_HZ, ELECTRODES = 1000.0, 8
SECONDS = 12.0
TICK_HZ = 30.0
FILTERS = (Filter(kind="high_pass", hz=20),)
TABLE = Recognition.model_validate(
    {"classes": [{"name": name, "group": "hand", "moves": {"wrist_flexion": 1.0}} for name in MOVEMENTS]}
)
SETTING = Setting(RATE_HZ, ELECTRODES, segmenting(TABLE.window_s, TABLE.step_s, RATE_HZ), FILTERS)

CUTS = 200
"""Ways to cut a recording into blocks at random."""


class Device:
    """Gives what was recorded, at its own rate, and knows when each sample was taken."""

    rate_hz = RATE_HZ
    channels = ELECTRODES

    def __init__(self, samples: Samples, block: int) -> None:
        self._samples = samples
        self._block = block
        self.start = 0.0
        self.handed: list[float] = []
        """Monotonic s at which each block was handed over."""

    async def __aiter__(self) -> AsyncIterator[EmgBlock]:
        loop = asyncio.get_running_loop()
        self.start = loop.time()
        for first in range(0, len(self._samples), self._block):
            due = self.start + (first + self._block) / RATE_HZ
            await asyncio.sleep(max(0.0, due - loop.time()))
            self.handed.append(loop.time())
            samples = self._samples[first : first + self._block]
            yield EmgBlock(first, self.start + first / RATE_HZ, samples)


def performed(seed: int, repetitions: int) -> Session:
    """A simulated person who makes all movements as they are asked for."""
    person = Obeying(Prompted(electrodes=ELECTRODES, obeys=True, session=seed), RATE_HZ)
    plan = Plan(MOVEMENTS, 2.0, 1.5, repetitions)
    parts, at = [], 0
    for prompt in plan.prompts(RATE_HZ):
        for label, until in (("rest", prompt.shown), (prompt.label, prompt.hidden)):
            if until > at:
                person.prompt(label)
                parts.append(person.read(at, until - at))
                at = until
    person.prompt("rest")
    parts.append(person.read(at, plan.samples(RATE_HZ) - at))
    return Session(RATE_HZ, np.concatenate(parts), plan.prompts(RATE_HZ))


def model_of(session: Session) -> Model:
    """Trained as the daemon does."""
    piece, _ = labelled(session, aligned(session, FILTERS), "")
    windows = windows_of([Recorded(RATE_HZ, (piece,))], SETTING.segmenting, FILTERS)
    return trained(windows, Recipe(features(TABLE, ELECTRODES, RATE_HZ)), SETTING)


async def idle(samples: Samples, block: int) -> float:
    """Share of a core (%) that the loop, the device and the ring take by themselves."""
    feed = Feed(Device(samples, block))
    began, cpu = time.perf_counter(), time.process_time()
    await feed.pump()
    return 100 * (time.process_time() - cpu) / (time.perf_counter() - began)


@contextmanager
def _collected_in_slack() -> Iterator[None]:
    """The daemon collects garbage in the time that is left after a tick, never while it works."""
    gc.collect()
    gc.disable()
    try:
        yield
    finally:
        gc.enable()


def _timed(step: Callable[[], bool], spent: list[float]) -> Callable[[], bool]:
    """The same step, whose processor time (s) is noted: what others take of the machine is not in it."""

    def timed() -> bool:
        began = time.thread_time()
        more = step()
        spent.append(time.thread_time() - began)
        return more

    return timed


async def live(model: Model, samples: Samples, block: int) -> dict[str, float]:
    """Run as the daemon does for the length of `samples`; ms, and share of a core (%)."""
    device = Device(samples, block)
    feed = Feed(device)
    recogniser = Recogniser(TABLE, FILTERS, feed)
    recogniser.use(model, "model")
    decided: list[tuple[int, float]] = []
    loop = asyncio.get_running_loop()
    spent: list[float] = []
    recogniser.decided = lambda decision: decided.append((decision.index, loop.time()))
    recogniser.step = _timed(recogniser.step, spent)  # type: ignore[method-assign]
    task = asyncio.create_task(recogniser.run())
    began, cpu = time.perf_counter(), time.process_time()
    with _collected_in_slack():
        await feed.pump()
    share = (time.process_time() - cpu) / (time.perf_counter() - began)
    await asyncio.sleep(0.01)
    task.cancel()
    ours = [at - device.handed[index // block] for index, at in decided]
    whole = [at - device.start - (index + 1) / RATE_HZ for index, at in decided]
    # The tick that takes the decision to the servos comes at any time after it, evenly.
    ticks = np.random.default_rng(1).uniform(0, 1 / TICK_HZ, len(whole)) + whole
    return {
        "share": 100 * share,
        "spent": 1e3 * float(np.percentile(spent, 99)),
        "ours median": 1e3 * float(np.median(ours)),
        "ours": 1e3 * float(np.percentile(ours, 99)),
        "median": 1e3 * float(np.median(whole)),
        "p99": 1e3 * float(np.percentile(whole, 99)),
        "servos": 1e3 * float(np.percentile(ticks, 99)),
    }


def differing(model: Model, samples: Samples) -> int:
    """Labels that differ from those of the whole recording at once, over random cuts into blocks."""
    random = np.random.default_rng(3)
    whole = _decided(model, samples, [len(samples)])
    return sum(
        one != other
        for _ in range(CUTS)
        for one, other in zip(_decided(model, samples, random.integers(1, 300, 64)), whole, strict=True)
    )


def _decided(model: Model, samples: Samples, blocks: Sequence[int] | NDArray[np.int64]) -> list[Decision]:
    stream = Stream(SETTING, range(ELECTRODES))
    stream.use(model, deciding(TABLE))
    found, first, turn = [], 0, 0
    while first < len(samples):
        size = int(blocks[turn % len(blocks)])
        found += stream.take(first, samples[first : first + size])
        first, turn = first + size, turn + 1
    return found


def rows() -> Iterator[Row]:
    """8 channels at 1 kHz, windows of 150 ms by 50 ms, a high-pass, MAV ZC SSC WL, linear discriminants."""
    model = model_of(performed(1, 3))
    samples = performed(2, 1).samples[: int(SECONDS * RATE_HZ)]
    for block in (10, 1):
        found, alone = asyncio.run(live(model, samples, block)), asyncio.run(idle(samples, block))
        which = f"on-line, blocks of {block}"
        yield Row(f"{which}: share of a core, with the loop, the device and the ring", found["share"], "%")
        yield at_most(f"{which}: share of a core that recognition adds", found["share"] - alone, "%", 5.0)
        yield Row(f"{which}: from the block's arrival to the decision, median", found["ours median"], "ms")
        yield at_most(f"{which}: from the block's arrival to the decision, p99", found["ours"], "ms", 2.0)
        yield at_most(f"{which}: the same in processor time, p99", found["spent"], "ms", 2.0)
        yield Row(f"{which}: from the completing sample, median", found["median"], "ms")
        yield Row(f"{which}: from the completing sample, p99, with this machine's timers", found["p99"], "ms")
        yield Row(f"{which}: from the completing sample to the tick that obeys, p99", found["servos"], "ms")
    count = differing(model, samples[:6000])
    yield at_most(f"labels and speeds unlike off-line ones, {CUTS} random cuts", count, "", 0)
