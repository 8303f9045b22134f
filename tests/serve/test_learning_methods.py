"""What clients may ask about the future while the arm runs, and who may."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import cast

import pytest

from bentod.client import Client
from bentod.config_tables import Access
from bentod.endpoint import RpcError
from bentod.frames import Value
from bentod.inbox import Inbox
from bentod.serve.methods import arm_methods
from bentod.serve.room import About, Room
from bentod.serve.server import Server
from bentod.serve.unix_door import UnixDoor
from tests.rig import PLAIN, Table, number, quiet_config, running, state, table, wait_for
from tests.serve.doors import NOBODY, said
from tests.serve.helpers import plugged

SPEED: dict[str, Value] = {"name": "speed", "cumulant": "elbow_flexion.velocity", "timescale_s": 0.5}
ARM = [f"{joint}.position@{steps}" for steps in (10, 20) for joint in
       ("shoulder_rotation", "elbow_flexion", "wrist_rotation", "wrist_flexion", "gripper")]  # fmt: skip


@asynccontextmanager
async def learning(folder: Path) -> AsyncIterator[Client]:
    async with running(quiet_config(PLAIN), folder / "bentod.sock") as arm:
        yield arm


async def gvfs(arm: Client) -> dict[str, Table]:
    """What is asked, by name."""
    told = cast("list[Table]", await arm.call("gvf_list"))
    return {str(entry["name"]): entry for entry in told}


def predictions(frame: Table) -> Table:
    return table(table(frame["learn"])["predictions"])


async def test_a_question_is_answered_from_the_next_tick_on_and_forgotten_on_request(tmp_path: Path) -> None:
    async with learning(tmp_path) as arm, arm.listen("events") as events:
        before = number(await state(arm), "tick")
        assert await arm.call("gvf_add", gvf={**SPEED, "variance": True}) == ["speed", "speed.variance"]
        frame = await state(arm)
        assert predictions(frame).keys() == {"speed", "speed.variance"}
        assert number(frame, "tick") - before <= 2
        told = [event async for event in _first(events, 1)]
        assert told[0]["text"] == "GVF added: speed, speed.variance"
        await arm.call("gvf_remove", name=["speed.variance", "speed"])
        assert predictions(await state(arm)) == {}


async def _first(events: AsyncIterator[Table], count: int) -> AsyncIterator[Table]:
    """The first events about learning."""
    async for event in events:
        if event["kind"] == "learn":
            yield event
            count -= 1
            if not count:
                return


async def test_every_question_is_listed_with_what_it_asks_and_how_it_is_answered(tmp_path: Path) -> None:
    async with learning(tmp_path) as arm:
        await arm.call("gvf_add", gvf=SPEED)
        await asyncio.sleep(2)
        told = await gvfs(arm)
        assert list(told) == [*ARM, "speed"]
        speed = told["speed"]
        assert (speed["cumulant"], speed["algorithm"], speed["representation"]) == (
            "elbow_flexion.velocity",
            "true_online",
            "arm",
        )
        assert number(speed, "gamma") == pytest.approx(1 - 1 / 15)
        assert number(speed, "prediction") == pytest.approx(0.0, abs=0.05)
        assert number(told["elbow_flexion.position@10"], "error") >= 0


async def test_what_was_learned_is_forgotten_on_request_and_learned_again(tmp_path: Path) -> None:
    async with learning(tmp_path) as arm:
        name = "shoulder_rotation.position@20"
        await asyncio.sleep(4)
        learned = number((await gvfs(arm))[name], "prediction")
        await arm.call("gvf_reset", name=name)
        reset = (await gvfs(arm))[name]
        assert abs(number(reset, "prediction") - learned) > 0.1
        assert reset["resets"] == 0
        await asyncio.sleep(4)
        assert number((await gvfs(arm))[name], "prediction") == pytest.approx(learned, abs=0.1)


@pytest.mark.parametrize(
    ("gvf", "sentence"),
    [
        ({"cumulant": "elbow_flexion.velocty"}, r"'elbow_flexion.velocty'.*'elbow_flexion.velocity'"),
        ({"timescal": 3.0}, "gvf.timescal: unknown key.*'timescale'"),
        ({"step_size": 2.0}, "gvf.step_size = 2.0: .*less than or equal to 1"),
        ({"timescale": 20.0}, "needs exactly one of timescale"),
        ({"algorithm": "tibdb"}, "algorithm tibdb: 'tibdb' is unknown.*'tidbd'"),
        ({"name": "elbow_flexion.position@20"}, "there is a GVF 'elbow_flexion.position@20' already"),
    ],
)  # fmt: skip
async def test_what_cannot_be_asked_is_a_bad_request_that_says_why(
    tmp_path: Path, gvf: dict[str, Value], sentence: str
) -> None:
    async with learning(tmp_path) as arm:
        with pytest.raises(RpcError, match=sentence) as caught:
            await arm.call("gvf_add", gvf=SPEED | gvf)
        assert (caught.value.code, caught.value.field) == ("bad_request", "gvf")
        assert list(await gvfs(arm)) == ARM


async def test_a_table_without_a_name_or_that_is_none_is_refused(tmp_path: Path) -> None:
    async with learning(tmp_path) as arm:
        wrong: list[tuple[Value, str]] = [
            ({"cumulant": "1", "gamma": 0.5}, "gvf.name: is missing"),
            (7, "gvf"),
        ]
        for gvf, sentence in wrong:
            with pytest.raises(RpcError, match=sentence) as caught:
                await arm.call("gvf_add", gvf=gvf)
            assert caught.value.code == "bad_request"


async def test_what_is_not_there_or_needed_or_the_arms_own_cannot_be_removed(tmp_path: Path) -> None:
    async with learning(tmp_path) as arm:
        await arm.call("gvf_add", gvf=SPEED)
        await arm.call("gvf_add", gvf={"name": "above", "cumulant": 'prediction("speed")', "timescale": 5})
        for name, sentence in (
            ("sped", "there is no GVF 'sped'.*'speed'"),
            ("speed", "above is made from speed: remove it first"),
            (ARM[0], "is the arm's own and stays"),
        ):
            with pytest.raises(RpcError, match=sentence) as caught:
                await arm.call("gvf_remove", name=name)
            assert (caught.value.code, caught.value.field) == ("bad_request", "name")
        assert list(await gvfs(arm)) == [*ARM, "speed", "above"]


async def test_without_learners_there_is_nothing_to_ask(tmp_path: Path) -> None:
    config = quiet_config(PLAIN).model_copy(update={"learn": None, "assist": None})
    async with running(config, tmp_path / "bentod.sock") as arm:
        for method, named in (("gvf_list", {}), ("gvf_add", {"gvf": SPEED}), ("gvf_reset", {"name": "x"})):
            with pytest.raises(RpcError, match=r"the config has no \[learn\] table") as caught:
                await arm.call(method, **named)
            assert caught.value.code == "refused"


async def test_a_joint_moves_on_while_questions_come_and_go(tmp_path: Path) -> None:
    async with learning(tmp_path) as arm:
        await arm.call("move", joint="elbow_flexion", velocity=0.3, lease_s=1.0)
        missed = number(await state(arm), "missed")
        for number_ in range(8):
            await arm.call("gvf_add", gvf=SPEED | {"name": f"s{number_}"})
        frame = await wait_for(arm, lambda f: len(predictions(f)) == 8)
        elbow = next(
            found for found in cast("list[Table]", frame["joints"]) if found["name"] == "elbow_flexion"
        )
        assert number(elbow, "velocity") > 0.2
        assert number(frame, "missed") == missed


async def test_who_only_looks_may_list_and_not_change(tmp_path: Path) -> None:
    about = About(arm="", driver="", rate_hz=30.0, joints=(), groups={}, emg="", lease_max=1.0)
    methods = arm_methods(Room(Inbox(), about))
    assert methods["gvf_list"].role.value == "observer"
    door = UnixDoor(Access(operators=("a-group-elsewhere",)), NOBODY)
    async with Server(methods, tmp_path / "s", unix=door), plugged(tmp_path / "s") as plug:
        for method, argument in (("gvf_add", SPEED), ("gvf_remove", "speed"), ("gvf_reset", "speed")):
            plug.ask(1, method, argument)
            assert f"{method} needs the role operator" in str(await said(plug))
