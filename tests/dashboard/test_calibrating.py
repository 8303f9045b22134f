"""Muscles calibrated from the page's server: a whole daemon, whose wearer does as told, in virtual time."""

import asyncio
import math
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

import pytest

from bentod.client import Client
from bentod.config import Config
from bentod.dashboard import calibrating, muscle_levels
from bentod.dashboard.site import Site
from bentod.dashboard.visitor import Visitor
from bentod.errors import BadRequest, ConfigError, Refused
from bentod.frames import Value
from tests.rig import PLAIN, number, running, sim_config, table, tables, wait_for

TIMES: dict[str, Value] = {"ready": 0.5, "rest": 2.0, "hold": 1.5}
LONG: dict[str, Value] = {"ready": 1.0, "rest": 30.0, "hold": 2.0}
BEGIN = 1.5
"""s after the wearer's first sample, at which `TIMES` fit what the wearer does."""


def obedient() -> Config:
    """A wearer who from `BEGIN` on does what is asked for, a little early and for a little longer."""
    steps = [[0, 0.0, 4.4], [0, 1.0, 2.0], [1, 0.08, 2.1], [2, 1.0, 3.0], [0, 0.0, 60.0]]
    changed = ('name = "synthetic"', f'name = "synthetic"\nlag_s = 0.0\nprogram = {steps}')
    return sim_config(PLAIN, changed).model_copy(update={"learn": None, "assist": None})


@dataclass
class Lab:
    """A daemon, the page's server and its tasks."""

    arm: Client
    site: Site
    tasks: asyncio.TaskGroup

    def visitor(self, role: str = "operator") -> Visitor:
        return self.site.visitor(role, lambda _: None, self.tasks)

    @property
    def told(self) -> dict[str, Value]:
        return table(self.site.told.get(calibrating.KEY) or {})

    async def watched(self, measuring: "asyncio.Task[Value]") -> list[tuple[Value, Value]]:
        """What every browser is told that the wearer is to do: the site, and whether to get ready."""
        seen: list[tuple[Value, Value]] = []
        while not measuring.done():
            now = (self.told.get("site"), self.told.get("ready"))
            if self.told.get("phase") == "asking" and None not in now and now not in seen[-1:]:
                seen.append(now)
                assert await self.paused()
                assert 0 <= number(self.told, "left") <= 2.0
            await asyncio.sleep(0.05)
        return seen

    async def paused(self) -> bool:
        return bool(table(await self.arm.call("emg_get"))["paused"])


@asynccontextmanager
async def lab(config: Config, socket: Path) -> AsyncIterator[Lab]:
    async with running(config, socket) as arm, asyncio.TaskGroup() as tasks:
        site = Site(lambda: Client.connect(socket), "build")
        serving = tasks.create_task(site.run())
        while site.knowledge is None:  # noqa: ASYNC110 -- the server tells browsers, not tests
            await asyncio.sleep(0.01)
        yield Lab(arm, site, tasks)
        serving.cancel()


async def test_the_page_measures_what_the_terminal_measures_and_sets_it_when_asked_to(tmp_path: Path) -> None:
    async with lab(obedient(), tmp_path / "s") as here:
        page = here.visitor("operator")
        await wait_for(here.arm, lambda frame: number(table(frame["emg"]), "next_index") >= BEGIN * 200)
        measuring = here.tasks.create_task(calibrating.start(page, TIMES))
        seen = await here.watched(measuring)
        order = ["", "flexor", "extensor", "other_forearm"]
        assert seen == [(site, ready) for site in order for ready in (True, False)]
        found = table(await measuring)
        assert not await here.paused()
        flexor, extensor, other = tables(found, "results")
        assert number(flexor, "rest_v") == pytest.approx(2.5e-6, rel=0.15)
        assert number(table(flexor["after"]), "threshold_v") == pytest.approx(4.5e-6, rel=0.15)
        assert flexor["before"] == {"threshold_v": 10e-6, "max_v": 30e-6}
        assert (flexor["separable"], extensor["separable"], other["separable"]) == (True, False, True)
        assert "can hardly be told from rest" in str(extensor["remarks"])
        assert tables(table(await here.arm.call("emg_get")), "sites")[0]["threshold_v"] == 10e-6
        done = table(await calibrating.use(page, {}))
        assert done["set"] == ["flexor", "other_forearm"]
        sites = tables(table(await here.arm.call("emg_get")), "sites")
        assert sites[0]["threshold_v"] == table(flexor["after"])["threshold_v"]
        assert sites[1]["threshold_v"] == 10e-6
        assert f"threshold_v = {number(sites[0], 'threshold_v'):g}" in str(flexor["lines"])
        await page.leave()


@pytest.mark.parametrize("was", [True, False])
async def test_when_the_page_vanishes_the_muscles_are_put_back_as_they_were(
    tmp_path: Path, was: bool
) -> None:
    async with lab(obedient(), tmp_path / "s") as here:
        await here.arm.call("emg_pause", on=was)
        page = here.visitor()
        measuring = asyncio.create_task(calibrating.start(page, LONG))
        await asyncio.sleep(2.0)
        assert await here.paused()
        await page.leave()
        with pytest.raises(Refused, match="page that wanted it is gone"):
            await measuring
        assert await here.paused() is was
        await asyncio.sleep(0.1)
        assert (here.told["phase"], here.told["why"]) == ("over", calibrating.GONE)
        with pytest.raises(Refused, match="nothing was measured"):
            await calibrating.use(here.visitor(), {})


async def test_when_the_server_ends_the_muscles_are_put_back_too(tmp_path: Path) -> None:
    async with lab(obedient(), tmp_path / "s") as here:
        measuring = asyncio.create_task(calibrating.start(here.visitor(), LONG))
        await asyncio.sleep(2.0)
        measuring.cancel()
        with suppress(asyncio.CancelledError):
            await measuring
        assert not await here.paused()


async def test_any_operator_may_cancel_and_there_is_only_one_at_a_time(tmp_path: Path) -> None:
    async with lab(obedient(), tmp_path / "s") as here:
        one, other = here.visitor(), here.visitor()
        with pytest.raises(Refused, match="no calibration is under way"):
            await calibrating.cancel(other, {})
        measuring = asyncio.create_task(calibrating.start(one, LONG))
        await asyncio.sleep(2.0)
        with pytest.raises(Refused, match="being calibrated already"):
            await calibrating.start(other, TIMES)
        await calibrating.cancel(other, {})
        with pytest.raises(Refused, match="cancelled; nothing was set"):
            await measuring
        assert not await here.paused()
        again = asyncio.create_task(calibrating.start(other, LONG))
        await asyncio.sleep(2.0)
        assert (here.told["run"], here.told["phase"]) == (2, "asking")
        await here.arm.call("emg_pause", on=False)
        with pytest.raises(Refused, match="somebody let the muscles drive again"):
            await again


async def test_what_makes_no_sense_is_refused_and_the_muscles_go_on(tmp_path: Path) -> None:
    wrong: dict[str, dict[str, Value]] = {
        "rest must be from 1.5 to 60 s": {"rest": 1.0},
        "hold must be": {"hold": math.nan},
        "ready must be": {"ready": True},
        "sites must be a list": {"sites": "flexor"},
        "did you mean 'flexor'": {"sites": ["flexr"]},
    }
    async with lab(obedient(), tmp_path / "s") as here:
        for why, params in wrong.items():
            with pytest.raises((BadRequest, ConfigError), match=why):
                await calibrating.start(here.visitor(), TIMES | params)
        assert not await here.paused()


async def test_browsers_that_look_at_levels_at_once_ask_the_daemon_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    async with lab(obedient(), tmp_path / "s") as here:
        asked: list[str] = []
        look = here.site.look

        async def counted(method: str, params: dict[str, Value]) -> Value:
            asked.append(method)
            return await look(method, params)

        monkeypatch.setattr(here.site, "look", counted)
        pages = [here.visitor("observer") for _ in range(20)]
        answers = await asyncio.gather(*(muscle_levels.levels(page, {}) for page in pages))
        assert asked == ["emg_levels"]
        assert all(answer == answers[0] for answer in answers)
        await asyncio.sleep(0.1)
        newer = table(await muscle_levels.levels(pages[0], {}))
        assert number(newer, "index") > number(table(answers[0]), "index")
