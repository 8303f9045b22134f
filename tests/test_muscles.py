"""From samples to what the wearer asks; a source that dies must let go of the arm within 100 ms."""

import asyncio
from collections.abc import AsyncIterator, Callable
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest

from bentod.client import Client
from bentod.config import Config
from bentod.config_sites import CoContraction, Pair, SingleSite, Site
from bentod.emg.feed import Feed
from bentod.errors import BadRequest
from bentod.frames import EmgBlock
from bentod.muscles import Look, Muscles
from sim.clock import EPOCH, VirtualClock
from sim.emg import Synthetic
from tests.rig import PLAIN, Table, joint, number, running, sim_config, state, table, tables, wait_for

RATE_HZ = 200.0
SITES = [
    Site(name=name, channel=i, threshold_v=1.0, max_v=3.0) for i, name in enumerate(("up", "down", "next"))
]
PAIRS = [Pair(group="arm", positive="up", negative="down", toggle="next")]
REST, FULL = 0.0, 4.0
LIMIT = 0.1  # s from the last sample to the stop
FLEXED = ('name = "synthetic"', 'name = "synthetic"\nprogram = [[0, 0.0, 2.0], [0, 1.0, 60.0]]')


class Wire:
    """A source that delivers what the test puts on it, through a feed to muscles."""

    rate_hz = RATE_HZ
    channels = 3

    def __init__(self, clock: VirtualClock) -> None:
        self._clock = clock
        self._blocks: asyncio.Queue[EmgBlock | None] = asyncio.Queue()
        self._index = 0
        self.feed = Feed(self)
        self.muscles = Muscles(self.feed, SITES, PAIRS, window=10)

    async def __aiter__(self) -> AsyncIterator[EmgBlock]:
        while block := await self._blocks.get():
            yield block

    async def signal(self, seconds: float, *levels: float) -> Look:
        """Let each site have a level (V) for so long; what the muscles say at the end."""
        for _ in range(round(seconds * RATE_HZ)):
            living = 0.91 + 0.02 * (self._index % 10)  # its mean over a window is 1
            samples = living * np.array([levels], np.float32)
            self._blocks.put_nowait(EmgBlock(self._index, self._clock.now(), samples))
            self._index += 1
            await asyncio.sleep(1 / RATE_HZ)
        return self.look()

    async def silence(self, seconds: float, lost: bool = True) -> Look:
        """Let time pass without a sample; they are lost, or the source was at rest itself."""
        self._index += round(seconds * RATE_HZ) if lost else 0
        await asyncio.sleep(seconds)
        return self.look()

    def look(self) -> Look:
        return self.muscles.look(self._clock.now())


@pytest.fixture
async def wire(clock: VirtualClock) -> AsyncIterator[Wire]:
    wire = Wire(clock)
    pump = asyncio.create_task(wire.feed.pump())
    yield wire
    pump.cancel()
    with suppress(asyncio.CancelledError):
        await pump


async def test_effort_is_what_one_site_has_more_than_the_other(wire: Wire) -> None:
    assert (await wire.signal(0.1, 2.0, REST, REST)).efforts == {"arm": pytest.approx(0.5)}
    assert (await wire.signal(0.1, 2.0, FULL, REST)).efforts == {"arm": pytest.approx(-0.5)}


@pytest.mark.parametrize(
    ("levels", "effort"),
    [((2.0, REST), 0.5), ((REST, 2.0), 0.5), ((2.0, 2.0), 1.0), ((FULL, FULL), 1.0), ((REST, REST), 0.0)],
)
async def test_two_pairs_of_one_group_add_up_and_each_works_alone(
    clock: VirtualClock, levels: tuple[float, float], effort: float
) -> None:
    wire = Wire(clock)
    pairs = [Pair(group="arm", positive=one, negative="next") for one in ("up", "down")]
    wire.muscles = Muscles(wire.feed, SITES, pairs, window=10)
    pump = asyncio.create_task(wire.feed.pump())
    assert (await wire.signal(0.1, *levels, REST)).efforts == {"arm": pytest.approx(effort)}
    pump.cancel()


async def test_a_contraction_of_the_third_site_toggles_once_after_a_rest(wire: Wire) -> None:
    assert (await wire.signal(0.4, REST, REST, REST)).toggles == []
    assert (await wire.signal(0.1, REST, REST, FULL)).toggles == ["arm"]
    look = await wire.signal(0.3, REST, REST, FULL)
    assert (look.toggles, look.frame.toggles) == ([], 1)


async def test_paused_muscles_drive_and_toggle_nothing_but_are_seen(wire: Wire) -> None:
    await wire.signal(0.4, REST, REST, REST)
    wire.muscles.paused = True
    look = await wire.signal(0.1, FULL, REST, FULL)
    assert (look.efforts, look.toggles) == ({}, [])
    assert look.frame.paused
    assert look.frame.effort == {"up": 1.0, "down": 0.0, "next": 1.0}
    wire.muscles.paused = False
    look = await wire.signal(0.1, FULL, REST, FULL)
    assert (look.efforts, look.toggles) == ({"arm": 1.0}, [])


async def test_a_silent_source_asks_nothing_and_says_for_how_long(wire: Wire) -> None:
    await wire.signal(0.2, FULL, REST, REST)
    look = await wire.silence(0.08)
    assert look.efforts == {}
    assert not look.frame.alive
    assert "No EMG sample for 0.08 s" in look.frame.problem


@pytest.mark.parametrize("lost", [True, False])
async def test_a_source_that_is_back_starts_from_rest(wire: Wire, lost: bool) -> None:
    await wire.signal(0.4, REST, REST, REST)
    await wire.signal(0.2, FULL, REST, REST)
    await wire.silence(0.5, lost)
    first = await wire.signal(2 / RATE_HZ, FULL, REST, FULL)
    assert (first.frame.alive, first.efforts) == (True, {"arm": 0.0})
    later = await wire.signal(0.2, FULL, REST, FULL)
    assert (later.efforts, later.toggles) == ({"arm": 1.0}, [])
    assert later.frame.dropped == (100 if lost else 0)


async def test_a_contraction_that_began_while_the_source_was_silent_does_not_toggle(wire: Wire) -> None:
    await wire.signal(0.4, REST, REST, REST)
    await wire.silence(0.5)
    assert (await wire.signal(0.3, REST, REST, FULL)).toggles == []


@pytest.mark.parametrize("rest", [REST, FULL])
async def test_a_wire_that_is_stuck_above_the_threshold_asks_nothing(
    clock: VirtualClock, wire: Wire, rest: float
) -> None:
    assert (await wire.signal(0.2, FULL, REST, REST)).efforts == {"arm": 1.0}
    for _ in range(20):
        stuck = EmgBlock(wire._index, clock.now(), np.array([[FULL, rest, REST]], np.float32))
        wire._blocks.put_nowait(stuck)
        wire._index += 1
        await asyncio.sleep(1 / RATE_HZ)
    look = wire.look()
    assert (look.efforts, look.frame.alive) == ({}, False)
    assert look.frame.problem.startswith("EMG channel 0 is stuck")
    assert (await wire.signal(0.2, FULL, REST, REST)).efforts == {"arm": 1.0}


async def test_a_site_can_be_changed_while_it_is_in_use(wire: Wire) -> None:
    await wire.signal(0.1, 2.0, REST, REST)
    wire.muscles.change_site("up", gain=1.25, threshold=None, maximum=None)
    assert wire.look().efforts == {"arm": pytest.approx(0.75)}
    wire.muscles.change_site("up", gain=None, threshold=2.0, maximum=4.0)
    assert wire.look().efforts == {"arm": pytest.approx(0.25)}
    assert tables(wire.muscles.describe(), "sites")[0] == {
        "name": "up",
        "channel": 0,
        "gain": 1.25,
        "threshold_v": 2.0,
        "max_v": 4.0,
        "release": 1.0,
    }


async def test_a_changed_threshold_is_that_of_the_toggle_too(wire: Wire) -> None:
    wire.muscles.change_site("next", gain=None, threshold=5.0, maximum=6.0)
    await wire.signal(0.4, REST, REST, REST)
    assert (await wire.signal(0.2, REST, REST, FULL)).toggles == []


async def test_a_change_that_makes_no_sense_is_refused_and_changes_nothing(wire: Wire) -> None:
    before = wire.muscles.describe()
    with pytest.raises(BadRequest, match="did you mean 'down'"):
        wire.muscles.change_site("dwn", gain=2.0, threshold=None, maximum=None)
    with pytest.raises(BadRequest, match="must be above the threshold"):
        wire.muscles.change_site("up", gain=2.0, threshold=9.0, maximum=None)
    assert wire.muscles.describe() == before


def test_without_a_source_there_is_no_wearer() -> None:
    look = Muscles().look(0.0)
    assert (look.efforts, look.toggles) == ({}, ())
    assert look.frame.problem == "The config has no [emg] table."


async def shoulder_moves(arm: Client) -> Table:
    return await wait_for(arm, lambda frame: number(shoulder(frame), "velocity") > 0.3)


def shoulder(frame: Table) -> Table:
    return joint(frame, "shoulder_rotation")


def is_stopped(frame: Table) -> bool:
    return shoulder(frame)["sent"] == {"kind": "stop"}


async def stopped_after(arm: Client, began: float) -> tuple[float, Table]:
    """Seconds from `began` (virtual s) until a stop had been written, and that tick's frame."""
    frame = await wait_for(arm, is_stopped, 1)
    return number(frame, "wall") - EPOCH - began, frame


def _stall(source: Synthetic, on: bool) -> None:
    source.stall = on


def _nan(source: Synthetic, on: bool) -> None:
    source.nan = on


def _end(source: Synthetic, on: bool) -> None:
    source.end = on


BREAKS = [pytest.param(fault, id=fault.__name__[1:]) for fault in (_stall, _nan, _end)]
PHASES_MS = [0, 9, 17, 26]  # where in the tick it happens


@pytest.mark.parametrize("phase_ms", PHASES_MS)
@pytest.mark.parametrize("fault", BREAKS)
async def test_a_source_that_dies_in_mid_contraction_stops_the_arm_within_100_ms(
    tmp_path: Path, sources: list[Synthetic], fault: Callable[[Synthetic, bool], None], phase_ms: int
) -> None:
    async with running(sim_config(PLAIN, FLEXED), tmp_path / "s") as arm:
        await shoulder_moves(arm)
        await asyncio.sleep(phase_ms / 1000)
        fault(sources[0], True)
        seconds, frame = await stopped_after(arm, VirtualClock().now())
        assert seconds <= LIMIT
        assert not table(frame["emg"])["alive"]
        assert frame["mode"] == "active"


async def test_the_stop_is_as_quick_on_the_real_bus(tmp_path: Path, sources: list[Synthetic]) -> None:
    async with running(sim_config(FLEXED), tmp_path / "s") as arm:
        await shoulder_moves(arm)
        sources[0].stall = True
        seconds, _ = await stopped_after(arm, VirtualClock().now())
        assert seconds <= LIMIT
        await asyncio.sleep(0.5)
        assert number(shoulder(await state(arm)), "velocity") == 0


@pytest.mark.parametrize("fault", BREAKS[:2])
async def test_a_source_that_comes_back_moves_the_arm_again_without_a_toggle(
    tmp_path: Path, sources: list[Synthetic], fault: Callable[[Synthetic, bool], None]
) -> None:
    async with running(sim_config(PLAIN, FLEXED), tmp_path / "s") as arm:
        await shoulder_moves(arm)
        fault(sources[0], True)
        await wait_for(arm, is_stopped, 1)
        await asyncio.sleep(0.5)
        fault(sources[0], False)
        again = await shoulder_moves(arm)
        assert number(table(again["emg"]), "toggles") == 0


def recording(path: Path) -> None:
    """A flexor that rests for a second and contracts for one, and then nothing more, as .npz or .csv (V)."""
    volts = np.zeros((400, 3))
    volts[200:, 0] = np.random.default_rng(1).normal(0, 60e-6, 200)
    if path.suffix == ".npz":
        np.savez(path, emg=volts, fs=RATE_HZ)
    else:
        table = np.column_stack((np.arange(400) / RATE_HZ, volts))
        np.savetxt(path, table, delimiter=",", header="time,a,b,c", comments="")


def played_once(path: Path) -> Config:
    """The simulated arm with a recording in the place of its wearer."""
    source = f'name = "replay"\nfile = "{path}"\nloop = false'
    return sim_config(PLAIN, ('name = "synthetic"', source), ("again and again\nseed = 1", ""))


@pytest.mark.parametrize("name", ["contraction.npz", "contraction.csv"])
async def test_the_end_of_a_recording_in_mid_contraction_stops_the_arm_within_100_ms(
    tmp_path: Path, name: str
) -> None:
    recording(tmp_path / name)
    async with running(played_once(tmp_path / name), tmp_path / "s") as arm:
        await shoulder_moves(arm)
        stopped = await wait_for(arm, is_stopped, 3)
        muscles = table(stopped["emg"])
        assert muscles["problem"] == "The EMG source ended after sample 399."
        assert number(muscles, "age") <= LIMIT
        await asyncio.sleep(1)
        assert is_stopped(await state(arm))


SQUEEZED = [PAIRS[0].model_copy(update={"toggle": None, "co_contraction": CoContraction()})]


async def squeezing(wire: Wire) -> Wire:
    """The same wire to muscles that toggle by a squeeze, at rest."""
    wire.muscles = Muscles(wire.feed, SITES, SQUEEZED, window=10)
    await wire.signal(0.5, REST, REST, REST)
    return wire


async def test_a_squeeze_of_both_sites_toggles_and_moves_nothing(wire: Wire) -> None:
    await squeezing(wire)
    look = await wire.signal(0.4, FULL, 2.5, REST)
    assert (look.toggles, look.efforts, look.tense) == (["arm"], {"arm": 0.0}, {"arm"})
    look = await wire.signal(0.4, FULL, 2.5, REST)
    assert (look.toggles, look.efforts, look.frame.toggles) == ([], {"arm": 0.0}, 1)


async def test_a_squeeze_that_toggles_back_is_told_apart(wire: Wire) -> None:
    await squeezing(wire)
    back = SQUEEZED[0].model_copy(update={"co_contraction": CoContraction(direction="backward")})
    wire.muscles = Muscles(wire.feed, SITES, [back], window=10)
    await wire.signal(0.5, REST, REST, REST)
    look = await wire.signal(0.4, FULL, 2.5, REST)
    assert (look.asked.toggles, look.asked.toggles_back) == ([], ["arm"])


async def test_a_squeeze_that_began_while_the_muscles_were_paused_or_lost_is_forgotten(wire: Wire) -> None:
    await squeezing(wire)
    await wire.signal(0.1, FULL, FULL, REST)
    wire.muscles.paused = True
    wire.look()
    wire.muscles.paused = False
    assert (await wire.signal(0.4, FULL, 2.0, REST)).asked.efforts == {"arm": 0.0}
    await wire.signal(0.5, REST, REST, REST)
    await wire.signal(0.1, FULL, FULL, REST)
    await wire.silence(0.2)
    look = await wire.signal(0.4, FULL, 2.0, REST)
    assert (look.efforts, look.frame.toggles) == ({"arm": 0.0}, 0)
    await wire.signal(0.5, REST, REST, REST)
    assert (await wire.signal(0.4, FULL, FULL, REST)).toggles == ["arm"]


async def test_muscles_that_were_not_listened_to_for_long_start_from_rest(wire: Wire) -> None:
    await squeezing(wire)
    await wire.signal(0.1, FULL, FULL, REST)
    for _ in range(800):  # more than the ring holds
        wire._blocks.put_nowait(
            EmgBlock(wire._index, asyncio.get_running_loop().time(), np.ones((1, 3), np.float32))
        )
        wire._index += 1
        await asyncio.sleep(1 / RATE_HZ)
    assert wire.look().toggles == []
    assert (await wire.signal(0.5, REST, REST, REST)).toggles == []


async def test_pairs_that_cancel_out_are_still_tense(wire: Wire) -> None:
    look = await wire.signal(0.2, FULL, FULL, REST)
    assert (look.efforts, look.tense) == ({"arm": 0.0}, {"arm"})
    assert (await wire.signal(0.2, REST, REST, REST)).tense == set()


async def test_a_release_can_be_set_while_the_site_is_in_use(wire: Wire) -> None:
    wire.muscles.change_site("up", release=0.5)
    await wire.signal(0.2, 2.0, REST, REST)
    assert (await wire.signal(0.2, 0.9, REST, REST)).efforts == {"arm": pytest.approx(0.4 / 2.5, abs=0.01)}
    with pytest.raises(BadRequest, match="the release is 0"):
        wire.muscles.change_site("up", release=0.0)


async def test_one_site_alone_drives_a_group(wire: Wire) -> None:
    wire.muscles = Muscles(wire.feed, SITES, (), 10, [SingleSite(group="hand", site="up", toggle="next")])
    await wire.signal(0.5, REST, REST, REST)
    assert (await wire.signal(0.4, 1.5, REST, REST)).efforts == {"hand": pytest.approx(0.25)}
    await wire.signal(0.5, REST, REST, REST)
    look = await wire.signal(0.4, FULL, REST, FULL)
    assert (look.efforts, look.toggles) == ({"hand": -1.0}, ["hand"])


async def test_whoever_squeezes_when_the_arm_is_released_toggles_nothing(tmp_path: Path) -> None:
    squeeze = ('toggle = "other_forearm"', "co_contraction = {}")
    held = ('name = "synthetic"', 'name = "synthetic"\nprogram = [[0, 0.0, 2.0], [0, 1.0, 60.0, 1]]')
    async with running(sim_config(PLAIN, squeeze, held), tmp_path / "s") as arm:
        await wait_for(arm, lambda frame: number(table(frame["emg"]), "next_index") > 350)
        await arm.call("pause")
        await wait_for(arm, lambda frame: number(table(table(frame["emg"])["effort"]), "flexor") > 0.05)
        await arm.call("pause", on=False)
        await asyncio.sleep(1.0)
        frame = await state(arm)
        assert tables(frame, "groups")[0]["active"] == "shoulder_rotation"
        assert is_stopped(frame)
