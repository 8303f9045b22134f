"""What every source of muscle signals must keep, whoever made it."""

import asyncio
from collections.abc import Callable, Mapping
from contextlib import AbstractAsyncContextManager
from dataclasses import dataclass
from pathlib import Path
from typing import TypeAlias

import numpy as np
import pytest

from bentod.contracts import EmgConfig, EmgSource, OpenEmg
from bentod.errors import ConfigError
from bentod.frames import EmgBlock, Value
from drivers.emg import replay
from sim import emg
from sim.clock import VirtualClock

RATE_HZ = 200.0
CHANNELS = 3

Open: TypeAlias = Callable[..., AbstractAsyncContextManager[EmgSource]]


@dataclass(frozen=True, slots=True)
class Implementation:
    """A source, and how a test gets one."""

    open: OpenEmg
    prepare: Callable[[Path], Mapping[str, Value]]


def npz(folder: Path) -> Mapping[str, Value]:
    counts = np.random.default_rng(1).integers(-60, 60, (331, CHANNELS), dtype=np.int8)
    np.savez(folder / "recording.npz", emg=counts, fs=RATE_HZ)
    return {"file": str(folder / "recording.npz")}


def csv(folder: Path) -> Mapping[str, Value]:
    volts = np.random.default_rng(1).normal(0, 2e-5, (331, CHANNELS))
    table = np.column_stack((np.arange(331) / RATE_HZ, volts))
    np.savetxt(folder / "recording.csv", table, delimiter=",", header="time,a,b,c", comments="")
    return {"file": str(folder / "recording.csv")}


IMPLEMENTATIONS = {
    "synthetic": Implementation(emg.open_emg, lambda folder: {}),
    "replay of npz": Implementation(replay.open_emg, npz),
    "replay of csv": Implementation(replay.open_emg, csv),
}


@pytest.fixture(params=sorted(IMPLEMENTATIONS))
def opened(request: pytest.FixtureRequest, tmp_path: Path, clock: VirtualClock) -> Open:
    """Opens a source with further options."""
    implementation = IMPLEMENTATIONS[request.param]
    options = implementation.prepare(tmp_path)

    def opening(**more: Value) -> AbstractAsyncContextManager[EmgSource]:
        return implementation.open(EmgConfig(RATE_HZ, CHANNELS, {**options, **more}), clock)

    return opening


class Consumer:
    """Takes blocks and notes when they came; pauses once, after `pause_at` blocks, for `pause_s`."""

    def __init__(self, clock: VirtualClock, pause_at: int = -1, pause_s: float = 0.0) -> None:
        self.blocks: list[EmgBlock] = []
        self.arrivals: list[float] = []
        self._clock = clock
        self._pause = pause_at, pause_s

    async def listen(self, opening: AbstractAsyncContextManager[EmgSource], seconds: float) -> EmgSource:
        async with opening as source:
            task = asyncio.create_task(self._consume(source))
            await self._clock.sleep_until(self._clock.now() + seconds)
            task.cancel()
            await asyncio.wait([task])
            return source

    async def _consume(self, source: EmgSource) -> None:
        async for block in source:
            self.blocks.append(block)
            self.arrivals.append(self._clock.now())
            if len(self.blocks) == self._pause[0]:
                await self._clock.sleep_until(self._clock.now() + self._pause[1])

    def samples(self) -> "np.typing.NDArray[np.float32]":
        return np.concatenate([block.samples for block in self.blocks])

    def lost_by_index(self) -> list[int]:
        ends = [block.first_index + len(block.samples) for block in self.blocks]
        return [block.first_index - end for block, end in zip(self.blocks, [0, *ends[:-1]], strict=True)]


async def test_samples_arrive_at_the_stated_rate(opened: Open, clock: VirtualClock) -> None:
    consumer = Consumer(clock)
    source = await consumer.listen(opened(), 10.0)
    assert source.rate_hz == pytest.approx(RATE_HZ)
    assert len(consumer.samples()) == pytest.approx(10 * RATE_HZ, abs=len(consumer.blocks[0].samples))


async def test_indices_run_from_zero_without_a_gap(opened: Open, clock: VirtualClock) -> None:
    consumer = Consumer(clock)
    await consumer.listen(opened(), 5.0)
    assert set(consumer.lost_by_index()) == {0}
    assert {block.dropped for block in consumer.blocks} == {0}


async def test_times_follow_the_indices(opened: Open, clock: VirtualClock) -> None:
    consumer = Consumer(clock)
    source = await consumer.listen(opened(), 5.0)
    start = consumer.blocks[0].time
    for block in consumer.blocks:
        assert block.time == pytest.approx(start + block.first_index / source.rate_hz, abs=1e-6)


async def test_a_block_arrives_when_its_last_sample_has_been_taken(opened: Open, clock: VirtualClock) -> None:
    consumer = Consumer(clock)
    source = await consumer.listen(opened(), 5.0)
    for block, arrival in zip(consumer.blocks, consumer.arrivals, strict=True):
        assert arrival == pytest.approx(block.time + (len(block.samples) - 1) / source.rate_hz, abs=1e-6)


async def test_blocks_are_volts_of_every_channel(opened: Open, clock: VirtualClock) -> None:
    consumer = Consumer(clock)
    source = await consumer.listen(opened(), 5.0)
    samples = consumer.samples()
    assert samples.dtype == np.float32
    assert samples.shape[1] == source.channels >= CHANNELS
    assert np.isfinite(samples).all()
    assert 1e-6 < np.abs(samples).mean() < 1e-3


async def test_blocks_come_often_enough_to_notice_a_stall(opened: Open, clock: VirtualClock) -> None:
    consumer = Consumer(clock)
    await consumer.listen(opened(), 2.0)
    assert np.diff(consumer.arrivals).max() <= 0.05 + 1e-6


async def test_the_same_source_gives_the_same_samples_however_they_are_cut(
    opened: Open, clock: VirtualClock
) -> None:
    small, large = Consumer(clock), Consumer(clock)
    await small.listen(opened(block_s=0.005), 3.0)
    await large.listen(opened(block_s=0.035), 3.0)
    assert len(small.blocks[0].samples) == 1
    assert len(large.blocks[0].samples) == 7
    shared = len(large.samples())
    np.testing.assert_array_equal(small.samples()[:shared], large.samples())


async def test_a_late_consumer_gets_every_sample_at_its_own_time(opened: Open, clock: VirtualClock) -> None:
    consumer = Consumer(clock, pause_at=10, pause_s=0.5)
    source = await consumer.listen(opened(), 2.0)
    assert set(consumer.lost_by_index()) == {0}
    late = consumer.blocks[10]
    assert late.time == pytest.approx(consumer.blocks[0].time + late.first_index / source.rate_hz, abs=1e-6)
    assert consumer.arrivals[10] - late.time > 0.4
    assert consumer.arrivals[-1] - consumer.blocks[-1].time < 0.05


async def test_a_consumer_that_is_too_late_is_told_what_it_lost(opened: Open, clock: VirtualClock) -> None:
    consumer = Consumer(clock, pause_at=10, pause_s=3.0)
    await consumer.listen(opened(buffer_s=1.0), 5.0)
    lost = [block.dropped for block in consumer.blocks]
    assert lost == consumer.lost_by_index()
    assert lost[10] == pytest.approx(3.0 * RATE_HZ, abs=10)
    assert sum(lost) == lost[10]
    assert consumer.arrivals[10] - consumer.blocks[10].time < 0.05


async def test_a_source_that_is_iterated_again_goes_on_where_it_is(opened: Open, clock: VirtualClock) -> None:
    async with opened() as source:
        first = await anext(aiter(source))
        await clock.sleep_until(clock.now() + 0.5)
        second = await anext(aiter(source))
    assert second.first_index == first.first_index + len(first.samples)


async def test_a_source_stops_within_100_ms_and_leaves_nothing_running(
    opened: Open, clock: VirtualClock
) -> None:
    async with opened() as source:
        consumer = asyncio.create_task(Consumer(clock)._consume(source))
        await clock.sleep_until(clock.now() + 0.123)
        before = clock.now()
        consumer.cancel()
        await asyncio.wait([consumer])
    assert clock.now() - before < 0.1
    assert consumer.cancelled()
    assert asyncio.all_tasks() == {asyncio.current_task()}


async def test_an_unknown_option_is_refused_with_the_nearest_one(opened: Open) -> None:
    with pytest.raises(ConfigError, match=r"'buffer' is unknown; did you mean 'buffer_s'\?"):
        async with opened(buffer=1.0):
            pass


async def test_a_block_that_would_hide_a_stall_is_refused(opened: Open) -> None:
    with pytest.raises(ConfigError, match=r"'block_s' is 0\.2: .*less than or equal to 0\.05"):
        async with opened(block_s=0.2):
            pass
