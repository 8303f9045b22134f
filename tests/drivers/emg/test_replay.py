from pathlib import Path

import numpy as np
import pytest

from bentod.contracts import EmgConfig
from bentod.errors import ConfigError, InputFileError
from bentod.frames import EmgBlock, Value
from drivers.emg.replay import Replay, open_emg
from sim.clock import VirtualClock

RAMP = np.repeat(np.arange(101, dtype=np.int16)[:, np.newaxis], 3, axis=1)


@pytest.fixture
def ramp(tmp_path: Path) -> str:
    """A recording of 101 samples whose value is their index, without a rate."""
    np.savez(tmp_path / "ramp.npz", emg=RAMP)
    return str(tmp_path / "ramp.npz")


def config(file: str, **options: Value) -> EmgConfig:
    return EmgConfig(200.0, 3, {"file": file, "volts_per_unit": 1.0, **options})


async def play(source: Replay, blocks: int) -> list[EmgBlock]:
    """The first `blocks` blocks, or all if the source ends before."""
    played: list[EmgBlock] = []
    iterator = aiter(source)
    while len(played) < blocks:
        try:
            played.append(await anext(iterator))
        except StopAsyncIteration:
            break
    return played


def values(blocks: list[EmgBlock]) -> list[float]:
    return [float(value) for block in blocks for value in block.samples[:, 0]]


async def test_a_recording_starts_again_while_the_index_runs_on(ramp: str, clock: VirtualClock) -> None:
    async with open_emg(config(ramp), clock) as source:
        blocks = await play(source, 100)
    assert values(blocks) == [float(index % 101) for index in range(200)]
    assert blocks[-1].first_index == 198


async def test_a_recording_that_is_played_once_ends_with_its_last_sample(
    ramp: str, clock: VirtualClock
) -> None:
    async with open_emg(config(ramp, loop=False), clock) as source:
        assert values(await play(source, 100)) == list(range(101))
        assert await play(source, 1) == []


async def test_a_recording_plays_at_the_configs_rate_unless_it_has_its_own(
    ramp: str, tmp_path: Path, clock: VirtualClock
) -> None:
    np.savez(tmp_path / "own.npz", emg=RAMP, fs=1000)
    async with open_emg(config(ramp), clock) as source:
        assert source.rate_hz == 200.0
    async with open_emg(config(ramp, rate_hz=100.0), clock) as source:
        assert source.rate_hz == 100.0
    async with open_emg(config(str(tmp_path / "own.npz")), clock) as source:
        assert source.rate_hz == 1000.0


async def test_an_option_that_contradicts_the_recording_is_refused(
    tmp_path: Path, clock: VirtualClock
) -> None:
    np.savez(tmp_path / "own.npz", emg=RAMP, fs=1000)
    with pytest.raises(ConfigError, match=r"'rate_hz' is 200 Hz, but .*own\.npz states 1000 Hz"):
        async with open_emg(config(str(tmp_path / "own.npz"), rate_hz=200.0), clock):
            pass


async def test_a_recording_can_be_played_faster(ramp: str, clock: VirtualClock) -> None:
    async with open_emg(config(ramp, speed=10.0), clock) as source:
        assert source.rate_hz == 2000.0
        blocks = await play(source, 5)
    assert clock.now() == pytest.approx(99 / 2000)
    assert values(blocks) == list(range(100))


async def test_a_late_consumer_does_not_compress_time(ramp: str, clock: VirtualClock) -> None:
    async with open_emg(config(ramp), clock) as source:
        await play(source, 1)
        await clock.sleep_until(0.3)
        late = await play(source, 40)
    assert values(late)[0] == 2.0
    assert late[0].time == pytest.approx(0.01)
    assert late[-1].time == pytest.approx(0.4)


async def test_a_recording_that_ends_while_nobody_listens_is_over(ramp: str, clock: VirtualClock) -> None:
    async with open_emg(config(ramp, loop=False, buffer_s=0.1), clock) as source:
        await play(source, 1)
        await clock.sleep_until(5.0)
        assert await play(source, 1) == []


async def test_too_few_channels_are_refused(ramp: str, clock: VirtualClock) -> None:
    with pytest.raises(InputFileError, match=r"ramp\.npz: it has 3 channels; the sites need 4"):
        async with open_emg(EmgConfig(200.0, 4, {"file": ramp}), clock):
            pass


async def test_a_rate_too_slow_to_notice_a_stall_is_refused(ramp: str, clock: VirtualClock) -> None:
    with pytest.raises(ConfigError, match="at 10 Hz; the bound is 20 Hz"):
        async with open_emg(config(ramp, rate_hz=100.0, speed=0.1), clock):
            pass


async def test_every_wrong_option_is_told_at_once(clock: VirtualClock) -> None:
    wrong: dict[str, Value] = {"sped": 2.0, "speed": 1000.0}
    with pytest.raises(ConfigError) as caught:
        async with open_emg(EmgConfig(200.0, 3, wrong), clock):
            pass
    assert str(caught.value) == (
        "The EMG option 'file' is required. "
        "The EMG option 'speed' is 1000.0: Input should be less than or equal to 100. "
        "The EMG option 'sped' is unknown; did you mean 'speed'?"
    )


async def test_a_real_recording_plays(clock: VirtualClock) -> None:
    path = Path(__file__).parents[4] / "shared" / "data" / "libemg_myo_200hz.npz"
    if not path.exists():
        pytest.skip("the recording is not here")
    options: dict[str, Value] = {"file": str(path)}
    async with open_emg(EmgConfig(100.0, 3, options), clock) as source:
        blocks = await play(source, 6001)
    assert source.rate_hz == 200.0
    assert source.channels == 8
    assert blocks[6000].first_index == 12_000
    np.testing.assert_array_equal(blocks[6000].samples, blocks[0].samples)
    largest = max(float(np.abs(block.samples).max()) for block in blocks)
    assert largest == pytest.approx(127e-6)
