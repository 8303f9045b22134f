"""What must not happen: motion that nobody asked for, and claims that nothing confirmed."""

import asyncio
import math
from collections.abc import Sequence
from contextlib import suppress
from itertools import pairwise
from pathlib import Path

import pytest

from bentod.client import Client
from bentod.control.modes import Modes
from bentod.endpoint import Disconnected, RpcError
from bentod.frames import Bounds
from bentod.mind import Mind
from bentod.serve.requests import RESERVE
from bentod.serve.session import Bounds as SessionBounds
from sim.servo import OVERLOAD_AFTER, OVERLOAD_DUTY
from tests.rig import (
    PLAIN,
    Table,
    joint,
    number,
    quiet_config,
    running,
    sim_config,
    state,
    table,
    tables,
    wait_for,
)


@pytest.fixture
def socket(tmp_path: Path) -> Path:
    return tmp_path / "bentod.sock"


async def _position(arm: Client, name: str) -> float:
    return number(joint(await state(arm), name), "position")


async def test_homing_a_paused_arm_twice_leaves_it_paused(socket: Path) -> None:
    async with running(sim_config(PLAIN), socket) as arm:
        await arm.call("pause")
        await arm.call("go_home")
        await arm.call("go_home")
        await wait_for(arm, lambda f: table(f["goal"])["status"] == "done")
        assert (await state(arm))["mode"] == "paused"


async def test_no_wish_outlives_a_pause(socket: Path) -> None:
    async with running(quiet_config(PLAIN), socket) as arm:
        await arm.call("move", joint="wrist_rotation", velocity=0.5, lease_s=2.0)
        await arm.call("group_command", group="arm", effort=0.5, lease_s=2.0)
        await arm.call("pause")
        await arm.call("pause", on=False)
        frame = await state(arm)
        assert {entry["holder"] for entry in tables(frame, "joints")} == {""}


async def test_no_wish_outlives_a_torque_switch(socket: Path) -> None:
    async with running(quiet_config(PLAIN), socket) as arm:
        await arm.call("move", joint="wrist_rotation", velocity=0.5, lease_s=2.0)
        await arm.call("torque", on=True)
        await arm.call("pause", on=False)
        assert joint(await state(arm), "wrist_rotation")["holder"] == ""


async def test_a_paused_joint_on_its_way_home_takes_no_other_wish(socket: Path) -> None:
    async with running(quiet_config(PLAIN), socket) as arm:
        await arm.call("move", joint="wrist_rotation", position=0.8, lease_s=2.0)
        await wait_for(arm, lambda f: number(joint(f, "wrist_rotation"), "position") > 0.7)
        await arm.call("pause")
        await arm.call("go_home")
        with pytest.raises(RpcError, match="paused and on its way home"):
            await arm.call("move", joint="wrist_rotation", velocity=0.5)
        await wait_for(arm, lambda f: table(f["goal"])["status"] == "done")


async def test_a_toggle_hands_no_clients_wish_to_another_joint(socket: Path) -> None:
    async with running(quiet_config(PLAIN), socket) as arm:
        await arm.call("group_command", group="arm", effort=1.0, lease_s=2.0)
        await arm.call("group_toggle", "arm")
        frame = await state(arm)
        assert joint(frame, "shoulder_rotation")["holder"] == ""
        assert joint(frame, "elbow_flexion")["holder"] == ""


async def test_a_joint_leased_through_a_group_is_leased(socket: Path) -> None:
    async with running(quiet_config(PLAIN), socket) as arm, Client.connect(socket) as other:
        await other.call("hello", "other")
        await other.call("group_command", group="arm", effort=1.0, lease_s=2.0)
        with pytest.raises(RpcError, match="'other' holds it"):
            await arm.call("move", joint="shoulder_rotation", velocity=-0.1)


async def test_nobody_moves_or_arms_the_arm_while_the_daemon_ends(socket: Path) -> None:
    refusals: list[str] = []

    async def persist(arm: Client, method: str, named: dict[str, bool]) -> None:
        while True:
            try:
                await arm.call(method, **named)
            except RpcError as error:
                refusals.append(str(error))
            await asyncio.sleep(0.01)

    async with running(quiet_config(PLAIN), socket) as arm:
        await arm.call("move", joint="wrist_rotation", velocity=1.0, lease_s=2.0)
        await wait_for(arm, lambda f: number(joint(f, "wrist_rotation"), "velocity") > 0.5)
        rival = Client.connect(socket)
        other = await rival.__aenter__()
        task = asyncio.create_task(persist(other, "torque", {"on": True}))
    with suppress(asyncio.CancelledError, Disconnected):
        task.cancel()
        await task
    with suppress(Disconnected):
        await rival.__aexit__(None, None, None)
    assert any("ending" in refusal for refusal in refusals)


def test_torque_that_was_asked_for_does_not_come_true_in_a_fault() -> None:
    modes = Modes(["elbow"], [False])
    modes.ask_torque([0], True)
    modes.enter_fault("cable", limp=False)
    assert modes.wanted_torque == (False,)


async def test_a_request_that_breaks_is_its_clients_problem_only(socket: Path) -> None:
    async with running(quiet_config(PLAIN), socket) as arm:
        with pytest.raises(RpcError, match="name at least one joint"):
            await arm.call("go_home", joints=[])
        assert (await state(arm))["mode"] == "active"


async def test_a_tick_that_breaks_again_and_again_is_told_and_the_arm_stopped(
    socket: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken(self: Mind, state: object, moving: Sequence[int]) -> None:
        raise RuntimeError("out of my mind")

    async with running(sim_config(PLAIN), socket) as arm:
        await wait_for(arm, lambda f: number(joint(f, "shoulder_rotation"), "velocity") > 0.3)
        monkeypatch.setattr(Mind, "assist", broken)
        faulted = await wait_for(arm, lambda f: f["mode"] == "fault", 2)
        assert "out of my mind" in str(faulted["fault"])
        assert joint(faulted, "shoulder_rotation")["sent"] == {"kind": "stop"}
        await wait_for(arm, lambda f: number(f, "tick") > number(faulted, "tick") + 10, 2)
        monkeypatch.undo()
        later = await wait_for(arm, lambda f: number(joint(f, "shoulder_rotation"), "velocity") == 0, 2)
        assert later["mode"] == "fault"


async def test_stop_is_heard_from_a_client_with_too_many_requests(socket: Path) -> None:
    async with running(quiet_config(PLAIN), socket) as arm:
        moves = [
            arm.call("move", joint="gripper", velocity=0.2)
            for _ in range(SessionBounds().in_flight + RESERVE)
        ]
        answers = await asyncio.gather(*moves, arm.call("stop"), return_exceptions=True)
        assert answers[-1] is None
        assert any("in flight" in str(answer) for answer in answers)
        assert (await state(arm))["mode"] == "paused"


async def test_a_short_lease_moves_at_a_slow_rate_too(socket: Path) -> None:
    slow = ("rate_hz = 30\n", "rate_hz = 12\n"), ("rate_hz = 200\n", "rate_hz = 200\nstall_s = 0.01\n")
    async with running(quiet_config(PLAIN, *slow), socket) as arm:
        await asyncio.sleep(0.05)
        await arm.call("move", joint="gripper", velocity=0.2, lease_s=0.09)
        assert joint(await state(arm), "gripper")["sent"] == {"kind": "velocity", "velocity": 0.2}


async def test_a_velocity_of_zero_holds_a_joint_without_engaging_the_assist(socket: Path) -> None:
    async with running(quiet_config(PLAIN), socket) as arm:
        await arm.call("move", joint="shoulder_rotation", velocity=0.0, lease_s=1.0)
        frame = await state(arm)
        assert joint(frame, "shoulder_rotation")["sent"] == {"kind": "stop"}
        assert table(frame["assist"])["engaged"] is False


async def test_a_servo_that_shuts_itself_down_is_a_fault_and_stays_down(socket: Path) -> None:
    async with running(quiet_config(), socket) as arm:
        await arm.call("move", joint="elbow_flexion", position=0.5, lease_s=2.0)
        await wait_for(arm, lambda f: number(joint(f, "elbow_flexion"), "position") > 0.45)
        await arm.call("inject", fault="overload", joint="elbow_flexion")
        faulted = await wait_for(arm, lambda f: f["mode"] == "fault", 2)
        assert "elbow_flexion" in str(faulted["fault"])
        await asyncio.sleep(1)
        fallen = await _position(arm, "elbow_flexion")
        await arm.call("inject", fault="overload", joint="elbow_flexion", on=False)
        await asyncio.sleep(1)
        assert await _position(arm, "elbow_flexion") <= fallen + 0.02
        assert not joint(await state(arm), "elbow_flexion")["torque"]


FLEXED = ('name = "synthetic"', 'name = "synthetic"\nprogram = [[0, 1.0, 3.0], [0, 0.0, 1.0]]')
"""A wearer who flexes for three seconds and rests for one, again and again."""


def group(frame: Table, name: str) -> Table:
    return next(found for found in tables(frame, "groups") if found["name"] == name)


async def test_a_wearer_who_still_flexes_when_a_lease_ends_moves_nothing_until_they_have_rested(
    socket: Path,
) -> None:
    async with running(sim_config(PLAIN, FLEXED), socket) as arm:
        await wait_for(arm, lambda f: group(f, "arm")["operator"] == "emg")
        await arm.call("hello", "ann")
        await arm.call("group_command", group="arm", effort=-0.3, lease_s=0.5)
        taken = await state(arm)
        assert group(taken, "arm")["operator"] == "client:ann"
        assert number(group(taken, "arm"), "effort") == pytest.approx(-0.3)
        left = await wait_for(arm, lambda f: group(f, "arm")["operator"] == "")
        assert number(table(table(left["emg"])["effort"]), "flexor") > 0.5
        assert joint(left, "shoulder_rotation")["sent"] == {"kind": "stop"}
        again = await wait_for(arm, lambda f: group(f, "arm")["operator"] == "emg", 5)
        assert number(again, "time") - number(left, "time") > 1


async def test_no_hand_over_between_muscles_clients_home_and_stop_is_a_jerk(socket: Path) -> None:
    """Whoever asks, a velocity changes no faster than the joint may accelerate, except to stop."""
    sent: list[tuple[float, float]] = []
    rough = PLAIN, FLEXED, ("max_velocity_rad_s = 0.80\n", "max_velocity_rad_s = 2.0\n")

    async def watch(arm: Client) -> None:
        async for frame in arm.subscribe_state(rate_hz=500):
            command = table(joint(frame, "shoulder_rotation")["sent"])
            sent.append((number(frame, "time"), _signed(command, joint(frame, "shoulder_rotation"))))

    async with running(sim_config(*rough), socket) as arm, Client.connect(socket) as other:
        watching = asyncio.create_task(watch(other))
        for velocity in (-2.0, 2.0, -1.0):
            await arm.call("move", joint="shoulder_rotation", velocity=velocity, lease_s=0.15)
            await asyncio.sleep(0.3)
            await arm.call("move", joint="shoulder_rotation", velocity=-velocity, lease_s=0.15)
            await arm.call("go_home")
            await asyncio.sleep(0.2)
        await asyncio.sleep(5)
        watching.cancel()
    steps = [
        abs(now - before) / (t - past)
        for (past, before), (t, now) in pairwise(sent)
        if now and t - past < 0.05  # two ticks in a row
    ]
    assert max(steps) == pytest.approx(Bounds().acceleration, rel=0.01)


def _signed(command: Table, reading: Table) -> float:
    """Rad/s that a command asks of a joint that was read so."""
    if command["kind"] != "position":
        return number(command, "velocity") if command["kind"] == "velocity" else 0.0
    return math.copysign(number(command, "speed"), number(command, "position") - number(reading, "position"))


async def test_going_home_passes_the_same_limits(socket: Path) -> None:
    gentle = (
        "max_velocity_rad_s = 1.07\n",
        "max_velocity_rad_s = 1.07\nlimits.max_acceleration_rad_s2 = 0.5\n",
    )
    async with running(quiet_config(PLAIN, gentle), socket) as arm:
        await arm.call("move", joint="gripper", position=1.0, lease_s=2.0)
        await wait_for(arm, lambda f: number(joint(f, "gripper"), "position") > 0.6)
        await arm.call("pause")
        await arm.call("go_home", joints="gripper")
        speeds = [number(table(joint(await state(arm), "gripper")["sent"]), "speed") for _ in range(3)]
        assert speeds == sorted(speeds)
        assert speeds[-1] < 0.1
        assert joint(await state(arm), "gripper")["limited"] == "acceleration"
        await wait_for(arm, lambda f: table(f["goal"])["status"] == "done")


async def test_an_arm_that_falls_is_not_armed_until_it_rests(socket: Path) -> None:
    async with running(quiet_config(), socket) as arm:
        await arm.call("move", joint="elbow_flexion", position=0.6, lease_s=2.0)
        await wait_for(arm, lambda f: number(joint(f, "elbow_flexion"), "position") > 0.5)
        await arm.call("torque", on=False)
        await asyncio.sleep(0.2)
        with pytest.raises(RpcError, match=r"not armed: .*elbow_flexion moves at .* rad/s, bound 0.2 rad/s"):
            await arm.call("torque", on=True)
        assert not any(entry["torque"] for entry in tables(await state(arm), "joints"))
        await asyncio.sleep(3)
        await arm.call("torque", on=True)
        assert (await state(arm))["mode"] == "holding"


async def test_a_hot_arm_is_not_armed(socket: Path) -> None:
    hot = ("seed = 1\n\n[safety]", "seed = 1\ntemperature = 69\n\n[safety]")
    async with running(quiet_config(PLAIN, hot), socket, mode="limp") as arm:
        with pytest.raises(RpcError, match="gripper is at 69 °C, bound 63 °C: let it cool"):
            await arm.call("torque", joints="gripper")


async def test_a_gripper_that_may_not_push_hard_holds_something_for_long_without_shutting_down(
    socket: Path,
) -> None:
    weak = ("hardware = { id = 5,", "limits = { max_load = 0.3 }\nhardware = { id = 5,")
    async with running(quiet_config(weak), socket) as arm:
        await arm.call("inject", fault="blocked", joint="gripper")
        for _ in range(round(OVERLOAD_AFTER)):
            await arm.call("move", joint="gripper", velocity=0.5, lease_s=2.0)
            await asyncio.sleep(1.5)
        held = joint(await state(arm), "gripper")
        assert held["limited"] == "load"
        assert 0.3 < number(held, "load") < OVERLOAD_DUTY
        await arm.call("move", joint="gripper", velocity=-0.3, lease_s=1.0)
        back = await wait_for(arm, lambda f: number(joint(f, "gripper"), "velocity") < -0.2, 2)
        assert joint(back, "gripper")["limited"] == ""
