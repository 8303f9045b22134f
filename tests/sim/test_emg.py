import asyncio
from collections.abc import AsyncIterator
from itertools import accumulate

import numpy as np
import pytest

from bentod.contracts import EmgConfig
from bentod.control.proportional import Envelope, Proportional, Site, difference
from bentod.control.switching import ToggleSite, Toggling
from bentod.errors import ConfigError
from bentod.frames import EmgBlock, Samples, Value
from sim.clock import VirtualClock
from sim.emg import RAIL, Synthetic, open_emg
from sim.emg_wearer import CIRCUIT, NEGATIVE, POSITIVE, TOGGLE, Options, Wearer

LAP = 1760  # samples of the standard program at 200 Hz
MUSCLES = [Site("positive", POSITIVE, 1.0, 8e-6, 30e-6), Site("negative", NEGATIVE, 1.0, 8e-6, 30e-6)]
SWITCH = [ToggleSite("toggle", TOGGLE, 1.0, 20e-6)]


def record(laps: int, **options: object) -> Samples:
    return Wearer(Options.model_validate(options), 200.0, 3).read(0, laps * LAP)


def mav(samples: Samples, channel: int, start_s: float, end_s: float) -> float:
    """Mean absolute value of one stretch of the lap, over all laps, in microvolts."""
    laps = samples[:, channel].reshape(-1, LAP)
    return float(np.abs(laps[:, int(start_s * 200) : int(end_s * 200)]).mean() * 1e6)


def walk(samples: Samples) -> tuple[np.typing.NDArray[np.float64], int]:
    """Way of two joints (s at full effort, one row a tick) and toggles, for a tick each 7 samples."""
    envelope, proportional, toggling = Envelope(), Proportional(MUSCLES), Toggling(SWITCH)
    way, toggles = np.zeros((len(samples) // 7 + 1, 2)), 0
    for tick in range(1, len(way)):
        levels = envelope.step(samples[7 * (tick - 1) : 7 * tick])
        proportional.step(levels)
        efforts = proportional.newest()
        toggles += sum(toggling.step(levels)["toggle"])
        way[tick] = way[tick - 1]
        way[tick, toggles % 2] += difference(efforts["positive"], efforts["negative"]) * 7 / 200
    return way, toggles


def test_the_standard_program_is_a_closed_circuit() -> None:
    ends = list(accumulate(step.seconds for step in CIRCUIT))
    assert ends[-1] == pytest.approx(LAP / 200)
    joints, joint = [0.0, 0.0], 0
    for step in CIRCUIT:
        joint = (joint + (step.channel == TOGGLE and step.level > 0)) % 2
        joints[joint] += step.level * step.seconds * {POSITIVE: 1, NEGATIVE: -1, TOGGLE: 0}[step.channel]
    assert joint == 0
    assert joints == pytest.approx([0.0, 0.0])


def test_muscles_are_as_loud_as_real_ones() -> None:
    samples = record(20)
    assert mav(samples, POSITIVE, 1.2, 2.0) == pytest.approx(60, rel=0.05)
    assert mav(samples, NEGATIVE, 5.6, 6.4) == pytest.approx(60, rel=0.05)
    assert mav(samples, POSITIVE, 5.6, 8.7) == pytest.approx(2.5, rel=0.05)
    assert mav(samples, NEGATIVE, 0.8, 5.0) == pytest.approx(2.5, rel=0.05)


def test_a_muscle_follows_the_intent_with_a_lag() -> None:
    samples = record(200)
    assert mav(samples, POSITIVE, 0.8, 0.82) < 10
    assert mav(samples, POSITIVE, 0.86, 0.88) == pytest.approx(60 * (1 - np.exp(-1)) ** 1.5, rel=0.1)
    assert mav(samples, POSITIVE, 2.0, 2.02) > 40


@pytest.mark.parametrize("seed", range(5))
def test_ten_laps_toggle_twenty_times_and_lead_nowhere(seed: int) -> None:
    way, toggles = walk(record(10, seed=seed))
    assert toggles == 20
    assert np.abs(way[-1]).max() < 0.3
    assert way.max(axis=0) == pytest.approx([1.25, 1.25], abs=0.2)
    assert way.min() > -0.3


def test_the_signal_has_the_band_of_surface_emg() -> None:
    samples = Wearer(Options(program=(CIRCUIT[1],)), 2000.0, 3).read(0, 2**15)[:, POSITIVE]
    power = np.abs(np.fft.rfft(samples)) ** 2
    frequency = np.fft.rfftfreq(2**15, 1 / 2000.0)
    assert power[(frequency > 15) & (frequency < 500)].sum() > 0.9 * power.sum()


def test_channels_are_independent() -> None:
    rest = Wearer(Options(full_v=0.0), 200.0, 5).read(0, 2**15)
    assert np.abs(np.corrcoef(rest.T) - np.eye(5)).max() < 0.05


def test_the_seed_decides() -> None:
    np.testing.assert_array_equal(record(1, seed=3), record(1, seed=3))
    assert not np.array_equal(record(1, seed=3), record(1, seed=4))


def test_hum_is_the_same_on_every_channel() -> None:
    hum = record(1, hum_v=1e-5, hum_hz=47.0) - record(1)
    assert hum.max() == pytest.approx(1e-5, rel=0.01)
    np.testing.assert_allclose(hum[:, 0], hum[:, 1], atol=1e-10)


def config(**options: Value) -> EmgConfig:
    return EmgConfig(200.0, 3, options)


async def listen(source: Synthetic, clock: VirtualClock, seconds: float) -> list[EmgBlock]:
    blocks = []

    async def consume(stream: AsyncIterator[EmgBlock]) -> None:
        async for block in stream:
            blocks.append(block)

    task = asyncio.create_task(consume(aiter(source)))
    await clock.sleep_until(clock.now() + seconds)
    task.cancel()
    await asyncio.wait([task])
    return blocks


async def test_dropped_blocks_are_counted(clock: VirtualClock) -> None:
    async with open_emg(config(dropout=0.2), clock) as source:
        blocks = await listen(source, clock, 20.0)
    dropped = sum(block.dropped for block in blocks)
    assert dropped == pytest.approx(0.2 * 4000, rel=0.2)
    assert blocks[-1].first_index + 2 == dropped + 2 * len(blocks)


async def test_what_a_stall_swallows_is_lost_and_counted(clock: VirtualClock) -> None:
    async with open_emg(config(), clock) as source:
        await listen(source, clock, 1.0)
        source.stall = True
        assert await listen(source, clock, 1.0) == []
        source.stall = False
        back = await listen(source, clock, 1.0)
    assert back[0].first_index - 200 == pytest.approx(back[0].dropped, abs=2)
    assert back[0].time == pytest.approx(back[0].first_index / 200)


async def test_a_broken_amplifier_gives_no_numbers(clock: VirtualClock) -> None:
    async with open_emg(config(), clock) as source:
        source.nan = True
        blocks = await listen(source, clock, 0.1)
    assert np.isnan(blocks[0].samples).all()


async def test_a_source_ends_when_it_is_told_to(clock: VirtualClock) -> None:
    async with open_emg(config(), clock) as source:
        source.end = True
        assert [block async for block in source] == []


async def test_a_program_is_a_list_of_steps(clock: VirtualClock) -> None:
    async with open_emg(config(program=[[4, 1, 0.5], [0, 0.0, 0.5]]), clock) as source:
        blocks = await listen(source, clock, 10.0)
    loudness = np.abs(np.concatenate([block.samples for block in blocks])).mean(axis=0)
    assert source.channels == 5
    assert loudness[4] > 5 * loudness[:4].max()


@pytest.mark.parametrize(
    ("options", "why"),
    [
        ({"sead": 1}, "'sead' is unknown; did you mean 'seed'"),
        ({"program": []}, "'program' is"),
        ({"program": [[0, 2.0, 1.0]]}, r"'program\.0\..*' is 2\.0"),
        ({"program": [[0, 1.0, 60.0]] * 200, "block_s": 0.01}, "makes 7.2e\\+06 values a lap"),
        ({"rest_v": float("nan")}, "'rest_v' is nan"),
    ],
)
async def test_a_wrong_option_is_refused(options: dict[str, Value], why: str, clock: VirtualClock) -> None:
    with pytest.raises(ConfigError, match=why):
        async with open_emg(config(**options), clock):
            pass


async def test_a_rate_out_of_bounds_is_refused(clock: VirtualClock) -> None:
    with pytest.raises(ConfigError, match="cannot run at 20 Hz; it must be from 50 to 10000 Hz"):
        async with open_emg(EmgConfig(20.0, 3, {}), clock):
            pass


async def test_a_stuck_channel_gives_one_value_and_the_others_theirs(clock: VirtualClock) -> None:
    async with open_emg(config(), clock) as source:
        source.stuck = {1: 5e-6}
        samples = np.concatenate([block.samples for block in await listen(source, clock, 1.0)])
    assert set(samples[:, 1]) == {np.float32(5e-6)}
    assert len(set(samples[:, 0])) > 100


async def test_a_saturated_channel_is_at_its_rails(clock: VirtualClock) -> None:
    async with open_emg(config(), clock) as source:
        source.saturated = (0,)
        samples = np.concatenate([block.samples for block in await listen(source, clock, 1.0)])
    assert np.mean(np.abs(samples[:, 0]) == np.float32(RAIL)) > 0.9


async def test_late_blocks_carry_the_times_at_which_they_were_taken(clock: VirtualClock) -> None:
    arrivals = []
    async with open_emg(config(), clock) as source:
        source.late = 0.3
        async for block in source:
            arrivals.append((block.first_index, clock.now() - block.time))
            if block.first_index > 100:
                break
    assert [late for _, late in arrivals] == pytest.approx([0.31] * len(arrivals), abs=0.001)
    assert [first for first, _ in arrivals] == list(range(0, 2 * len(arrivals), 2))


async def test_a_clock_that_drifts_parts_from_ours_and_never_jumps(clock: VirtualClock) -> None:
    async with open_emg(config(), clock) as source:
        source.drift = 0.01
        first = await listen(source, clock, 10.0)
        source.drift = 0.0
        second = await listen(source, clock, 1.0)
    assert first[-1].time == pytest.approx(10.1, abs=0.02)
    assert second[-1].time == pytest.approx(11.1, abs=0.02)
    assert second[0].first_index == first[-1].first_index + 2


async def test_a_wearer_at_rest_is_quiet_on_every_channel(clock: VirtualClock) -> None:
    async with open_emg(config(), clock) as source:
        source.relaxed = True
        samples = np.concatenate([block.samples for block in await listen(source, clock, 1.0)])
    assert np.abs(samples).mean(axis=0).max() < 5e-6
