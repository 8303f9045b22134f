"""A client leads the arm along a trajectory or by hand, within its limits, and stops it when told to."""

import asyncio
from pathlib import Path

import pytest
from click.testing import CliRunner

from bentod.cli import teaching
from bentod.cli.teach import teach
from bentod.cli.trajectory import Trajectory, WayPoint
from bentod.endpoint import RpcError
from bentod.errors import ConfigError
from tests.rig import PLAIN, joint, number, quiet_config, running, state, tables, wait_for

ELBOW, SHOULDER = "elbow_flexion", "shoulder_rotation"
PATH = Trajectory(
    "path.csv",
    [
        WayPoint(2, 0.0, {ELBOW: 0.1, SHOULDER: 0.2}),
        WayPoint(3, 1.5, {ELBOW: 0.5, SHOULDER: 0.2}),
        WayPoint(4, 3.0, {ELBOW: 0.1, SHOULDER: -0.3}),
    ],
)
TOO_FAR = Trajectory("path.csv", [PATH.points[0], WayPoint(3, 5.0, {ELBOW: 0.9, SHOULDER: 0.0})])


async def test_the_arm_is_led_from_way_point_to_way_point_in_time(tmp_path: Path) -> None:
    told: list[str] = []
    async with running(quiet_config(PLAIN), tmp_path / "bentod.sock") as arm:
        loop, missed, began = asyncio.get_running_loop(), [], [0.0]
        task = asyncio.create_task(teaching.lead(arm, PATH, 2, told.append))
        await wait_for(arm, lambda frame: abs(number(joint(frame, SHOULDER), "position") - 0.2) < 0.03)
        began[0] = loop.time()
        async for frame in arm.subscribe_state(rate_hz=30):
            expected = PATH.at(loop.time() - began[0])
            missed.append(max(abs(number(joint(frame, n), "position") - at) for n, at in expected.items()))
            if loop.time() > began[0] + 3:
                break
        await task
        here = await teaching.positions(arm)
    assert told == ["1 of 2", "2 of 2"]
    assert max(missed) < 0.12
    assert here[ELBOW] == pytest.approx(0.1, abs=0.05)
    assert here[SHOULDER] == pytest.approx(-0.3, abs=0.05)


async def test_whoever_interrupts_it_stops_the_arm_at_once(tmp_path: Path) -> None:
    async with running(quiet_config(PLAIN), tmp_path / "bentod.sock") as arm:
        task = asyncio.create_task(teaching.lead(arm, PATH, 5, lambda _: None))
        await asyncio.sleep(2.5)
        task.cancel()
        with pytest.raises(asyncio.CancelledError):
            await task
        frame = await state(arm)
        assert {found["mode"] for found in tables(frame, "joints")} == {"paused"}
        await asyncio.sleep(0.5)
        before = await teaching.positions(arm)
        await asyncio.sleep(1)
        assert await teaching.positions(arm) == pytest.approx(before, abs=0.002)


async def test_nothing_moves_if_a_way_point_is_out_of_reach(tmp_path: Path) -> None:
    async with running(quiet_config(PLAIN), tmp_path / "bentod.sock") as arm:
        before = await teaching.positions(arm)
        with pytest.raises(ConfigError, match=r"path.csv: line 3: elbow_flexion = 0.9 rad is outside"):
            await teaching.lead(arm, TOO_FAR, 1, lambda _: None)
        assert await teaching.positions(arm) == pytest.approx(before, abs=1e-3)


async def test_an_arm_that_is_paused_meanwhile_is_led_no_further(tmp_path: Path) -> None:
    socket = tmp_path / "bentod.sock"
    async with running(quiet_config(PLAIN), socket) as arm:
        task = asyncio.create_task(teaching.lead(arm, PATH, 5, lambda _: None))
        await asyncio.sleep(2)
        await arm.call("pause", on=True)
        with pytest.raises(RpcError, match="paused"):
            await task


async def test_joints_go_limp_for_the_hand_and_hold_afterwards(tmp_path: Path) -> None:
    async with running(quiet_config(PLAIN), tmp_path / "bentod.sock") as arm:
        names = await teaching.chosen(arm, [ELBOW])
        await teaching.limp(arm, names)
        assert joint(await state(arm), ELBOW)["torque"] is False
        await asyncio.sleep(3)  # until it hangs still
        await teaching.hold(arm, names)
        frame = await state(arm)
        assert (joint(frame, ELBOW)["torque"], joint(frame, ELBOW)["mode"]) == (True, "holding")
        with pytest.raises(ConfigError, match="there is no joint 'elbow'"):
            await teaching.chosen(arm, ["elbow"])


def test_a_circuit_ends_where_it_began_once_the_arm_has_been_away() -> None:
    counted = teaching.Circuits(near=0.1, away=0.25)
    told = [counted.step({"a": a, "b": 0.0}) for a in (0, 0.05, 0.2, 0.05, 0.4, 0.2, 0.05, 0, 0.3, 0.08)]
    assert [place for place, ended in enumerate(told) if ended] == [6, 9]
    assert counted.done == 2


def test_a_person_is_asked_before_anything_moves_or_goes_limp(tmp_path: Path) -> None:
    path = tmp_path / "path.csv"
    path.write_text("time_s,elbow\n0,0\n1,0.2\n")
    said = CliRunner().invoke(
        teach, ["--socket", str(tmp_path / "none"), "trajectory", str(path)], input="n\n"
    )
    assert said.exit_code == 1
    assert "elbow will move by themselves for 1 s. Go on?" in said.output


def test_without_a_daemon_a_sentence_says_so(tmp_path: Path) -> None:
    said = CliRunner().invoke(teach, ["--socket", str(tmp_path / "none"), "hand"])
    assert said.exit_code == 1
    assert said.output.startswith("bentod: ")
