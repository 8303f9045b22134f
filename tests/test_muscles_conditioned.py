"""Filters and leads in use: what the wearer asks through them, in a whole daemon and sample by sample."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bentod.client import Client
from bentod.config import Config
from bentod.config_conditioning import Filter, Leads
from bentod.config_sites import Pair, Site
from bentod.emg.conditioning import Conditioning
from bentod.emg.electrodes import Electrodes
from bentod.emg.feed import Feed
from bentod.errors import ConfigError
from bentod.frames import EmgBlock, Samples
from bentod.muscles import Muscles
from sim.clock import VirtualClock
from sim.emg import Synthetic
from sim.emg_wearer import Options, Wearer
from tests.rig import PLAIN, Table, joint, number, running, sim_config, table, wait_for

RATE_HZ = 200.0
HIGH_PASS, NOTCH = Filter(kind="high_pass", hz=20), Filter(kind="notch", hz=50)
FILTERS = (HIGH_PASS, NOTCH)


def config(*changes: tuple[str, str], table: str = "", **source: object) -> Config:
    """A flexor that rests for two seconds and contracts for a minute, with more keys for source and [emg]."""
    keys = {"program": "[[0, 0.0, 2.0], [0, 1.0, 60.0]]", **source}
    told = "\n".join(['name = "synthetic"', *(f"{key} = {value}" for key, value in keys.items())])
    whole = sim_config(
        PLAIN, ('name = "synthetic"', told), ("[emg.source]", f"{table}\n[emg.source]"), *changes
    )
    return whole.model_copy(update={"learn": None, "assist": None})


NOTCHED = "[[emg.filters]]\nkind = 'high_pass'\nhz = 20\n[[emg.filters]]\nkind = 'notch'\nhz = 50\n"


def speed(frame: Table) -> float:
    return number(joint(frame, "shoulder_rotation"), "velocity")


def effort(frame: Table, site: str = "flexor") -> float:
    return number(table(table(frame["emg"])["effort"]), site)


async def test_hum_that_nobody_filters_moves_nothing_and_is_told_once_for_each_site(tmp_path: Path) -> None:
    heard: list[Table] = []

    async def listen(arm: Client) -> None:
        async with arm.listen("events") as events:
            async for event in events:
                heard.append(event)

    async with running(config(hum_v=300e-6), tmp_path / "s") as arm:
        listening = asyncio.create_task(listen(arm))
        frame = await wait_for(arm, lambda frame: "hum of 50 Hz" in str(table(frame["emg"])["problem"]))
        assert str(table(frame["emg"])["problem"]).startswith("EMG site flexor: ")
        await asyncio.sleep(3.0)
        frame = table(await arm.call("get_state"))
        assert (speed(frame), effort(frame)) == (0.0, 0.0)
        assert table(frame["emg"])["alive"]
        told = table(await arm.call("emg_levels"))
        assert list(table(told["leads_off"])) == ["flexor", "extensor", "other_forearm"]
        assert set(table(told["levels_v"]).values()) == {None}
        listening.cancel()
    texts = [str(event["text"]) for event in heard if event["kind"] == "emg"]
    assert sorted(text.split()[2] for text in texts) == ["extensor", "flexor", "other_forearm"]


async def test_the_arm_moves_through_filters_that_take_the_hum_out(tmp_path: Path) -> None:
    async with running(config(hum_v=60e-6, table=NOTCHED), tmp_path / "s") as arm:
        resting = await wait_for(arm, lambda frame: number(table(frame["emg"]), "next_index") > 350)
        assert effort(resting) == 0.0
        await wait_for(arm, lambda frame: effort(frame) > 0.5 and speed(frame) > 0.1, 5.0)


@pytest.mark.parametrize("envelope", ["rms", "low_pass"])
async def test_other_envelopes_move_the_arm_as_well(tmp_path: Path, envelope: str) -> None:
    async with running(config(table=f"envelope = '{envelope}'"), tmp_path / "s") as arm:
        await wait_for(arm, lambda frame: effort(frame) > 0.5 and speed(frame) > 0.1, 5.0)


@pytest.mark.parametrize("volts", [1e-3, 100e-6])
async def test_a_lead_that_sticks_stops_all_muscles_as_long_as_it_does(
    tmp_path: Path, sources: list[Synthetic], volts: float
) -> None:
    async with running(config(), tmp_path / "s") as arm:
        await wait_for(arm, lambda frame: speed(frame) > 0.1)
        sources[0].stuck = {1: volts}
        await wait_for(arm, lambda frame: not table(frame["emg"])["alive"], 0.2)
        await asyncio.sleep(1.0)
        frame = table(await arm.call("get_state"))
        assert "EMG channel 1 is stuck" in str(table(frame["emg"])["problem"])
        assert speed(frame) == 0.0
        sources[0].stuck = {}
        await wait_for(arm, lambda frame: bool(table(frame["emg"])["alive"]), 0.2)
        assert table(await arm.call("emg_levels"))["leads_off"] == {}


async def test_a_filter_that_the_source_is_too_slow_for_stops_the_start(tmp_path: Path) -> None:
    path = tmp_path / "slow.npz"
    np.savez(path, emg=np.zeros((1000, 3)), fs=60.0)
    slow = config(
        ('name = "synthetic"', f'name = "replay"\nfile = "{path}"'),
        ("seed = 1\n\n[[emg.sites]]", "\n[[emg.sites]]"),
        ("program = [[0, 0.0, 2.0], [0, 1.0, 60.0]]", ""),
        table=NOTCHED,
    )
    with pytest.raises(ConfigError, match=r"emg\.filters\.1\.hz = 50: the bound is 29\.4 Hz"):
        async with running(slow, tmp_path / "s"):
            pass


def test_what_is_conditioned_on_line_is_what_is_conditioned_from_the_recording() -> None:
    recording = Wearer(Options(hum_v=50e-6), RATE_HZ, 3).read(0, 2000)
    recording[700:730] = np.nan
    electrodes = Electrodes(FILTERS, Leads(), RATE_HZ, 3)
    seen = []
    for first in range(0, 2000, 37):
        electrodes.step(recording[first : first + 37], first)
        seen.append(electrodes.conditioned)
    whole = Conditioning(FILTERS, RATE_HZ, 3).step(recording)
    np.testing.assert_array_equal(np.concatenate(seen), whole)


@settings(max_examples=6, deadline=None)
@given(gap=st.integers(1, 5000))
def test_what_was_overwritten_before_anybody_looked_counts_as_missing(gap: int) -> None:
    recording = Wearer(Options(), RATE_HZ, 3).read(0, 400)
    late, told = (Electrodes(FILTERS, Leads(), RATE_HZ, 3) for _ in range(2))
    for electrodes in (late, told):
        electrodes.step(recording, 0)
    told.step(np.full((gap, 3), np.nan, np.float32), 400)
    late.step(recording, 400 + gap)
    told.step(recording, 400 + gap)
    np.testing.assert_array_equal(late.conditioned, told.conditioned)


class Wire:
    """Three sites behind electrodes, fed by hand."""

    rate_hz = RATE_HZ
    channels = 3

    def __init__(self, clock: VirtualClock, *filters: Filter) -> None:
        names = ("up", "down", "next")
        sites = [Site(name=name, channel=i, threshold_v=10e-6, max_v=30e-6) for i, name in enumerate(names)]
        pairs = [Pair(group="arm", positive="up", negative="down", toggle="next")]
        self._clock = clock
        self._blocks: asyncio.Queue[EmgBlock] = asyncio.Queue()
        self._index = 0
        self.feed = Feed(self)
        electrodes = Electrodes(filters, Leads(), RATE_HZ, 3)
        self.muscles = Muscles(self.feed, sites, pairs, electrodes=electrodes)
        self.told: list[str] = []
        self.muscles.tell = lambda text, _: self.told.append(text)

    async def __aiter__(self) -> AsyncIterator[EmgBlock]:
        while True:
            yield await self._blocks.get()

    async def play(self, samples: Samples) -> tuple[float, int]:
        """The newest effort of the group, and toggles meanwhile."""
        effort, toggles = 0.0, 0
        for start in range(0, len(samples), 6):
            block = samples[start : start + 6]
            self._blocks.put_nowait(EmgBlock(self._index, self._clock.now(), block))
            self._index += len(block)
            await asyncio.sleep(len(block) / RATE_HZ)
            look = self.muscles.look(self._clock.now())
            effort, toggles = look.efforts.get("arm", 0.0), toggles + len(look.toggles)
        return effort, toggles


@asynccontextmanager
async def wired(clock: VirtualClock, *filters: Filter) -> AsyncIterator[Wire]:
    wire = Wire(clock, *filters)
    pump = asyncio.create_task(wire.feed.pump())
    yield wire
    pump.cancel()
    with suppress(asyncio.CancelledError):
        await pump


def muscles(seconds: float, up: float = 0.0, toggle: float = 0.0, hum: float = 0.0) -> Samples:
    """Muscles at these levels; hum (V) on the toggle site."""
    program = Options(program=((0, up, seconds),), lag_s=0.0)
    other = Options(program=((2, toggle, seconds),), lag_s=0.0, seed=2)
    count = round(seconds * RATE_HZ)
    samples = Wearer(program, RATE_HZ, 3).read(0, count)
    samples[:, 2] = Wearer(other, RATE_HZ, 3).read(0, count)[:, 2]
    samples[:, 2] += hum * np.sin(2 * np.pi * 50 / RATE_HZ * np.arange(count) + 0.5)
    return samples


async def test_a_toggle_site_whose_lead_is_off_does_not_toggle_when_it_is_back(clock: VirtualClock) -> None:
    async with wired(clock) as wire:
        assert await wire.play(muscles(1.0)) == (0.0, 0)
        await wire.play(muscles(0.5, hum=400e-6))  # that it came off is known after a quarter of a second
        assert len(wire.told) == 1
        effort, toggles = await wire.play(muscles(1.0, up=1.0, hum=400e-6))
        assert (effort > 0.5, toggles) == (True, 0)
        assert (await wire.play(muscles(1.0, toggle=1.0)))[1] == 0
        assert (await wire.play(muscles(1.5)))[1] == 0
        assert len(wire.told) == 2
        assert (await wire.play(muscles(1.0, toggle=1.0)))[1] == 1


async def test_an_offset_is_no_wire_that_is_stuck_once_a_filter_takes_it_away(clock: VirtualClock) -> None:
    async with wired(clock, HIGH_PASS) as wire:
        offset = np.float32(0.3)
        assert (await wire.play(muscles(1.0) + offset))[0] == 0.0
        assert (await wire.play(muscles(1.0, up=1.0) + offset))[0] > 0.5
    async with wired(clock) as wire:
        await wire.play(muscles(1.0, up=1.0) + offset)
        assert wire.muscles.look(clock.now()).efforts.get("arm", 0.0) == 0.0


async def test_a_changed_threshold_is_that_of_the_leads_too(clock: VirtualClock) -> None:
    async with wired(clock) as wire:
        await wire.play(muscles(1.0, hum=20e-6))
        assert len(wire.told) == 1
        wire.muscles.change_site("next", threshold=50e-6, maximum=100e-6)
        await wire.play(muscles(1.0, hum=20e-6))
        assert wire.told[-1].endswith("is well again")
