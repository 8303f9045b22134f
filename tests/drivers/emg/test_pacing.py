import pytest

from bentod.errors import ConfigError
from drivers.emg.pacing import Pacer
from sim.clock import VirtualClock


async def test_time_starts_with_the_first_wish(clock: VirtualClock) -> None:
    pacer = Pacer(clock, 200.0, 0.01, 1.0)
    await clock.sleep_until(7.0)
    slot = await pacer.next()
    assert (slot.first, slot.size, slot.time, slot.dropped) == (0, 2, 7.0, 0)
    assert clock.now() == pytest.approx(7.005)


async def test_deadlines_do_not_drift(clock: VirtualClock) -> None:
    pacer = Pacer(clock, 333.0, 0.01, 1.0)
    for _ in range(10_000):
        slot = await pacer.next()
    assert slot.first == 9_999 * 3
    assert clock.now() == pytest.approx((slot.first + 2) / 333.0, abs=1e-9)


@pytest.mark.parametrize(("late", "dropped"), [(0.9, 0), (1.1, 220), (100.0, 20_000)])
async def test_a_queue_overflows_once_and_keeps_the_newest_block(
    clock: VirtualClock, late: float, dropped: int
) -> None:
    pacer = Pacer(clock, 200.0, 0.01, 1.0)
    await pacer.next()
    await clock.sleep_until(0.015 + late + 0.001)
    slot = await pacer.next()
    assert slot.dropped == dropped
    assert slot.first == 2 + dropped
    assert slot.time == pytest.approx(slot.first / 200.0)
    assert (await pacer.next()).dropped == 0


async def test_a_block_is_at_least_one_sample(clock: VirtualClock) -> None:
    assert (await Pacer(clock, 50.0, 0.001, 1.0).next()).size == 1


def test_a_rate_too_slow_to_notice_a_stall_is_refused(clock: VirtualClock) -> None:
    with pytest.raises(ConfigError, match="at 5 Hz; the bound is 20 Hz"):
        Pacer(clock, 5.0, 0.01, 1.0)
