"""What every source of muscle signals must keep whose device has its own time, and a plug to be pulled.

The sources that are paced by our own clock are tried in virtual time, by `test_emg.py`.
"""

import asyncio
import time
from collections.abc import AsyncIterator, Callable, Iterator, Mapping
from contextlib import AbstractAsyncContextManager, asynccontextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from types import ModuleType
from typing import Protocol

import numpy as np
import pytest

from bentod import registry
from bentod.contracts import EmgConfig, EmgSource
from bentod.emg.reopening import reopening
from bentod.frames import EmgBlock, Value
from sim.clock import VirtualClock
from tests.drivers.emg import lsl_outlet, serial_board

pytestmark = pytest.mark.real_time

PATIENCE = 15.0
"""s that a busy machine may need."""


class Device(Protocol):
    """A device at a cable."""

    def plug(self) -> None:
        """Plug it in."""

    def unplug(self) -> None:
        """Pull it out; idempotent."""


@dataclass(frozen=True, slots=True)
class Rig:
    """A source, and the device behind it, whose first channel counts up in steps of `step` (V)."""

    source: str  # name in the registry
    device: Device
    rate_hz: float
    options: Mapping[str, Value]
    step: float

    def open(self) -> AbstractAsyncContextManager[EmgSource]:
        """The source, as a daemon opens it."""
        config = EmgConfig(self.rate_hz, 2, self.options)
        return registry.open_emg(self.source)(config, VirtualClock())


class Bridge:
    """LSL's, plugged in and out."""

    def __init__(self, pylsl: ModuleType, source_id: str) -> None:
        self._new = partial(lsl_outlet.Bridge, pylsl, source_id=source_id)
        self._bridge: lsl_outlet.Bridge | None = None

    def plug(self) -> None:
        self._bridge = self._new()
        self._bridge.__enter__()

    def unplug(self) -> None:
        if self._bridge:
            self._bridge.die()


def lsl(request: pytest.FixtureRequest, folder: Path) -> Rig:
    source_id = f"plugged-{folder.name}"
    device = Bridge(request.getfixturevalue("pylsl"), source_id)
    return Rig("lsl", device, lsl_outlet.RATE_HZ, {"source_id": source_id, "timeout_s": 0.3}, 1e-6)


def serial(request: pytest.FixtureRequest, folder: Path) -> Rig:
    options: Mapping[str, Value] = {"port": str(folder / "port"), "volts_per_lsb": 1e-6, "timeout_s": 0.3}
    return Rig("serial", serial_board.Board(folder / "port"), serial_board.RATE_HZ, options, 1e-6)


RIGS: Mapping[str, Callable[[pytest.FixtureRequest, Path], Rig]] = {"lsl": lsl, "serial": serial}


@pytest.fixture(params=sorted(RIGS))
def rig(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Rig]:
    rig = RIGS[request.param](request, tmp_path)
    rig.device.plug()
    yield rig
    rig.device.unplug()


async def heard(blocks: AsyncIterator[EmgBlock], seconds: float) -> list[tuple[float, EmgBlock]]:
    """Blocks with the times of their arrival, for so long after the first."""
    found: list[tuple[float, EmgBlock]] = []
    async with asyncio.timeout(PATIENCE):
        async for block in blocks:
            found.append((time.monotonic(), block))
            if found[-1][0] - found[0][0] > seconds:
                break
    return found


async def test_volts_come_at_the_rate_in_time_without_a_gap(rig: Rig) -> None:
    async with rig.open() as source:
        found = await heard(aiter(source), 0.8)
    blocks = [block for _, block in found]
    samples = np.concatenate([block.samples for block in blocks])
    assert source.rate_hz == pytest.approx(rig.rate_hz, rel=0.01)
    assert (str(samples.dtype), samples.shape[1]) == ("float32", source.channels)
    steps = np.diff(samples[:, 0]) / rig.step
    assert np.isclose(steps, 1.0, atol=1e-2).mean() > 0.98
    assert sum(block.dropped for block in blocks) == 0
    ends = [block.first_index + len(block.samples) for block in blocks]
    assert [block.first_index for block in blocks[1:]] == ends[:-1]
    spans = (blocks[-1].first_index - blocks[0].first_index) / rig.rate_hz
    assert blocks[-1].time - blocks[0].time == pytest.approx(spans, abs=0.1)
    ages = [arrival - block.time for arrival, block in found]
    assert -0.05 < float(np.median(ages)) < 1.0


async def test_a_source_can_be_stopped_and_leaves_nothing_running(rig: Rig) -> None:
    async with rig.open() as source:
        consumer = asyncio.create_task(heard(aiter(source), 100.0))
        await asyncio.sleep(0.1)
        consumer.cancel()
        await asyncio.wait([consumer])
    assert consumer.cancelled()
    assert asyncio.all_tasks() == {asyncio.current_task()}


@asynccontextmanager
async def told(rig: Rig) -> AsyncIterator[tuple[EmgSource, list[str], asyncio.Event]]:
    """The source as a daemon has it, what was told of its loss, and whether it is back."""
    async with reopening(rig.open, VirtualClock()) as source:
        reasons: list[str] = []
        back = asyncio.Event()
        source.lost, source.back = reasons.append, back.set
        yield source, reasons, back


async def test_a_device_that_was_unplugged_is_there_again_when_it_is_plugged_in(rig: Rig) -> None:
    async with told(rig) as (source, reasons, back):
        blocks = aiter(source)
        (_, before) = (await heard(blocks, 0.2))[-1]
        rig.device.unplug()
        pulled = time.monotonic()
        following = asyncio.create_task(heard(blocks, 0.2))
        async with asyncio.timeout(PATIENCE):
            while not reasons:  # noqa: ASYNC110 -- a device has no event
                await asyncio.sleep(0.01)
        assert reasons[0].startswith("The EMG source broke: ")
        rig.device.plug()
        await following
        assert back.is_set()
        (_, after) = (await heard(blocks, 0.0))[-1]
    assert after.time > pulled
    away = (after.first_index - before.first_index) / rig.rate_hz
    assert away == pytest.approx(after.time - before.time, abs=0.05)
