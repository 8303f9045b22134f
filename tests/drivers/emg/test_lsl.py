"""Streams of LSL on this machine: which are taken, which refused, and how the end of one is noticed."""

import time
from contextlib import AbstractAsyncContextManager
from types import ModuleType

import numpy as np
import pytest

from bentod.contracts import EmgConfig, EmgSource
from bentod.errors import ConfigError, InputFileError
from bentod.frames import EmgBlock, Value
from sim.clock import VirtualClock
from tests.drivers.emg.lsl_outlet import RATE_HZ, Bridge

lsl = pytest.importorskip("drivers.emg.lsl", exc_type=ImportError)

pytestmark = pytest.mark.real_time

CONFIG = EmgConfig(RATE_HZ, 2, {})


def listening(
    bridge: Bridge, rate_hz: float = RATE_HZ, need: int = 2, **more: Value
) -> AbstractAsyncContextManager[EmgSource]:
    options: dict[str, Value] = {"source_id": bridge.source_id, **more}
    opened: AbstractAsyncContextManager[EmgSource] = lsl.open_emg(
        EmgConfig(rate_hz, need, options), VirtualClock()
    )
    return opened


async def heard(source: EmgSource, samples: int) -> list[EmgBlock]:
    blocks: list[EmgBlock] = []
    async for block in source:
        blocks.append(block)
        samples -= len(block.samples)
        if samples <= 0:
            break
    return blocks


async def test_samples_come_in_volts_in_time_and_in_the_order_that_is_asked_for(pylsl: ModuleType) -> None:
    with Bridge(pylsl) as bridge:
        async with listening(bridge, stream="Bridge", type="EMG", channels=[1, 0]) as source:
            await heard(source, 50)
            blocks = await heard(source, 100)
            age = time.monotonic() - blocks[-1].time - (len(blocks[-1].samples) - 1) / RATE_HZ
    samples = np.concatenate([block.samples for block in blocks])
    assert (source.rate_hz, source.channels, str(samples.dtype)) == (RATE_HZ, 2, "float32")
    np.testing.assert_allclose(np.diff(samples, axis=0) * 1e6, [[-1, 1]] * (len(samples) - 1), atol=1e-3)
    assert -0.05 < age < 1.0


async def test_samples_that_were_lost_on_the_way_are_counted_and_nothing_shifts(pylsl: ModuleType) -> None:
    with Bridge(pylsl, form="int16") as bridge:
        async with listening(
            bridge, volts_per_unit=1e-3
        ) as source:  # which goes before the stream's own unit
            blocks = await heard(source, 50)
            bridge.lose(100)
            blocks += await heard(source, 200)
    assert sum(block.dropped for block in blocks) == pytest.approx(100, abs=2)
    first, last = blocks[0], blocks[-1]
    sent = round(float(last.samples[0, 0] - first.samples[0, 0]) * 1e3)
    assert last.first_index - first.first_index == pytest.approx(sent, abs=2)


async def test_a_bridge_that_dies_or_falls_silent_breaks_the_source(pylsl: ModuleType) -> None:
    with Bridge(pylsl) as bridge:
        async with listening(bridge, timeout_s=0.2) as source:
            await heard(source, 10)
            bridge.silent.set()
            with pytest.raises(InputFileError, match=r"stream .*no sample for 0\.2 s"):
                await heard(source, 1000)
        bridge.silent.clear()
        async with listening(bridge, timeout_s=2.0) as source:
            await heard(source, 10)
            bridge.die()
            with pytest.raises(InputFileError, match="stream"):
                await heard(source, 1000)


async def test_stamps_of_another_clock_are_not_believed(pylsl: ModuleType) -> None:
    with Bridge(pylsl) as bridge:
        bridge.ahead = 1.7e9
        async with listening(bridge) as source:
            with pytest.raises(InputFileError, match=r"1\.7e\+09 s from now; .* LSL's clock"):
                await heard(source, 10)


@pytest.mark.parametrize(
    ("bridge", "options", "sentence"),
    [
        ({"rate_hz": 0.0}, {}, "'Bridge' has no even rate"),
        ({"form": "string"}, {}, "'Bridge' holds text, not numbers"),
        ({}, {"rate_hz": 200.0}, r"'Bridge' has 500 Hz, but emg\.rate_hz is 200 Hz"),
        ({}, {"need": 3}, "gives 2 channels; the sites need 3"),
        ({"unit": "furlongs"}, {}, "says 'furlongs' of the unit of channel 0; give volts_per_unit"),
        ({"unit": ""}, {}, "says nothing of the unit of channel 0; give volts_per_unit"),
    ],
)
async def test_a_stream_that_is_not_one_for_muscles_is_refused(
    pylsl: ModuleType, bridge: dict[str, str], options: dict[str, float], sentence: str
) -> None:
    with Bridge(pylsl, **bridge) as sender, pytest.raises(ConfigError, match=sentence):  # type: ignore[arg-type]
        async with listening(sender, **options):  # type: ignore[arg-type]
            pass


async def test_one_of_several_streams_is_not_taken_by_chance(
    pylsl: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    infos = [pylsl.StreamInfo("Bridge", "EMG", 2, RATE_HZ, "float32", name) for name in ("left", "right")]
    monkeypatch.setattr(pylsl, "resolve_bypred", lambda *_: infos)
    with pytest.raises(
        ConfigError, match=r"2 LSL streams of type 'EMG'; say which source_id: 'left' .*'right'"
    ):
        async with lsl.open_emg(EmgConfig(RATE_HZ, 2, {"type": "EMG"}), VirtualClock()):
            pass


async def test_a_stream_that_is_not_there_is_told_by_what_was_looked_for(
    pylsl: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(pylsl, "resolve_bypred", lambda *_: [])
    with pytest.raises(InputFileError, match=r"No LSL stream of name 'Nobody' was found within 5 s"):
        async with lsl.open_emg(EmgConfig(RATE_HZ, 2, {"stream": "Nobody"}), VirtualClock()):
            pass


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({}, "say which stream"),
        ({"stream": 'a"b'}, "'stream' is"),
        ({"stream": "a", "timeout_s": 9.0}, "'timeout_s' is 9"),
        ({"steam": "a"}, "did you mean 'stream'"),
    ],
)
async def test_options_are_checked(options: dict[str, Value], sentence: str) -> None:
    with pytest.raises(ConfigError, match=sentence):
        async with lsl.open_emg(EmgConfig(RATE_HZ, 2, options), VirtualClock()):
            pass
