import asyncio
import threading
import time

import numpy as np
import pytest

from bentod.errors import ConfigError, InputFileError
from bentod.frames import EmgBlock
from drivers.emg import reader_thread
from drivers.emg.reader_thread import Backlog, Threaded, reading


def block(first: int, count: int = 10, dropped: int = 0) -> EmgBlock:
    return EmgBlock(first, first / 1000, np.full((count, 2), first, np.float32), dropped)


class Fake:
    """A device that gives a block whenever the test lets it, and fails when it is told to."""

    def __init__(self) -> None:
        self.rate_hz = 1000.0
        self.channels = 2
        self.error: Exception | None = None
        self.stuck = threading.Event()
        self.stuck.set()
        self.closed = threading.Event()
        self.threads: set[str] = set()
        self._allowed = threading.Semaphore(0)
        self._next = 0

    def allow(self, blocks: int) -> None:
        self._allowed.release(blocks)

    def open(self) -> "Fake":
        self.threads.add(threading.current_thread().name)
        return self

    def read(self) -> EmgBlock | None:
        self.threads.add(threading.current_thread().name)
        self.stuck.wait()
        if self._allowed.acquire(timeout=0.001):
            self._next += 10
            return block(self._next - 10)
        if self.error:
            raise self.error
        return None

    def close(self) -> None:
        self.threads.add(threading.current_thread().name)
        self.closed.set()


async def rest(source: Threaded, taken: list[EmgBlock] | None = None) -> None:
    """Take all that there is."""
    async for each in source:
        if taken is not None:
            taken.append(each)


@pytest.fixture
def fake() -> Fake:
    return Fake()


def test_a_backlog_gives_blocks_in_order() -> None:
    backlog = Backlog(100)
    for first in (0, 10, 20):
        backlog.put(block(first))
    assert [taken.first_index for taken in iter(backlog.take, None)] == [0, 10, 20]


def test_a_backlog_that_overflows_keeps_the_newest_block_and_counts_what_it_lost() -> None:
    backlog = Backlog(100)
    for first in range(0, 260, 10):
        backlog.put(block(first, dropped=3 if first == 50 else 0))
    taken = backlog.take()
    assert taken is not None
    assert (taken.first_index, taken.dropped) == (250, 253)
    assert backlog.take() is None


def test_a_backlog_holds_all_again_once_it_was_emptied() -> None:
    backlog = Backlog(20)
    for first in (0, 10, 20, 30):
        backlog.put(block(first))
    backlog.take()
    backlog.put(block(40))
    backlog.put(block(50, dropped=7))
    taken = [backlog.take(), backlog.take()]
    assert [(b.first_index, b.dropped) for b in taken if b] == [(40, 0), (50, 7)]


@pytest.mark.real_time
async def test_a_device_lives_in_one_thread_which_is_not_the_loops(fake: Fake) -> None:
    async with reading(fake.open, "A fake") as source:
        assert (source.rate_hz, source.channels) == (1000.0, 2)
        fake.allow(1)
        assert (await anext(aiter(source))).first_index == 0
    assert fake.closed.is_set()
    assert fake.threads == {"EMG A fake"}


@pytest.mark.real_time
async def test_what_was_read_before_an_error_comes_before_the_error(fake: Fake) -> None:
    fake.error = InputFileError("It was unplugged.")
    fake.allow(3)
    taken: list[EmgBlock] = []
    async with reading(fake.open, "A fake") as source:
        with pytest.raises(InputFileError, match=r"^It was unplugged\.$"):
            await rest(source, taken)
    assert [each.first_index for each in taken] == [0, 10, 20]
    assert fake.closed.is_set()


@pytest.mark.real_time
async def test_an_error_that_nobody_foresaw_is_a_sentence_too(
    fake: Fake, caplog: pytest.LogCaptureFixture
) -> None:
    fake.error = KeyError("x")
    async with reading(fake.open, "A fake") as source:
        with pytest.raises(InputFileError, match=r"A fake broke: KeyError: 'x'\."):
            await rest(source)
    assert fake.closed.is_set()
    assert "A fake broke" in caplog.text


@pytest.mark.real_time
async def test_a_device_that_is_silent_for_too_long_has_broken(fake: Fake) -> None:
    async with reading(fake.open, "A fake", silent_s=0.03) as source:
        with pytest.raises(InputFileError, match=r"A fake has given no sample for 0\.03 s\."):
            await rest(source)


@pytest.mark.real_time
async def test_a_late_consumer_is_told_what_was_lost(fake: Fake) -> None:
    async with reading(fake.open, "A fake", buffer_s=0.1) as source:
        fake.allow(1)
        first = await anext(aiter(source))
        fake.allow(30)
        fake.error = InputFileError("over")
        blocks: list[EmgBlock] = []
        while not fake.closed.is_set():
            time.sleep(0.001)  # noqa: ASYNC251 -- nobody takes anything
        with pytest.raises(InputFileError, match="over"):
            await rest(source, blocks)
    assert first.dropped == 0
    assert [(each.first_index, each.dropped) for each in blocks] == [(300, 290)]


@pytest.mark.real_time
@pytest.mark.parametrize("error", [InputFileError("not there"), ConfigError("not such a rate", "rate_hz")])
async def test_a_device_that_does_not_open_says_why(error: Exception) -> None:
    def refuse() -> Fake:
        raise error

    with pytest.raises(type(error), match=str(error)):
        async with reading(refuse, "A fake"):
            pass


@pytest.mark.real_time
async def test_a_device_that_opens_too_late_is_closed_when_it_does(
    fake: Fake, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(reader_thread, "OPEN_S", 0.01)
    monkeypatch.setattr(reader_thread, "CLOSE_S", 0.01)
    go = threading.Event()

    def slow() -> Fake:
        go.wait()
        return fake

    with pytest.raises(InputFileError, match=r"A fake has not opened within 0\.01 s\."):
        async with reading(slow, "A fake"):
            pass
    assert not fake.closed.is_set()
    go.set()
    await asyncio.to_thread(fake.closed.wait)


@pytest.mark.real_time
async def test_a_device_that_is_stuck_holds_nobody_up_and_is_closed_when_it_comes_loose(fake: Fake) -> None:
    async with reading(fake.open, "A fake"):
        fake.stuck.clear()
        await asyncio.sleep(0.01)
    assert not fake.closed.is_set()
    fake.stuck.set()
    await asyncio.to_thread(fake.closed.wait)


@pytest.mark.real_time
async def test_a_loop_that_waits_for_blocks_does_other_things_meanwhile(fake: Fake) -> None:
    async with reading(fake.open, "A fake") as source:
        taken: list[EmgBlock] = []
        waiting = asyncio.create_task(rest(source, taken))
        for _ in range(5):
            await asyncio.sleep(0.002)
        assert not taken
        fake.allow(1)
        fake.error = InputFileError("over")
        with pytest.raises(InputFileError, match="over"):
            await waiting
        assert [each.first_index for each in taken] == [0]
