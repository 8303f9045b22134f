"""A homing that goes on only while somebody holds the button, through the socket of a whole daemon."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

from bentod.client import Client
from bentod.endpoint import RpcError
from bentod.frames import Value
from tests.rig import PLAIN, Table, joint, number, quiet_config, running, state, table, wait_for

RENEWED = 0.05
"""s between two renewals, as a page sends them."""

LEASE = 0.15


@asynccontextmanager
async def away_from_home(folder: Path) -> AsyncIterator[tuple[Client, Client]]:
    """An arm whose elbow is far from home, released, and two clients."""
    socket = folder / "bentod.sock"
    async with running(quiet_config(PLAIN), socket) as arm, Client.connect(socket) as other:
        await arm.call("hello", "page")
        await other.call("hello", "other")
        await arm.call("move", joint="elbow_flexion", velocity=0.5, lease_s=1.5)
        await asyncio.sleep(2.0)
        yield arm, other


async def hold(arm: Client, seconds: float) -> list[Value]:
    """Numbers of the goals that were renewed, or why not."""
    answers: list[Value] = []
    for _ in range(round(seconds / RENEWED)):
        try:
            answers.append(table(await arm.call("go_home", joints="elbow_flexion", lease_s=LEASE))["goal"])
        except RpcError as error:
            answers.append(str(error))
        await asyncio.sleep(RENEWED)
    return answers


def goal(frame: Table) -> tuple[str, str]:
    found = table(frame["goal"])
    return str(found["status"]), str(found["reason"])


def velocity(frame: Table) -> float:
    return abs(number(joint(frame, "elbow_flexion"), "velocity"))


async def test_it_goes_on_while_it_is_held_and_stops_soon_after(tmp_path: Path) -> None:
    async with away_from_home(tmp_path) as (arm, _):
        assert set(await hold(arm, 0.8)) == {1}
        assert velocity(await state(arm)) > 0.1
        await asyncio.sleep(0.1 + LEASE)
        assert goal(await state(arm)) == ("cancelled", "its lease ran out")
        await wait_for(arm, lambda frame: velocity(frame) < 0.02, seconds=0.5)


async def test_it_ends_with_its_client(tmp_path: Path) -> None:
    async with away_from_home(tmp_path) as (arm, _):
        async with Client.connect(tmp_path / "bentod.sock") as page:
            await page.call("go_home", joints="elbow_flexion", lease_s=2.0)
        frame = await wait_for(arm, lambda frame: goal(frame)[0] == "cancelled", seconds=0.5)
        assert goal(frame)[1] == "its client is gone"


async def test_a_stop_holds_although_the_button_is_still_held(tmp_path: Path) -> None:
    async with away_from_home(tmp_path) as (arm, other):
        await hold(arm, 0.3)
        await other.call("stop")
        answers = await hold(arm, 1.0)
        assert all("was cancelled (stopped by other): let go" in str(answer) for answer in answers)
        frame = await state(arm)
        assert velocity(frame) < 0.02
        assert frame["mode"] == "paused"
        await asyncio.sleep(0.3)
        assert set(await hold(arm, 0.2)) == {2}


async def test_a_homing_that_is_cancelled_pauses_nothing_and_may_be_asked_for_at_once(tmp_path: Path) -> None:
    async with away_from_home(tmp_path) as (arm, other):
        await hold(arm, 0.2)
        assert await arm.call("go_home_cancel") is True
        assert goal(await state(arm)) == ("cancelled", "cancelled by page")
        assert (await state(arm))["mode"] == "active"
        assert await hold(arm, 0.1) == [2, 2]
        assert await other.call("go_home_cancel") is True
        assert await other.call("go_home_cancel") is False
        assert "cancelled by other" in str(await hold(arm, 0.05))


async def test_a_homing_without_a_lease_outlives_its_client_as_ever(tmp_path: Path) -> None:
    async with away_from_home(tmp_path) as (arm, _):
        async with Client.connect(tmp_path / "bentod.sock") as script:
            await script.call("go_home", joints="elbow_flexion")
        frame = await wait_for(arm, lambda frame: goal(frame)[0] not in ("accepted", "moving"))
        assert goal(frame) == ("done", "")
