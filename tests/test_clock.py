import asyncio
import os
import select
from collections.abc import AsyncIterator
from contextvars import ContextVar

import pytest

import bentod.clock
from bentod.clock import SystemClock

pytestmark = pytest.mark.real_time


@pytest.fixture(params=["kernel", "loop"])
async def clock(request: pytest.FixtureRequest) -> AsyncIterator[SystemClock]:
    async with SystemClock(precise=request.param == "kernel") as clock:
        yield clock


def open_files() -> int:
    return len(os.listdir("/proc/self/fd"))


async def test_the_clock_agrees_with_the_event_loop(clock: SystemClock) -> None:
    before, now = asyncio.get_running_loop().time(), clock.now()
    assert before <= now <= asyncio.get_running_loop().time()


async def test_nobody_wakes_before_the_deadline(clock: SystemClock) -> None:
    for k in range(1, 20):
        deadline = clock.now() + k * 0.000_37
        await clock.sleep_until(deadline)
        assert clock.now() >= deadline


async def test_sleepers_wake_in_the_order_of_their_deadlines(clock: SystemClock) -> None:
    start, woken = clock.now() + 0.05, list[float]()

    async def sleep(after: float) -> None:
        await clock.sleep_until(start + after)
        woken.append(after)

    await asyncio.gather(*(sleep(after) for after in (0.03, 0.01, 0.05, -1.0, 0.04, 0.02)))
    assert woken == [-1.0, 0.01, 0.02, 0.03, 0.04, 0.05]


async def test_a_sleeper_goes_on_before_whatever_became_ready_with_it() -> None:
    loop = asyncio.get_running_loop()
    order: list[str] = []
    async with SystemClock() as clock:

        async def sleep() -> None:
            await clock.sleep_until(deadline)
            order.append("sleeper")

        deadline = clock.now() + 0.002
        sleeper = asyncio.create_task(sleep())
        await asyncio.sleep(0)
        while clock.now() < deadline + 0.001:  # the loop is busy while the timer expires
            pass
        loop.call_soon(lambda: loop.call_soon(order.append, "the next round"))
        await sleeper
        await asyncio.sleep(0)
    assert order == ["sleeper", "the next round"]


async def test_a_sleeper_keeps_its_context_and_its_task() -> None:
    variable: ContextVar[int] = ContextVar("variable", default=0)
    seen: list[tuple[int, asyncio.Task[None] | None]] = []

    async def sleep(clock: SystemClock, number: int) -> None:
        variable.set(number)
        for _ in range(3):
            await clock.sleep_until(clock.now() + 0.001)
            seen.append((variable.get(), asyncio.current_task()))

    async with SystemClock() as clock:
        tasks = [asyncio.create_task(sleep(clock, number)) for number in (1, 2)]
        await asyncio.gather(*tasks)
        assert asyncio.current_task() not in tasks
    assert sorted(number for number, _ in seen) == [1, 1, 1, 2, 2, 2]
    assert all(task is tasks[number - 1] for number, task in seen)
    assert variable.get() == 0


async def test_a_sleeper_that_breaks_breaks_only_itself(clock: SystemClock) -> None:
    async def sleep() -> None:
        await clock.sleep_until(clock.now() + 0.001)
        raise ValueError("broken")

    with pytest.raises(ValueError, match="broken"):
        await asyncio.create_task(sleep())
    deadline = clock.now() + 0.002
    await clock.sleep_until(deadline)
    assert clock.now() >= deadline


async def test_a_deadline_in_the_past_still_gives_others_a_turn(clock: SystemClock) -> None:
    other = asyncio.create_task(asyncio.sleep(0))
    await clock.sleep_until(clock.now() - 1)
    await clock.sleep_until(clock.now() - 1)
    assert other.done()


async def test_a_cancelled_sleeper_leaves_the_clock_usable(clock: SystemClock) -> None:
    for _ in range(3):
        with pytest.raises(TimeoutError):
            async with asyncio.timeout(0.003):
                await clock.sleep_until(clock.now() + 60)
    deadline = clock.now() + 0.005
    await clock.sleep_until(deadline)
    assert clock.now() >= deadline


async def test_a_timer_whose_sleeper_was_cancelled_does_not_keep_the_loop_busy() -> None:
    async with SystemClock() as clock:
        sleeper = asyncio.create_task(clock.sleep_until(clock.now() + 0.05))
        await asyncio.sleep(0)
        sleeper.cancel()
        await asyncio.wait([sleeper])
        await asyncio.sleep(0.06)
        (timer,) = clock._idle
        assert select.select([timer._file], [], [], 0) == ([], [], [])


def test_a_clock_may_outlive_an_event_loop() -> None:
    clock = SystemClock()
    for _ in range(3):
        deadline = clock.now() + 0.003
        asyncio.run(clock.sleep_until(deadline))
        assert clock.now() >= deadline
    clock.close()


async def test_an_expiry_that_nobody_saw_does_not_wake_the_next_sleeper() -> None:
    async with SystemClock() as clock:
        sleeper = asyncio.create_task(clock.sleep_until(clock.now() + 0.002))
        await asyncio.sleep(0)
        deadline = clock.now() + 0.004
        while clock.now() < deadline:  # the loop is busy while the timer expires
            pass
        sleeper.cancel()
        await asyncio.wait([sleeper])
        deadline = clock.now() + 0.01
        await clock.sleep_until(deadline)
        assert clock.now() >= deadline


async def test_timers_are_used_again_and_given_back_at_the_end() -> None:
    before = open_files()
    async with SystemClock() as clock:
        for _ in range(5):
            await clock.sleep_until(clock.now() + 0.001)
        assert open_files() <= before + 1
    assert open_files() == before


async def test_a_sleeper_that_outlives_the_clock_gives_its_timer_back() -> None:
    before = open_files()
    clock = SystemClock()
    sleeper = asyncio.create_task(clock.sleep_until(clock.now() + 0.01))
    await asyncio.sleep(0)
    clock.close()
    await sleeper
    assert open_files() == before


async def test_without_file_descriptors_the_loop_wakes_the_sleeper(monkeypatch: pytest.MonkeyPatch) -> None:
    def exhausted() -> int:
        raise OSError(24, "Too many open files")

    async with SystemClock() as clock:
        monkeypatch.setattr(bentod.clock, "_create_timer", exhausted)
        deadline = clock.now() + 0.005
        await clock.sleep_until(deadline)
        assert clock.now() >= deadline


@pytest.mark.parametrize("error", [AttributeError("no such function"), OSError(38, "not implemented")])
def test_a_system_without_kernel_timers_is_recognised(
    monkeypatch: pytest.MonkeyPatch, error: Exception
) -> None:
    def absent() -> int:
        raise error

    monkeypatch.setattr(bentod.clock, "_create_timer", absent)
    assert not SystemClock().precise
