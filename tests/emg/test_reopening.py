"""A source that breaks is opened again, and its indices go on as if it had only lost samples."""

import asyncio
import logging
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from itertools import pairwise

import numpy as np
import pytest

from bentod.contracts import EmgSource
from bentod.emg.feed import Feed
from bentod.emg.reopening import WAITS_S, Reopening, reopening
from bentod.errors import ConfigError, InputFileError
from bentod.frames import EmgBlock
from sim.clock import VirtualClock

RATE_HZ = 200.0
SIZE = 2  # samples in a block
PULLED = InputFileError("The amplifier was unplugged.")


class Amplifier:
    """Blocks at their times from when it is opened; then it raises, ends, or goes on for ever."""

    def __init__(self, blocks: float, error: Exception | None = PULLED, channels: int = 1) -> None:
        self.rate_hz = RATE_HZ
        self.channels = channels
        self.blocks = blocks
        self.error = error
        self.open = False
        self.skips = 0  # samples at the beginning
        self.width = channels  # of its blocks

    async def __aiter__(self) -> AsyncIterator[EmgBlock]:
        loop = asyncio.get_running_loop()
        begun = loop.time()
        number = 0
        while number < self.blocks:
            first = self.skips + number * SIZE
            await asyncio.sleep(max(0.0, begun + (number + 1) * SIZE / RATE_HZ - loop.time()))
            values = np.full((SIZE, self.width), number, np.float32)
            yield EmgBlock(first, begun + number * SIZE / RATE_HZ, values)
            number += 1
        if self.error:
            raise self.error


class Bench:
    """Opens what is plugged in, one after the other; an exception there cannot be opened."""

    def __init__(self, *plugged: Amplifier | Exception) -> None:
        self.plugged = list(plugged)
        self.tries: list[float] = []

    @asynccontextmanager
    async def open(self) -> AsyncIterator[EmgSource]:
        self.tries.append(asyncio.get_running_loop().time())
        found = self.plugged.pop(0)
        if isinstance(found, Exception):
            raise found
        found.open = True
        try:
            yield found
        finally:
            found.open = False


class Listener:
    """What came out of a source, and what was told of it."""

    def __init__(self, source: Reopening) -> None:
        self.blocks: list[EmgBlock] = []
        self.told: list[tuple[float, str]] = []
        self._source = source
        source.lost = lambda why: self._note(why)
        source.back = lambda: self._note("")

    def _note(self, what: str) -> None:
        self.told.append((asyncio.get_running_loop().time(), what))

    async def listen(self, seconds: float) -> None:
        try:
            async with asyncio.timeout(seconds):
                async for block in self._source:
                    self.blocks.append(block)
        except TimeoutError:
            pass

    @property
    def indices(self) -> list[int]:
        return [block.first_index for block in self.blocks]


async def heard(bench: Bench, seconds: float) -> Listener:
    async with reopening(bench.open, VirtualClock()) as source:
        listener = Listener(source)
        await listener.listen(seconds)
    return listener


async def test_what_is_missing_while_a_source_is_away_is_dropped_and_nothing_shifts() -> None:
    listener = await heard(Bench(Amplifier(10), Amplifier(10)), 1.0)
    first, again = listener.blocks[0], listener.blocks[10]
    assert listener.indices[:10] == list(range(0, 20, 2))
    assert again.dropped == again.first_index - 20 == pytest.approx(WAITS_S[0] * RATE_HZ, abs=1)
    for block in listener.blocks:
        assert block.time == pytest.approx(first.time + block.first_index / RATE_HZ, abs=0.51 / RATE_HZ)
    assert [block.dropped for block in listener.blocks[11:]] == [0] * 9


async def test_a_source_that_counts_on_while_it_is_away_is_placed_by_the_times_of_its_blocks() -> None:
    other = Amplifier(5)
    other.skips = 5000
    listener = await heard(Bench(Amplifier(10), other), 0.8)
    assert listener.indices[10] == pytest.approx(20 + WAITS_S[0] * RATE_HZ, abs=1)
    assert np.diff(listener.indices[10:]).tolist() == [SIZE] * 4


async def test_a_source_that_gave_nothing_yet_begins_at_zero() -> None:
    listener = await heard(Bench(Amplifier(0), Amplifier(3)), 0.6)
    assert listener.indices == [0, 2, 4]
    assert listener.blocks[0].dropped == 0


async def test_one_that_cannot_be_opened_is_tried_less_and_less_often_but_for_ever() -> None:
    bench = Bench(Amplifier(1), *[InputFileError("there is no such port.")] * 9, Amplifier(5, None))
    listener = await heard(bench, 100.0)
    waits = [later - earlier for earlier, later in pairwise(bench.tries)]
    assert waits[1:] == pytest.approx([1.0, 2.0, 4.0, 8.0, 10.0, 10.0, 10.0, 10.0, 10.0])
    assert len(listener.blocks) == 6


async def test_one_that_lasts_is_opened_again_at_once_when_it_breaks_the_next_time() -> None:
    lasting = Amplifier(WAITS_S[1] * RATE_HZ / SIZE + 1)
    bench = Bench(Amplifier(1), Amplifier(1), Amplifier(1), lasting, Amplifier(1), Amplifier(1))
    await heard(bench, 20.0)
    waits = [later - earlier for earlier, later in pairwise(bench.tries)]
    assert waits[:3] == pytest.approx([0.51, 1.01, 2.01])
    assert waits[3] == pytest.approx(WAITS_S[1] + 0.01 + WAITS_S[0])
    assert waits[4] == pytest.approx(0.01 + 2 * WAITS_S[0])


async def test_why_it_is_away_is_told_until_it_is_back(caplog: pytest.LogCaptureFixture) -> None:
    bench = Bench(Amplifier(2), *[InputFileError("There is no such port.")] * 3, Amplifier(2, None))
    with caplog.at_level(logging.INFO):
        listener = await heard(bench, 20.0)
    assert [why for _, why in listener.told] == [
        "The EMG source broke: The amplifier was unplugged.",
        "The EMG source broke: The amplifier was unplugged. "
        "It cannot be opened again: There is no such port.",
        "",
    ]
    assert listener.told[0][0] == pytest.approx(0.02)
    assert [record.getMessage() for record in caplog.records] == [
        *(why for _, why in listener.told[:2]),
        "The EMG source is back after 7.5 s.",
    ]


async def test_a_source_that_ends_has_ended_for_good() -> None:
    bench = Bench(Amplifier(3, None), Amplifier(3))
    async with reopening(bench.open, VirtualClock()) as source:
        feed = Feed(source)
        await feed.pump()
    assert feed.problem(0.0) == "The EMG source ended after sample 5."
    assert len(bench.tries) == 1


@pytest.mark.parametrize("error", [ConfigError("no such option"), InputFileError("no such port")])
async def test_one_that_cannot_be_opened_at_the_start_is_an_error_at_the_start(error: Exception) -> None:
    with pytest.raises(type(error), match="no such"):
        async with reopening(Bench(error).open, VirtualClock()):
            pass


async def test_a_driver_with_a_bug_is_opened_again_and_its_traceback_is_logged(
    caplog: pytest.LogCaptureFixture,
) -> None:
    listener = await heard(Bench(Amplifier(1, ZeroDivisionError("division by zero")), Amplifier(4)), 0.6)
    assert listener.told[0][1] == "The EMG source broke: ZeroDivisionError: division by zero."
    assert "Traceback" in caplog.text
    assert len(listener.blocks) == 5


async def test_one_whose_indices_go_back_or_whose_channels_change_has_broken() -> None:
    stuttering, thin = Amplifier(3), Amplifier(3, channels=2)
    stuttering.skips = -1
    thin.width = 1
    listener = await heard(Bench(stuttering), 0.4)
    assert listener.told[0][1] == "The EMG source broke: sample -1 came after sample -1."
    listener = await heard(Bench(thin), 0.4)
    assert listener.told[0][1] == "The EMG source broke: a block of 1 channels came from 2 channels."


async def test_another_amplifier_in_its_place_is_not_taken_for_it() -> None:
    slower = Amplifier(3)
    slower.rate_hz = 100.0
    listener = await heard(Bench(Amplifier(1), Amplifier(3, channels=2), slower, Amplifier(3)), 5.0)
    reasons = [why for _, why in listener.told]
    assert reasons[1].endswith("It cannot be opened again: it has 2 channels at 200 Hz now; "
                               "it had 1 at 200 Hz.")  # fmt: skip
    assert reasons[2].endswith("it has 1 channels at 100 Hz now; it had 1 at 200 Hz.")
    assert len(listener.blocks) == 4


async def test_what_was_opened_is_closed_again_however_it_ends(clock: VirtualClock) -> None:
    broken, refused, whole = Amplifier(1), Amplifier(1, channels=2), Amplifier(1e9)
    bench = Bench(broken, refused, whole)
    async with reopening(bench.open, clock) as source:
        task = asyncio.create_task(Listener(source).listen(100.0))
        await clock.sleep_until(2.0)
        assert [amplifier.open for amplifier in (broken, refused, whole)] == [False, False, True]
        task.cancel()
        await asyncio.wait([task])
    assert not whole.open


async def test_it_can_be_closed_while_it_waits_for_a_source_to_come_back(clock: VirtualClock) -> None:
    async with reopening(Bench(Amplifier(1)).open, clock) as source:
        task = asyncio.create_task(Listener(source).listen(100.0))
        await clock.sleep_until(0.2)
        task.cancel()
        await asyncio.wait([task])
        assert task.cancelled()
    assert clock.now() == pytest.approx(0.2)


async def test_a_feed_of_a_source_that_breaks_is_dead_at_once_and_alive_when_it_is_back(
    clock: VirtualClock,
) -> None:
    async with reopening(Bench(Amplifier(20), Amplifier(1e9)).open, clock) as source:
        feed = Feed(source)
        source.lost, source.back = feed.lost, feed.back
        task = asyncio.create_task(feed.pump())
        await clock.sleep_until(0.205)
        assert feed.problem(clock.now()) == "The EMG source broke: The amplifier was unplugged."
        await clock.sleep_until(1.0)
        assert (feed.problem(clock.now()), feed.openings) == ("", 2)
        assert feed.dropped == pytest.approx(WAITS_S[0] * RATE_HZ, abs=1)
        assert np.isnan(feed.since(50)[:20]).all()
        task.cancel()
        await asyncio.wait([task])


async def test_the_clock_of_a_source_that_is_back_owes_nothing_to_the_one_before(
    clock: VirtualClock,
) -> None:
    feed = Feed(Amplifier(1))
    for second in range(20):  # a clock that loses 10 ms each second, as the feed has found out
        await clock.sleep_until(second + 0.01 * second)
        feed._take(EmgBlock(200 * second, float(second), np.zeros((200, 1), np.float32)))
    assert feed._drift.offset > 0.05
    feed.back()
    feed._take(EmgBlock(4000, clock.now(), np.zeros((2, 1), np.float32)))
    assert feed.alive(clock.now() + 0.005)
