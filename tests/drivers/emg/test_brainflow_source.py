"""BrainFlow's own library: its board that plays a file as another had sent it, and its synthetic one."""

import gc
import sys
import threading
import time
from collections.abc import Sequence
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest
from brainflow.board_shim import BoardShim, BrainFlowError
from numpy.typing import NDArray

from bentod import registry
from bentod.clock import SystemClock
from bentod.contracts import EmgConfig, EmgSource
from bentod.errors import ConfigError, InputFileError
from bentod.frames import EmgBlock, Value
from drivers.emg.brainflow_options import Options
from drivers.emg.brainflow_source import Session, open_emg
from drivers.emg.options import parse

RATE_HZ = 500.0
CHANNELS = 8
ROWS = 11
"""Of a gForcePro: a counter of packages, eight channels of EMG, time, marks."""

SAMPLES = 400

pytestmark = pytest.mark.real_time


def microvolts() -> NDArray[np.float64]:
    """Shape (CHANNELS, SAMPLES), in steps that a file of BrainFlow keeps."""
    return np.random.default_rng(1).integers(-3_000_000, 3_000_000, (CHANNELS, SAMPLES)) / 1000


def record(folder: Path, missing: Sequence[int] = ()) -> Path:
    """A file of BrainFlow, without the samples that are `missing`."""
    rows = np.zeros((ROWS, SAMPLES))
    rows[0] = np.arange(SAMPLES) % 256
    rows[1:9] = microvolts()
    rows[9] = 1.7e9 + np.arange(SAMPLES) / RATE_HZ
    path = folder / "recording.csv"
    np.savetxt(path, np.delete(rows, missing, axis=1).T, fmt="%.6f", delimiter="\t")
    return path


def config(path: Path, rate_hz: float = RATE_HZ, channels: int = CHANNELS, **more: Value) -> EmgConfig:
    options = {"board": "playback_file", "master_board": "GFORCE_PRO_BOARD", "file": str(path), **more}
    return EmgConfig(rate_hz, channels, options)


async def take(source: EmgSource, samples: int) -> list[EmgBlock]:
    """Blocks up to the first that ends at sample `samples` or behind."""
    blocks: list[EmgBlock] = []
    async for block in source:
        blocks.append(block)
        if block.first_index + len(block.samples) >= samples:
            return blocks
    raise AssertionError("the source ended")


async def until_it_breaks(source: EmgSource) -> None:
    async for _ in source:
        pass


def readers() -> list[threading.Thread]:
    return [thread for thread in threading.enumerate() if thread.name.startswith("EMG ")]


async def test_what_the_board_sends_arrives_in_volts(tmp_path: Path) -> None:
    async with open_emg(config(record(tmp_path)), SystemClock()) as source:
        blocks = await take(source, 100)
    assert (source.rate_hz, source.channels) == (RATE_HZ, CHANNELS)
    samples = np.concatenate([block.samples for block in blocks])
    assert samples.dtype == np.float32
    np.testing.assert_array_equal(samples, (microvolts().T[: len(samples)] * 1e-6).astype(np.float32))
    assert {block.dropped for block in blocks} == {0}


async def test_blocks_follow_one_another_and_are_stamped_when_they_were_taken(tmp_path: Path) -> None:
    opened = time.monotonic()
    async with open_emg(config(record(tmp_path)), SystemClock()) as source:
        follows = 0
        async for block in source:
            last = block.time + (len(block.samples) - 1) / RATE_HZ
            assert block.first_index == follows
            assert opened - 0.1 < last <= time.monotonic()
            follows += len(block.samples)
            if follows > 100:
                break


async def test_packages_that_were_lost_are_told_and_shift_nothing(tmp_path: Path) -> None:
    missing = [*range(60, 65), *range(90, 91)]
    async with open_emg(config(record(tmp_path, missing)), SystemClock()) as source:
        blocks = await take(source, 120)
    assert [(block.first_index, block.dropped) for block in blocks if block.dropped] == [(65, 5), (91, 1)]
    volts = (microvolts().T * 1e-6).astype(np.float32)
    for block in blocks:
        there = slice(block.first_index, block.first_index + len(block.samples))
        np.testing.assert_array_equal(block.samples, volts[there])


async def test_rows_may_be_chosen_and_scaled(tmp_path: Path) -> None:
    chosen = config(record(tmp_path), channels=2, rows=[8, 1], volts_per_unit=1e-3)
    async with open_emg(chosen, SystemClock()) as source:
        blocks = await take(source, 10)
    assert source.channels == 2
    expected = (microvolts()[[7, 0]].T[: len(blocks[0].samples)] * 1e-3).astype(np.float32)
    np.testing.assert_array_equal(blocks[0].samples, expected)


async def test_a_board_that_falls_silent_has_broken(tmp_path: Path) -> None:
    with pytest.raises(InputFileError, match=r"board playback_file has given no sample for 0\.1 s"):
        async with open_emg(
            config(record(tmp_path, range(20, SAMPLES)), timeout_s=0.1), SystemClock()
        ) as source:
            await until_it_breaks(source)
    assert not readers()


async def test_commands_reach_the_board_before_it_streams(tmp_path: Path) -> None:
    path = record(tmp_path, range(20, SAMPLES))
    async with open_emg(config(path, commands=["loopback_true"]), SystemClock()) as source:
        assert await take(source, 50)


async def test_a_session_is_over_when_the_source_is_closed_and_may_begin_again(tmp_path: Path) -> None:
    for _ in range(2):
        async with open_emg(config(record(tmp_path)), SystemClock()) as source:
            await take(source, 10)
        assert not readers()


async def test_an_old_session_that_is_deleted_late_leaves_the_new_one_alone(tmp_path: Path) -> None:
    chosen = config(record(tmp_path))
    options = parse(Options, chosen.options)
    old = Session(options, chosen, SystemClock())
    old.close()
    with closing(Session(options, chosen, SystemClock())) as new:
        del old
        gc.collect()
        assert any(new.read() is not None for _ in range(20))


async def test_the_same_board_cannot_be_opened_twice(tmp_path: Path) -> None:
    async with open_emg(config(record(tmp_path)), SystemClock()) as source:
        with pytest.raises(InputFileError, match="an earlier session with it is not over yet"):
            async with open_emg(config(tmp_path / "recording.csv"), SystemClock()):
                pass
        assert await take(source, 50)


async def test_a_rate_within_two_percent_is_taken_for_the_true_one(tmp_path: Path) -> None:
    async with open_emg(config(record(tmp_path), rate_hz=498.6), SystemClock()) as source:
        assert source.rate_hz == 498.6


async def test_the_synthetic_board_is_read_without_a_word_on_stderr(
    capfd: pytest.CaptureFixture[str],
) -> None:
    config = EmgConfig(250.0, 16, {"board": -1})
    async with open_emg(config, SystemClock()) as source:
        blocks = await take(source, 20)
    assert source.channels == 16
    assert sum(block.dropped for block in blocks) == 0
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({"board": "gforce"}, r"BrainFlow knows no board 'gforce'; did you mean 'GFORCE_\w+_BOARD'\?"),
        ({"board": 999}, r"BrainFlow knows no board '999'"),
        ({"board": "playback_file"}, r"needs 'master_board'"),
        ({"board": "synthetic", "rows": [99]}, r"has rows 0 to 31; 'rows' asks for 99"),
        ({"board": "synthetic", "serial": "x"}, r"'serial' is unknown; did you mean 'serial_port'\?"),
        ({"board": "muse_2"}, r"samples at 256 Hz, but the config's rate_hz is 250 Hz"),
        ({}, r"'board' is required"),
    ],
)
async def test_a_wrong_option_is_a_sentence(options: dict[str, Value], sentence: str) -> None:
    with pytest.raises(ConfigError, match=sentence):
        async with open_emg(EmgConfig(250.0, 1, options), SystemClock()):
            pass
    assert not readers()


async def test_a_board_without_emg_asks_for_rows() -> None:
    with pytest.raises(ConfigError, match=r"board muse_2 has no channels of EMG; name the rows"):
        async with open_emg(EmgConfig(256.0, 1, {"board": "muse_2"}), SystemClock()):
            pass


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({"board": "cyton", "serial_port": "/dev/no-such-port"}, r"cannot be opened; is it plugged in"),
        ({"board": "cyton"}, r"what it needs to be found is missing or wrong, e\.g\. serial_port"),
        ({"board": "playback_file", "master_board": "cyton", "file": "no-such-file"}, r"missing or wrong"),
    ],
)
async def test_a_board_that_is_not_there_is_a_sentence(options: dict[str, Value], sentence: str) -> None:
    with pytest.raises(InputFileError, match=sentence):
        async with open_emg(EmgConfig(250.0, 1, options), SystemClock()):
            pass
    assert not readers()


async def test_too_few_channels_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputFileError, match="it has 8 channels; the sites need 9"):
        async with open_emg(config(record(tmp_path), channels=9), SystemClock()):
            pass


async def test_a_board_that_breaks_is_a_sentence_and_is_released(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(board: BoardShim, preset: int) -> int:
        raise BrainFlowError("unable to obtain buffer size", 7)

    async with open_emg(config(record(tmp_path)), SystemClock()) as source:
        await take(source, 10)
        monkeypatch.setattr(BoardShim, "get_board_data_count", fail)
        with pytest.raises(InputFileError, match=r"it does not answer; .* \(BOARD_NOT_READY_ERROR:7"):
            await until_it_breaks(source)
    monkeypatch.undo()
    async with open_emg(config(record(tmp_path)), SystemClock()) as source:
        assert await take(source, 10)


async def test_without_the_package_the_table_is_checked_and_the_extra_is_named(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.delitem(sys.modules, "drivers.emg.brainflow_source")
    monkeypatch.setitem(sys.modules, "brainflow", None)
    registry.emg_model("brainflow")(board="cyton")
    with pytest.raises(ConfigError, match=r"brainflow .*; pip install 'bentod\[brainflow\]' brings it"):
        registry.open_emg("brainflow")
