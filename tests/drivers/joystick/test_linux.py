"""The kernel's joystick device: when there is none, and when it is something else."""

import asyncio
import os
import struct
from pathlib import Path

import pytest

from bentod.errors import ConfigError
from drivers.joystick import linux
from drivers.joystick.linux import MOST_READS, open_joystick
from sim.clock import VirtualClock
from tests.drivers.joystick.rigs import until

pytestmark = pytest.mark.real_time  # a thread opens the device


@pytest.fixture(autouse=True)
def _in_a_hurry(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(linux, "RETRY_S", 0.01)


async def test_that_there_is_no_device_is_told_and_no_error(tmp_path: Path) -> None:
    async with open_joystick({"device": str(tmp_path / "js0")}, VirtualClock()) as source:
        pad = await until(source, lambda pad: "cannot be opened" in pad.reason)
    assert pad.reason == f"{tmp_path / 'js0'} cannot be opened: No such file or directory."
    assert not pad.connected


@pytest.mark.skipif(os.geteuid() == 0, reason="root may read everything")
async def test_that_it_may_not_be_read_is_told(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "js0", mode=0)
    async with open_joystick({"device": str(tmp_path / "js0")}, VirtualClock()) as source:
        assert "Permission denied" in (await until(source, lambda pad: "opened:" in pad.reason)).reason


async def test_a_file_is_no_joystick_and_is_closed_each_time(tmp_path: Path) -> None:
    (tmp_path / "js0").write_bytes(bytes(80))
    before = len(os.listdir("/proc/self/fd"))
    async with open_joystick({"device": str(tmp_path / "js0")}, VirtualClock()) as source:
        pad = await until(source, lambda pad: pad.openings > 2)
        await until(source, lambda pad: not pad.connected)
    assert pad.openings > 2
    assert len(os.listdir("/proc/self/fd")) <= before


async def test_a_flood_is_no_joystick(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "js0")
    flood = os.open(tmp_path / "js0", os.O_RDWR | os.O_NONBLOCK)
    try:
        os.write(flood, struct.pack("<IhBB", 1, 1, 2, 0) * 64 * (MOST_READS - 1))
        os.write(flood, struct.pack("<IhBB", 1, 1, 2, 0) * 64)
        async with open_joystick({"device": str(tmp_path / "js0")}, VirtualClock()) as source:
            pad = await until(source, lambda pad: "more than a joystick can" in pad.reason)
    finally:
        os.close(flood)
    assert not pad.connected


async def test_closing_while_the_device_is_being_opened_leaves_nothing_open(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    os.mkfifo(tmp_path / "js0")
    before = len(os.listdir("/proc/self/fd"))
    async with open_joystick({"device": str(tmp_path / "js0")}, VirtualClock()):
        await asyncio.sleep(0)
    await asyncio.get_running_loop().run_in_executor(None, os.getpid)  # whatever was under way is over
    await asyncio.sleep(0.01)
    assert len(os.listdir("/proc/self/fd")) <= before


async def test_an_option_that_is_none_is_an_error() -> None:
    with pytest.raises(ConfigError, match="devise"):
        async with open_joystick({"devise": "js0"}, VirtualClock()):
            pass
