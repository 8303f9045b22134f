"""Muscles whose source broke: the arm stops, the source is opened again, and the wearer must rest first."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

import numpy as np
import pytest

from bentod.config_sites import Pair, Site
from bentod.contracts import Clock, EmgConfig
from bentod.emg.feed import Feed
from bentod.errors import InputFileError
from bentod.frames import EmgBlock
from bentod.muscles import Look, Muscles
from drivers.emg.options import parse
from sim import emg
from sim.clock import VirtualClock
from sim.emg import Synthetic
from sim.emg_wearer import Options
from tests.rig import PLAIN, joint, number, running, sim_config, state, table, wait_for

RATE_HZ = 200.0
SITES = [
    Site(name=name, channel=i, threshold_v=1.0, max_v=3.0) for i, name in enumerate(("up", "down", "next"))
]
PAIRS = [Pair(group="arm", positive="up", negative="down", toggle="next")]
UP, NEXT, REST = (4.0, 0.0, 0.0), (0.0, 0.0, 4.0), (0.0, 0.0, 0.0)
FLEXED = ('name = "synthetic"', 'name = "synthetic"\nprogram = [[0, 0.0, 2.0], [0, 1.0, 60.0]]')
LIMIT = 0.1  # s from the break to the stop


class Hand:
    """A source that is pumped by hand into the muscles."""

    rate_hz = RATE_HZ
    channels = 3

    def __init__(self) -> None:
        self.feed = Feed(self)
        self.muscles = Muscles(self.feed, SITES, PAIRS, window=10)
        self._index = 0

    async def __aiter__(self) -> AsyncIterator[EmgBlock]:
        nobody: list[EmgBlock] = []  # it is pumped by hand
        for block in nobody:
            yield block

    async def hold(self, seconds: float, levels: tuple[float, ...]) -> list[Look]:
        """What the muscles say, 30 times a second, while each site has a level (V)."""
        looks = []
        for number_ in range(round(seconds * RATE_HZ)):
            living = 0.91 + 0.02 * (self._index % 10)  # its mean over a window is 1
            now = asyncio.get_running_loop().time()
            self.feed._take(EmgBlock(self._index, now, living * np.array([levels], np.float32)))
            self._index += 1
            await asyncio.sleep(1 / RATE_HZ)
            if number_ % 6 == 5:
                looks.append(self.look())
        return looks

    def look(self) -> Look:
        return self.muscles.look(asyncio.get_running_loop().time())


def moved(looks: list[Look]) -> bool:
    return any(look.efforts.get("arm") or look.toggles for look in looks)


async def lost() -> Hand:
    """After a contraction, while the source was opened again."""
    hand = Hand()
    assert moved(await hand.hold(0.5, UP))
    hand.feed.lost("The EMG source broke: it was unplugged.")
    look = hand.look()
    assert (look.efforts, look.frame.problem) == ({}, "The EMG source broke: it was unplugged.")
    await asyncio.sleep(0.5)
    hand._index += 100
    hand.feed.back()
    return hand


async def test_a_contraction_that_was_there_when_the_source_came_back_moves_nothing() -> None:
    hand = await lost()
    looks = await hand.hold(5.0, UP)
    assert not moved(looks)
    frame = looks[-1].frame
    assert frame.alive
    assert frame.problem == "EMG is back; it moves nothing until every muscle has been at rest for 0.3 s."
    assert frame.effort["up"] == 1.0  # it is seen


@pytest.mark.parametrize(("seconds", "enough"), [(0.2, False), (0.5, True)])
async def test_a_rest_that_is_long_enough_gives_the_arm_back(seconds: float, enough: bool) -> None:
    hand = await lost()
    await hand.hold(1.0, UP)
    rested = await hand.hold(seconds, REST)
    assert not moved(rested)
    assert (rested[-1].frame.problem == "") is enough
    assert moved(await hand.hold(0.5, UP)) is enough


async def test_a_toggle_site_that_is_tense_holds_up_the_others() -> None:
    hand = await lost()
    assert not moved(await hand.hold(2.0, NEXT))
    assert not moved(await hand.hold(0.2, UP))
    await hand.hold(0.5, REST)
    assert [look.toggles for look in await hand.hold(0.3, NEXT) if look.toggles] == [["arm"]]


async def test_a_source_that_was_silent_for_long_is_one_that_was_lost() -> None:
    hand = Hand()
    await hand.hold(0.5, UP)
    looks = []
    for _ in range(45):  # 1.5 s
        await asyncio.sleep(1 / 30)
        looks.append(hand.look())
    assert not moved(looks[3:])
    hand._index += 300
    assert not moved(await hand.hold(1.0, UP))
    await hand.hold(0.5, REST)
    assert moved(await hand.hold(0.5, UP))


class Amplifier(Synthetic):
    """A simulated wearer whose amplifier can be pulled."""

    pulled = False

    async def __aiter__(self) -> AsyncIterator[EmgBlock]:
        async for block in super().__aiter__():
            if self.pulled:
                raise InputFileError("The amplifier was unplugged.")
            yield block


@pytest.fixture
def amplifiers(monkeypatch: pytest.MonkeyPatch) -> list[Amplifier]:
    """Each that a daemon opened; while the newest is pulled, there is none to be opened."""
    found: list[Amplifier] = []

    @asynccontextmanager
    async def plugged(config: EmgConfig, clock: Clock) -> AsyncIterator[Amplifier]:
        if found and found[-1].pulled:
            raise InputFileError("There is no amplifier.")
        found.append(Amplifier(parse(Options, config.options), config.rate_hz, 3, clock))
        yield found[-1]

    monkeypatch.setattr(emg, "open_emg", plugged)
    return found


async def test_an_amplifier_that_is_pulled_stops_the_arm_and_moves_it_again_after_a_rest(
    tmp_path: Path, amplifiers: list[Amplifier]
) -> None:
    async with running(sim_config(PLAIN, FLEXED), tmp_path / "s") as arm:
        await wait_for(arm, lambda frame: number(joint(frame, "shoulder_rotation"), "velocity") > 0.3)
        amplifiers[0].pulled = True
        pulled = VirtualClock().now()
        stopped = await wait_for(
            arm, lambda frame: joint(frame, "shoulder_rotation")["sent"] == {"kind": "stop"}, 1
        )
        assert number(stopped, "time") - pulled <= LIMIT
        await asyncio.sleep(5)
        away = table((await state(arm))["emg"])
        assert away["problem"] == (
            "The EMG source broke: The amplifier was unplugged. "
            "It cannot be opened again: There is no amplifier."
        )
        amplifiers[0].pulled = False
        await wait_for(arm, lambda frame: bool(table(frame["emg"])["alive"]), 11)
        assert len(amplifiers) == 2
        before = await state(arm)
        # The wearer of the program rests for two seconds as the source begins, and so may move the arm again.
        again = await wait_for(arm, lambda frame: number(joint(frame, "shoulder_rotation"), "velocity") > 0.3)
        assert number(again, "time") - number(before, "time") > 0.3
        assert number(table(again["emg"]), "dropped") > 5 * RATE_HZ


async def test_who_goes_on_to_contract_after_the_source_came_back_moves_nothing(
    tmp_path: Path, amplifiers: list[Amplifier]
) -> None:
    tense = ('name = "synthetic"', 'name = "synthetic"\nprogram = [[0, 1.0, 60.0]]')
    config = sim_config(PLAIN, tense)
    async with running(config, tmp_path / "s") as arm:
        amplifiers[0].relaxed = True
        await asyncio.sleep(1)
        amplifiers[0].relaxed = False
        await wait_for(arm, lambda frame: number(joint(frame, "shoulder_rotation"), "velocity") > 0.3)
        amplifiers[0].pulled = True
        await asyncio.sleep(0.2)
        amplifiers[0].pulled = False
        await wait_for(arm, lambda frame: bool(table(frame["emg"])["alive"]), 11)
        await asyncio.sleep(5)
        frame = await state(arm)
        assert number(joint(frame, "shoulder_rotation"), "velocity") == 0
        assert "at rest for 0.3 s" in str(table(frame["emg"])["problem"])
        amplifiers[1].relaxed = True
        await asyncio.sleep(1)
        amplifiers[1].relaxed = False
        await wait_for(arm, lambda frame: number(joint(frame, "shoulder_rotation"), "velocity") > 0.3, 3)
