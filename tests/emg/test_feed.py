import asyncio
import math
import re
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import numpy as np
import pytest

from bentod.contracts import EmgConfig, EmgSource
from bentod.emg.feed import Feed
from bentod.errors import ConfigError, InputFileError
from bentod.frames import EmgBlock
from sim.clock import VirtualClock
from sim.emg import Synthetic, open_emg


class Wire:
    """A source that delivers what a test puts into it."""

    def __init__(self) -> None:
        self.rate_hz = 200.0
        self.channels = 1
        self._queue: asyncio.Queue[EmgBlock | Exception | None] = asyncio.Queue()

    async def __aiter__(self) -> AsyncIterator[EmgBlock]:
        while (item := await self._queue.get()) is not None:
            if isinstance(item, Exception):
                raise item
            yield item

    async def put(self, item: EmgBlock | Exception | None) -> None:
        self._queue.put_nowait(item)
        for _ in range(3):  # until the feed has taken it
            await asyncio.sleep(0)

    async def deliver(self, first: int, time: float, *values: float) -> None:
        await self.put(EmgBlock(first, time, np.array(values, np.float32)[:, np.newaxis]))


@asynccontextmanager
async def pumping(source: EmgSource, stall_s: float = 0.06) -> AsyncIterator[Feed]:
    feed = Feed(source, stall_s)
    task = asyncio.create_task(feed.pump())
    await asyncio.sleep(0)
    try:
        yield feed
    finally:
        task.cancel()
        await asyncio.wait([task])


@asynccontextmanager
async def wearer(clock: VirtualClock) -> AsyncIterator[tuple[Synthetic, Feed]]:
    """A simulated wearer who has been listened to for a second."""
    async with open_emg(EmgConfig(200.0, 3, {}), clock) as source, pumping(source) as feed:
        await clock.sleep_until(1.0)
        yield source, feed


async def test_before_the_first_sample_a_feed_is_not_alive() -> None:
    async with pumping(Wire()) as feed:
        assert feed.problem(0.0) == "No EMG sample has arrived yet."


async def test_a_feed_with_fresh_samples_is_alive(clock: VirtualClock) -> None:
    async with wearer(clock) as (_, feed):
        assert feed.alive(clock.now())
        assert feed.age(clock.now()) < 0.011
        assert len(feed.since(100)) == feed.ring.next_index - 100


async def test_a_feed_stays_alive_all_the_time_while_samples_come(clock: VirtualClock) -> None:
    async with wearer(clock) as (_, feed):
        for step in range(500):
            await clock.sleep_until(1.0 + 0.0071 * step)
            assert feed.problem(clock.now()) == ""


async def test_a_source_that_stalls_is_found_out_within_100_ms_and_believed_when_it_is_back(
    clock: VirtualClock,
) -> None:
    async with wearer(clock) as (source, feed):
        source.stall = True
        await clock.sleep_until(1.1)
        assert re.fullmatch(r"No EMG sample for 0.1\d s; the bound is 0.06 s.", feed.problem(clock.now()))
        source.stall = False
        await clock.sleep_until(1.15)
        assert feed.alive(clock.now())
        assert feed.dropped == pytest.approx(20, abs=4)
        assert np.isnan(feed.since(205)[:5]).all()


async def test_a_source_that_ends_is_found_out_within_100_ms_for_good(clock: VirtualClock) -> None:
    async with wearer(clock) as (source, feed):
        source.end = True
        await clock.sleep_until(1.1)
        assert feed.problem(clock.now()).startswith("The EMG source ended after sample ")
        source.end = False
        await clock.sleep_until(2.0)
        assert not feed.alive(clock.now())


async def test_samples_that_come_late_are_not_believed_until_they_are_in_time(clock: VirtualClock) -> None:
    async with wearer(clock) as (source, feed):
        source.late = 0.3
        await clock.sleep_until(1.1)
        assert feed.problem(clock.now()).startswith("No EMG sample for 0.1")
        await clock.sleep_until(2.0)
        assert re.fullmatch(
            r"EMG samples are 0.3\d s old when they come; the bound is 0.06 s.", feed.problem(clock.now())
        )
        source.late = 0.0
        await clock.sleep_until(2.5)
        assert feed.alive(clock.now())


@pytest.mark.parametrize(("drift", "seconds"), [(0.01, 120), (-0.01, 28)])
async def test_a_source_whose_clock_drifts_is_believed(
    clock: VirtualClock, drift: float, seconds: float
) -> None:
    async with wearer(clock) as (source, feed):
        source.drift = drift
        while clock.now() < seconds:
            await clock.sleep_until(clock.now() + 0.0201)
            assert feed.problem(clock.now()) == ""
            assert abs(feed.age(clock.now())) < 0.04


async def test_a_source_that_grows_later_and_later_is_found_out(clock: VirtualClock) -> None:
    async with wearer(clock) as (source, feed):
        source.drift = -0.01
        await clock.sleep_until(50.0)
        assert "old when they come" in feed.problem(clock.now())


async def test_a_drifting_source_that_dies_is_found_out_all_the_same(clock: VirtualClock) -> None:
    async with wearer(clock) as (source, feed):
        source.drift = 0.01
        await clock.sleep_until(30.0)
        source.stall = True
        await clock.sleep_until(30.1)
        assert feed.problem(clock.now()).startswith("No EMG sample for 0.")


async def test_samples_that_are_not_numbers_are_found_out_within_100_ms(clock: VirtualClock) -> None:
    async with wearer(clock) as (source, feed):
        source.nan = True
        await clock.sleep_until(1.1)
        assert feed.problem(clock.now()).endswith("of channel 2 is not a finite number.")
        source.nan = False
        await clock.sleep_until(1.2)
        assert feed.alive(clock.now())


async def test_one_infinite_sample_is_held_against_the_source_for_a_while() -> None:
    wire = Wire()
    async with pumping(wire) as feed:
        await wire.deliver(0, 0.0, 1e-6, np.inf)
        await wire.deliver(2, 0.01, 1e-6, 1e-6)
        assert feed.problem(0.02) == "EMG sample 1 of channel 0 is not a finite number."
        await wire.deliver(4, 0.1, 1e-6, 1e-6)
        assert feed.alive(0.11)


async def test_a_source_that_raises_leaves_its_sentence(caplog: pytest.LogCaptureFixture) -> None:
    wire = Wire()
    async with pumping(wire) as feed:
        await wire.deliver(0, 0.0, 1e-6)
        await wire.put(InputFileError("the amplifier was unplugged."))
        assert feed.problem(0.0) == "The EMG source broke: the amplifier was unplugged."
    assert "unplugged" in caplog.text


async def test_a_source_with_a_bug_does_not_take_the_daemon_along(caplog: pytest.LogCaptureFixture) -> None:
    wire = Wire()
    async with pumping(wire) as feed:
        await wire.put(ZeroDivisionError("division by zero"))
        assert feed.problem(0.0) == "The EMG source broke: ZeroDivisionError: division by zero."
    assert "Traceback" in caplog.text


async def test_a_source_whose_indices_go_back_is_not_believed(caplog: pytest.LogCaptureFixture) -> None:
    wire = Wire()
    async with pumping(wire) as feed:
        await wire.deliver(0, 0.0, 1e-6, 1e-6)
        await wire.deliver(0, 0.01, 1e-6, 1e-6)
        assert "sample 0 came after sample 1" in feed.problem(0.0)


async def test_a_source_whose_clock_runs_ahead_is_not_believed() -> None:
    wire = Wire()
    async with pumping(wire) as feed:
        await wire.deliver(0, 10.0, 1e-6)
        assert feed.problem(1.0) == "EMG samples are stamped 9.00 s ahead of the clock."


async def test_lost_samples_are_counted() -> None:
    wire = Wire()
    async with pumping(wire) as feed:
        await wire.deliver(0, 0.0, 1e-6)
        await wire.deliver(4, 0.02, 1e-6)
        await wire.deliver(7, 0.035, 1e-6)
        assert feed.dropped == 5


async def test_an_empty_block_says_nothing() -> None:
    wire = Wire()
    async with pumping(wire) as feed:
        await wire.put(EmgBlock(0, 0.0, np.empty((0, 1), np.float32)))
        assert feed.problem(0.0) == "No EMG sample has arrived yet."


async def test_cancelling_the_pump_is_not_swallowed(clock: VirtualClock) -> None:
    async with open_emg(EmgConfig(200.0, 3, {}), clock) as source:
        task = asyncio.create_task(Feed(source).pump())
        await clock.sleep_until(0.5)
        task.cancel()
        await asyncio.wait([task])
        assert task.cancelled()


@pytest.mark.parametrize("stall_s", [0.009, 0.11, float("nan")])
def test_a_stall_that_would_last_too_long_is_refused(stall_s: float) -> None:
    with pytest.raises(ConfigError, match=r"must be from 0\.01 to 0\.1 s"):
        Feed(Wire(), stall_s)


async def test_a_time_that_is_no_number_is_not_taken_for_now(clock: VirtualClock) -> None:
    wire = Wire()
    async with pumping(wire) as feed:
        await wire.deliver(0, math.nan, 1.0)
        assert feed.problem(clock.now()) == "The time of the newest EMG sample is not a number."
        await wire.deliver(1, clock.now(), 1.0)
        assert feed.alive(clock.now())
