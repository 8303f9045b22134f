"""NI's own library, through its public gRPC options, against a server that we hold in our hands."""

import asyncio
import itertools
import sys
import threading
import time
from collections.abc import Iterator

import numpy as np
import pytest

from bentod import registry
from bentod.clock import SystemClock
from bentod.contracts import EmgConfig, EmgSource
from bentod.errors import ConfigError, InputFileError
from bentod.frames import EmgBlock, Value
from drivers.emg.nidaqmx_source import open_emg
from tests.drivers.emg.ni_server import Device, Server, serving, signal

RATE_HZ = 1000.0
CHANNELS = 4
DIFFERENTIAL = 10106
"""DAQmx_Val_Diff, in NIDAQmx.h."""

pytestmark = pytest.mark.real_time


@pytest.fixture
def device() -> Device:
    return Device()


@pytest.fixture
def server(device: Device) -> Iterator[Server]:
    with serving(device) as server:
        yield server


def config(server: Server, **more: Value) -> EmgConfig:
    options: dict[str, Value] = {"channels": "Dev1/ai0:3", "grpc": server.address, **more}
    return EmgConfig(RATE_HZ, CHANNELS, options)


async def take(source: EmgSource, count: int) -> list[EmgBlock]:
    """The next `count` blocks."""
    blocks: list[EmgBlock] = []
    async for block in source:
        blocks.append(block)
        if len(blocks) == count:
            return blocks
    raise AssertionError("the source ended")


def readers() -> list[threading.Thread]:
    return [thread for thread in threading.enumerate() if thread.name.startswith("EMG ")]


async def until_it_breaks(source: EmgSource) -> list[EmgBlock]:
    return [block async for block in source]


async def test_every_sample_arrives_once_in_volts_and_order(server: Server) -> None:
    async with open_emg(config(server), SystemClock()) as source:
        blocks = await take(source, 30)
    assert (source.rate_hz, source.channels) == (RATE_HZ, CHANNELS)
    assert {block.samples.shape for block in blocks} == {(10, CHANNELS)}
    assert [block.first_index for block in blocks] == list(range(0, 300, 10))
    assert {block.dropped for block in blocks} == {0}
    samples = np.concatenate([block.samples for block in blocks])
    assert samples.dtype == np.float32
    np.testing.assert_array_equal(samples, signal(0, 300, CHANNELS).T)


async def test_samples_are_stamped_when_they_were_taken(server: Server) -> None:
    opened = time.monotonic()
    async with open_emg(config(server), SystemClock()) as source:
        async for block in source:
            now = time.monotonic()
            assert opened <= block.time
            assert block.time + (len(block.samples) - 1) / source.rate_hz <= now
            if block.first_index >= 200:
                break


async def test_the_device_is_asked_for_differential_inputs_at_an_explicit_rate(
    server: Server, device: Device
) -> None:
    async with open_emg(config(server, range_v=1.0), SystemClock()) as source:
        await take(source, 1)
    assert device.asked.terminal_config_raw == DIFFERENTIAL
    assert (device.asked.min_val, device.asked.max_val) == (-1.0, 1.0)
    assert device.calls.index("CfgSampClkTiming") < device.calls.index("StartTask")


async def test_a_block_costs_one_call(server: Server, device: Device) -> None:
    async with open_emg(config(server), SystemClock()) as source:
        await take(source, 20)
    while_it_ran = device.calls[device.calls.index("StartTask") + 1 : -1]
    assert set(while_it_ran) == {"ReadAnalogF64"}
    assert len(while_it_ran) >= 20


async def test_closing_gives_the_device_back_and_ends_the_thread(server: Server, device: Device) -> None:
    async with open_emg(config(server), SystemClock()) as source:
        await take(source, 2)
    assert device.cleared.is_set()
    assert not readers()


async def test_the_rate_is_that_of_the_device(server: Server, device: Device) -> None:
    device.share = 0.9995
    async with open_emg(config(server), SystemClock()) as source:
        assert source.rate_hz == pytest.approx(999.5)


async def test_a_device_of_another_rate_is_refused_and_given_back(server: Server, device: Device) -> None:
    device.share = 1.1
    with pytest.raises(ConfigError, match=r"samples at 1100 Hz, but the config's rate_hz is 1000 Hz"):
        async with open_emg(config(server), SystemClock()):
            pass
    assert device.cleared.is_set()


async def test_too_few_channels_are_refused(server: Server, device: Device) -> None:
    with pytest.raises(InputFileError, match=r"it has 2 channels; the sites need 4"):
        async with open_emg(config(server, channels="Dev1/ai0:1"), SystemClock()):
            pass
    assert device.cleared.is_set()


@pytest.mark.parametrize(
    ("status", "sentence"),
    [
        (-200170, r"NI Dev1/ai0:3 at .*: the device has no such channel \(NI-DAQmx -200170\)\."),
        (-200999, r"NI's text about -200999"),
    ],
)
async def test_what_the_driver_refuses_is_a_sentence(
    server: Server, device: Device, status: int, sentence: str
) -> None:
    device.refuses = status
    with pytest.raises(InputFileError, match=sentence):
        async with open_emg(config(server), SystemClock()):
            pass
    assert device.cleared.is_set()


@pytest.mark.parametrize(
    ("status", "sentence"),
    [
        (-200279, r"samples were overwritten before they were read; .* \(NI-DAQmx -200279\)"),
        (-200284, r"no sample came in time \(NI-DAQmx -200284\)"),
        (-88710, r"the device was unplugged, or reset \(NI-DAQmx -88710\)"),
        (-123456, r"NI's text about -123456"),
    ],
)
async def test_a_read_that_fails_ends_the_source_after_what_was_read_before(
    server: Server, device: Device, status: int, sentence: str
) -> None:
    async with open_emg(config(server), SystemClock()) as source:
        await take(source, 3)
        device.status = status
        with pytest.raises(InputFileError, match=sentence):
            await until_it_breaks(source)
    assert device.cleared.is_set()


async def test_a_device_that_broke_can_be_opened_again(server: Server, device: Device) -> None:
    device.status = -88710
    async with open_emg(config(server), SystemClock()) as source:
        with pytest.raises(InputFileError, match="unplugged"):
            await take(source, 1)
    device.status = 0
    async with open_emg(config(server), SystemClock()) as source:
        assert (await take(source, 1))[0].first_index == 0


async def test_a_device_without_a_clock_breaks_by_itself(server: Server, device: Device) -> None:
    async with open_emg(config(server, timeout_s=0.3), SystemClock()) as source:
        await take(source, 3)
        device.silent = True
        with pytest.raises(InputFileError, match="no sample came in time"):
            await until_it_breaks(source)


async def test_a_server_that_is_killed_breaks_the_source(server: Server) -> None:
    async with open_emg(config(server), SystemClock()) as source:
        await take(source, 3)
        await asyncio.to_thread(server.stop)
        with pytest.raises(InputFileError, match="the NI gRPC Device Server does not answer"):
            await until_it_breaks(source)
    assert not readers()


async def test_a_server_that_hangs_breaks_the_source_and_leaves_the_loop_alone(
    server: Server, device: Device
) -> None:
    async with open_emg(config(server, timeout_s=0.3), SystemClock()) as source:
        await take(source, 3)
        device.hangs = True
        broken = asyncio.create_task(until_it_breaks(source))
        turns = 0
        while not broken.done():
            await asyncio.sleep(0.005)
            turns += 1
        with pytest.raises(InputFileError, match="the NI gRPC Device Server does not answer"):
            await broken
        assert turns > 10


async def test_a_server_that_hangs_can_be_left(server: Server, device: Device) -> None:
    async with open_emg(config(server, timeout_s=0.3), SystemClock()) as source:
        await take(source, 1)
        device.hangs = True
        await asyncio.sleep(0.02)
    assert readers(), "nobody waited for the call that hangs"
    device.over.set()
    for reader in readers():
        await asyncio.to_thread(reader.join, 5)
    assert not readers()


async def test_a_server_that_is_too_slow_shows_in_the_stamps_until_it_breaks_the_source(
    server: Server, device: Device
) -> None:
    device.latency = 0.015
    ages: list[float] = []

    async def watch(source: EmgSource) -> None:
        async for block in source:
            ages.append(time.monotonic() - block.time)

    async with open_emg(config(server), SystemClock()) as source:
        with pytest.raises(InputFileError, match=r"is \d\.\d\d s late and does not catch up"):
            await watch(source)
    assert ages[-1] > 0.1
    assert sum(late < early for early, late in itertools.pairwise(ages[::20])) == 0


async def test_no_server_is_a_sentence() -> None:
    nobody = EmgConfig(RATE_HZ, CHANNELS, {"channels": "Dev1/ai0:3", "grpc": "127.0.0.1:1"})
    with pytest.raises(InputFileError, match=r"127\.0\.0\.1:1: the NI gRPC Device Server does not answer"):
        async with open_emg(nobody, SystemClock()):
            pass
    assert not readers()


async def test_without_the_driver_the_config_is_told_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("ctypes.util.find_library", lambda name: None)
    with pytest.raises(ConfigError, match=r"NI-DAQmx is not installed .* `python -m nidaqmx installdriver`"):
        async with open_emg(EmgConfig(RATE_HZ, 1, {"channels": "Dev1/ai0"}), SystemClock()):
            pass


async def test_without_the_package_the_table_is_checked_and_the_extra_is_named(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.delitem(sys.modules, "drivers.emg.nidaqmx_source")
    monkeypatch.setitem(sys.modules, "nidaqmx", None)
    registry.emg_model("nidaqmx")(channels="Dev1/ai0")
    with pytest.raises(ConfigError, match=r"nidaqmx .*; pip install 'bentod\[ni\]' brings it"):
        registry.open_emg("nidaqmx")


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({}, r"'channels' is required"),
        ({"channels": "Dev1/ai0", "terminals": "RSE"}, r"'terminals' is unknown; did you mean 'terminal'\?"),
        ({"channels": "Dev1/ai0", "grpc": "host"}, r"'grpc' is 'host'"),
        ({"channels": "Dev1/ai0", "block_s": 0.1}, r"'block_s' is 0\.1"),
        ({"channels": "Dev1/ai0", "range_v": 0.0}, r"'range_v' is 0\.0"),
    ],
)
async def test_a_wrong_option_is_a_sentence(options: dict[str, Value], sentence: str) -> None:
    with pytest.raises(ConfigError, match=sentence):
        async with open_emg(EmgConfig(RATE_HZ, 1, options), SystemClock()):
            pass
