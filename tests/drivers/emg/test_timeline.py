import random

import pytest

from drivers.emg.timeline import QUARTZ, Timeline

RATE_HZ = 1000.0
BLOCK = 10


def delays(
    seconds: float, *, clock: float = 1.0, jitter: float = 0.0, timeline: Timeline | None = None
) -> list[float]:
    """How old the newest sample of each block is said to be when it arrives, beyond what its way took (s).

    `clock`: how many samples the device takes where 1 is due; `jitter`: s that a block may take on its way.
    """
    line = timeline or Timeline(RATE_HZ)
    chance = random.Random(1)
    found, arrival = [], 0.0
    for number in range(1, int(seconds * RATE_HZ * clock) // BLOCK):
        taken = 100.0 + number * BLOCK / (RATE_HZ * clock)
        arrival = max(arrival, taken + chance.uniform(0, jitter))
        _, time = line.place(BLOCK, arrival)
        found.append(taken - (time + (BLOCK - 1) / RATE_HZ))
    return found


def test_indices_count_samples_and_what_was_lost() -> None:
    line = Timeline(RATE_HZ)
    assert [line.place(*step)[0] for step in ((10, 1.0, 0), (10, 1.01, 0), (5, 1.1, 80))] == [0, 10, 100]
    assert line.next_index == 105


def test_no_sample_is_stamped_later_than_it_arrived() -> None:
    line = Timeline(RATE_HZ)
    chance = random.Random(2)
    for number in range(1000):
        arrival = 50.0 + number * 0.01 + chance.uniform(0, 0.03)
        first, time = line.place(10, arrival)
        assert time + (line.next_index - 1 - first) / RATE_HZ <= arrival + 1e-9


def test_bursts_do_not_move_the_stamps() -> None:
    settled = delays(20.0, jitter=0.016)[300:]
    assert max(settled) - min(settled) < 0.002
    assert abs(settled[-1]) < 0.002


def test_a_first_block_that_was_held_up_is_forgiven() -> None:
    line = Timeline(RATE_HZ)
    line.place(BLOCK, 100.5)
    for _ in range(50):  # what had piled up comes at once
        line.place(BLOCK, 100.5)
    _, time = line.place(BLOCK, 100.51)
    assert time == pytest.approx(100.51 - (BLOCK - 1) / RATE_HZ)
    assert not line.trouble


@pytest.mark.parametrize("share", [-0.02, -QUARTZ, 0.0, QUARTZ / 2, QUARTZ])
def test_a_clock_that_is_fast_or_as_slow_as_quartz_does_not_accumulate(share: float) -> None:
    line = Timeline(RATE_HZ)
    found = delays(600.0, clock=1 - share, jitter=0.002, timeline=line)
    assert max(abs(delay) for delay in found[300:]) < 0.003
    assert not line.trouble


def test_a_clock_of_a_known_slowness_is_followed() -> None:
    line = Timeline(RATE_HZ, slow=0.005)
    assert max(delays(300.0, clock=0.996, timeline=line)) < 0.01
    assert not line.trouble


def test_a_clock_that_is_slower_than_quartz_shows_and_is_measured() -> None:
    line = Timeline(RATE_HZ)
    found = delays(60.0, clock=0.99, jitter=0.005, timeline=line)
    assert found[1000] == pytest.approx(0.1, abs=0.02)
    assert "it gave 990." in line.trouble
    assert "not 1000" in line.trouble


@pytest.mark.parametrize(
    ("late", "told"), [(0.0, ""), (0.02, ""), (0.08, "0.08 s late"), (1.5, "1.50 s late")]
)
def test_samples_that_are_late_for_good_are_trouble_within_two_seconds(late: float, told: str) -> None:
    line = Timeline(RATE_HZ)
    for number in range(300):
        line.place(BLOCK, 100.0 + number * 0.01)
    for number in range(300, 500):
        line.place(BLOCK, 100.0 + number * 0.01 + late)
    assert told in line.trouble
    assert bool(line.trouble) is bool(told)


def test_a_stall_whose_samples_come_after_all_is_no_trouble() -> None:
    line = Timeline(RATE_HZ)
    for number in range(1000):
        arrival = 100.0 + number * 0.01
        line.place(BLOCK, max(arrival, 103.4) if arrival > 103.0 else arrival)
    assert not line.trouble
