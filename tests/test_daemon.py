import asyncio
from contextlib import suppress
from pathlib import Path

import pytest

from bentod.client import Client
from bentod.daemon import Daemon
from bentod.endpoint import Disconnected, RpcError
from bentod.errors import Refused
from bentod.start import FALL
from bentod.supervise import Supervisor
from sim.clock import VirtualClock
from tests.rig import PLAIN, joint, number, quiet_config, running, sim_config, state, table, tables, wait_for


@pytest.fixture
def socket(tmp_path: Path) -> Path:
    return tmp_path / "bentod.sock"


async def test_muscles_move_the_arm_and_toggle_its_joints(socket: Path) -> None:
    async with running(sim_config(), socket) as arm:
        moved = await wait_for(arm, lambda f: joint(f, "shoulder_rotation")["holder"] == "emg")
        assert number(joint(await state(arm), "shoulder_rotation"), "velocity") >= 0
        await wait_for(arm, lambda f: number(joint(f, "shoulder_rotation"), "position") > 0.3)
        switched = await wait_for(arm, lambda f: tables(f, "groups")[0]["active"] == "elbow_flexion")
        assert number(switched, "tick") > number(moved, "tick")
        await wait_for(arm, lambda f: number(joint(f, "elbow_flexion"), "position") > 0.3)


async def test_the_unattended_joint_helps_once_it_has_learned(socket: Path) -> None:
    async with running(sim_config(PLAIN), socket) as arm:
        helped = await wait_for(arm, lambda f: any(j["holder"] == "assist" for j in tables(f, "joints")), 60)
        attended = [j["name"] for j in tables(helped, "joints") if j["holder"] == "emg"]
        assert len(attended) == 1
        assert table(helped["assist"])["engaged"]


async def test_a_client_moves_a_joint_for_as_long_as_its_lease_lives(socket: Path) -> None:
    async with running(quiet_config(), socket) as arm:
        await arm.call("hello", "test")
        await arm.call("move", joint="elbow_flexion", velocity=0.3, lease_s=0.5)
        held = await wait_for(arm, lambda f: number(joint(f, "elbow_flexion"), "velocity") > 0.2)
        assert joint(held, "elbow_flexion")["holder"] == "client:test"
        rest = await wait_for(arm, lambda f: joint(f, "elbow_flexion")["holder"] == "")
        assert 0.45 < number(rest, "time") - number(held, "time") + 0.2 < 0.9
        await asyncio.sleep(0.5)
        assert abs(number(joint(await state(arm), "elbow_flexion"), "velocity")) < 0.02


async def test_a_client_that_vanishes_leaves_no_motion_behind(socket: Path) -> None:
    async with running(quiet_config(), socket) as arm:
        async with Client.connect(socket) as other:
            await other.call("move", joint="wrist_rotation", velocity=1.0, lease_s=2.0)
            await wait_for(arm, lambda f: number(joint(f, "wrist_rotation"), "velocity") > 0.5)
        left = number(await state(arm), "time")
        rest = await wait_for(arm, lambda f: joint(f, "wrist_rotation")["holder"] == "")
        assert number(rest, "time") - left < 0.1


async def test_two_clients_cannot_move_one_joint(socket: Path) -> None:
    async with running(quiet_config(PLAIN), socket) as arm, Client.connect(socket) as other:
        await other.call("hello", "other")
        await other.call("move", joint="gripper", velocity=0.2, lease_s=1.0)
        with pytest.raises(RpcError, match="'other' holds it"):
            await arm.call("move", joint="gripper", velocity=-0.2)


async def test_an_answered_request_has_reached_the_servos(socket: Path) -> None:
    async with running(quiet_config(), socket) as arm:
        await arm.call("move", joint="wrist_rotation", velocity=1.0, lease_s=2.0)
        asked = number(await state(arm), "tick")
        await arm.call("pause", joints="wrist_rotation")
        frame = await state(arm)
        assert number(frame, "tick") <= asked + 1
        assert joint(frame, "wrist_rotation")["sent"] == {"kind": "stop"}
        assert joint(frame, "wrist_rotation")["mode"] == "paused"


async def test_paused_joints_ignore_the_wearer_until_they_are_released(socket: Path) -> None:
    async with running(sim_config(PLAIN), socket) as arm:
        await wait_for(arm, lambda f: number(joint(f, "shoulder_rotation"), "velocity") > 0.3)
        await arm.call("pause")
        await asyncio.sleep(0.5)
        before = number(joint(await state(arm), "shoulder_rotation"), "position")
        await asyncio.sleep(9)
        assert number(joint(await state(arm), "shoulder_rotation"), "position") == pytest.approx(
            before, abs=0.01
        )
        await arm.call("pause", on=False)
        await wait_for(arm, lambda f: abs(number(joint(f, "shoulder_rotation"), "velocity")) > 0.3)


async def test_torque_off_makes_limp_and_on_pins_and_pauses(socket: Path) -> None:
    async with running(quiet_config(), socket) as arm:
        await arm.call("torque", on=False)
        frame = await state(arm)
        assert {j["mode"] for j in tables(frame, "joints")} == {"limp"}
        with pytest.raises(RpcError, match="switch torque on and release it"):
            await arm.call("move", joint="elbow_flexion", velocity=0.1)
        await asyncio.sleep(1.0)  # gravity takes the elbow down
        fallen = number(joint(await state(arm), "elbow_flexion"), "position")
        await arm.call("torque", joints=["elbow_flexion"], on=True)
        assert joint(await state(arm), "elbow_flexion")["mode"] == "holding"
        await asyncio.sleep(1.0)
        assert number(joint(await state(arm), "elbow_flexion"), "position") == pytest.approx(fallen, abs=0.05)


async def test_the_arm_goes_home_and_tells_its_progress(socket: Path) -> None:
    async with running(quiet_config(PLAIN), socket) as arm, arm.listen("events") as events:
        await arm.call("move", joint="wrist_flexion", position=0.5, lease_s=2.0)
        await wait_for(arm, lambda f: number(joint(f, "wrist_flexion"), "position") > 0.45)
        assert await arm.call("go_home") == {"goal": 1}
        done = await wait_for(arm, lambda f: table(f["goal"])["status"] == "done")
        assert abs(number(joint(done, "wrist_flexion"), "position")) < 0.03
        told = [await anext(events) for _ in range(4)]
        goals = [table(event["data"])["status"] for event in told if event["kind"] == "goal"]
        assert goals[:2] == ["accepted", "moving"]


async def test_stop_ends_a_goal_and_pauses_the_arm(socket: Path) -> None:
    async with running(quiet_config(PLAIN), socket) as arm:
        await arm.call("move", joint="wrist_flexion", position=1.0, lease_s=2.0)
        await wait_for(arm, lambda f: number(joint(f, "wrist_flexion"), "position") > 0.8)
        await arm.call("go_home")
        await arm.call("stop")
        frame = await state(arm)
        assert table(frame["goal"])["status"] == "cancelled"
        assert frame["mode"] == "paused"
        await asyncio.sleep(0.5)
        assert abs(number(joint(await state(arm), "wrist_flexion"), "velocity")) < 0.02


async def test_the_wearer_interrupts_a_homing_but_not_one_that_began_paused(socket: Path) -> None:
    async with running(sim_config(PLAIN), socket) as arm:
        await wait_for(arm, lambda f: number(joint(f, "shoulder_rotation"), "position") > 0.5)
        await arm.call("go_home")
        ended = await wait_for(arm, lambda f: table(f["goal"])["status"] in ("done", "cancelled"))
        assert table(ended["goal"])["reason"] == "the wearer moved"
        await arm.call("pause")
        await arm.call("go_home")
        ended = await wait_for(arm, lambda f: table(f["goal"])["status"] in ("done", "cancelled"))
        assert table(ended["goal"])["status"] == "done"
        assert (await state(arm))["mode"] == "paused"


async def test_a_pulled_cable_is_a_clear_fault_and_the_arm_stays_safe(socket: Path) -> None:
    async with running(sim_config(), socket) as arm:
        await wait_for(arm, lambda f: number(joint(f, "shoulder_rotation"), "velocity") > 0.3)
        await arm.call("inject", fault="cable")
        faulted = await wait_for(arm, lambda f: f["mode"] == "fault", 2)
        assert "no answer for more than 0.5 s from any joint" in str(faulted["fault"])
        assert "cable is pulled" in str(faulted["fault"])
        with pytest.raises(RpcError, match="the cause is still there"):
            await arm.call("clear_fault")
        with pytest.raises(RpcError, match="a fault is latched"):
            await arm.call("pause", on=False)


async def test_servos_that_fall_silent_and_come_back_move_only_when_they_are_released(socket: Path) -> None:
    async with running(sim_config(), socket) as arm:
        await wait_for(arm, lambda f: number(joint(f, "shoulder_rotation"), "velocity") > 0.3)
        await arm.call("inject", fault="silent")
        await wait_for(arm, lambda f: f["mode"] == "fault", 2)
        await arm.call("inject", fault="silent", on=False)
        await wait_for(arm, lambda f: all(j["freshness"] == "fresh" for j in tables(f, "joints")), 2)
        await arm.call("clear_fault")
        assert (await state(arm))["mode"] == "holding"
        await asyncio.sleep(3)
        assert all(abs(number(j, "velocity")) < 0.02 for j in tables(await state(arm), "joints"))
        await arm.call("pause", on=False)
        await wait_for(arm, lambda f: number(joint(f, "shoulder_rotation"), "velocity") != 0)


async def test_a_dead_emg_source_stops_the_arm_within_100_ms(socket: Path) -> None:
    program = ('name = "synthetic"', 'name = "synthetic"\nprogram = [[0, 0.0, 2.0], [0, 1.0, 60.0]]')
    async with running(sim_config(PLAIN, program), socket) as arm:
        await wait_for(arm, lambda f: joint(f, "shoulder_rotation")["holder"] == "emg")
        await arm.call("emg_pause")
        assert joint(await state(arm), "shoulder_rotation")["sent"] == {"kind": "stop"}


async def test_groups_are_driven_toggled_and_chosen_by_clients(socket: Path) -> None:
    async with running(quiet_config(PLAIN), socket) as arm:
        assert await arm.call("group_command", group="hand", effort=0.5, lease_s=0.5) == {
            "active": "wrist_rotation",
            "together": False,
        }
        frame = await wait_for(arm, lambda f: number(joint(f, "wrist_rotation"), "velocity") > 0.4)
        assert joint(frame, "wrist_rotation")["sent"] == {
            "kind": "velocity",
            "velocity": pytest.approx(0.535),
        }
        assert table(await arm.call("group_toggle", "hand"))["active"] == "wrist_flexion"
        assert table(await arm.call("group_toggle", "hand", "backward"))["active"] == "wrist_rotation"
        assert table(await arm.call("group_activate", "hand", "gripper"))["active"] == "gripper"
        listed = await arm.call("group_list")
        assert isinstance(listed, list)
        assert table(listed[1])["active"] == "gripper"


async def test_emg_and_assist_can_be_tuned_while_the_arm_is_in_use(socket: Path) -> None:
    async with running(sim_config(PLAIN), socket) as arm:
        await arm.call("emg_set", site="flexor", gain=2.0, max_v=50e-6, release=0.8)
        sites = tables(table(await arm.call("emg_get")), "sites")
        volts = {"threshold_v": 10e-6, "max_v": 50e-6}
        assert sites[0] == {"name": "flexor", "channel": 0, "gain": 2.0, **volts, "release": 0.8}
        with pytest.raises(RpcError, match="must be above the threshold"):
            await arm.call("emg_set", site="flexor", max_v=1e-6)
        await arm.call("assist_set", k=0.1, timescale=10)
        assert table(await arm.call("assist_get"))["k"] == 0.1
        with pytest.raises(RpcError, match=r"nothing is predicted 15 steps ahead \(timescales: 10, 20\)"):
            await arm.call("assist_set", timescale=15)


async def test_meta_is_in_every_frame_from_then_on(socket: Path) -> None:
    async with running(quiet_config(PLAIN), socket) as arm:
        await arm.call("set_meta", {"participant": "p07", "trial": 3})
        assert (await state(arm))["meta"] == {"participant": "p07", "trial": 3}


async def test_a_bad_request_is_answered_with_what_to_mend(socket: Path) -> None:
    async with running(quiet_config(PLAIN), socket) as arm:
        with pytest.raises(RpcError, match=r"beyond elbow_flexion's maximum, 0\.537 rad/s") as caught:
            await arm.call("move", joint="elbow_flexion", velocity=2.0)
        assert (caught.value.code, caught.value.field) == ("bad_request", "velocity")
        with pytest.raises(RpcError, match="did you mean 'elbow_flexion'"):
            await arm.call("pause", joints="elbow_flexon")
        assert (await state(arm))["mode"] == "active"


async def test_a_second_daemon_on_the_same_socket_is_refused(socket: Path) -> None:
    async with running(quiet_config(PLAIN), socket) as arm:
        with pytest.raises(Refused):
            async with running(quiet_config(PLAIN), socket):
                pass
        assert (await state(arm))["mode"] == "active"


async def test_the_daemon_ends_with_a_limp_arm_and_no_socket(socket: Path) -> None:
    async with running(quiet_config(PLAIN), socket) as arm:
        await arm.call("move", joint="wrist_rotation", velocity=1.0, lease_s=2.0)
    assert not socket.exists()
    with pytest.raises(Disconnected):
        async with Client.connect(socket):
            pass


async def test_an_arm_that_stands_outside_its_limits_at_the_start_is_told_and_stays_limp(
    socket: Path, caplog: pytest.LogCaptureFixture
) -> None:
    start = ("seed = 1\n\n[safety]", "seed = 1\nstart_rad = { elbow_flexion = 1.2 }\n\n[safety]")
    async with running(quiet_config(start), socket, mode="limp") as arm:
        await asyncio.sleep(FALL + 1)
        assert (await state(arm))["mode"] == "limp"
    assert "elbow_flexion stands at 1.200 rad, 0.400 rad outside its limit of 0.800 rad" in caplog.text


async def test_an_arm_that_falls_at_the_start_is_armed_once_it_has_come_to_rest(
    socket: Path, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level("INFO")
    falling = ("seed = 1\n\n[safety]", "seed = 1\nstand = false\n\n[safety]")
    async with running(quiet_config(falling), socket) as arm:
        assert number(joint(await state(arm), "elbow_flexion"), "position") < -0.35
    assert "waiting up to 5 s before the arm is armed: elbow_flexion moves at" in caplog.text


async def test_an_arm_is_armed_where_it_stood_before(socket: Path) -> None:
    async with running(quiet_config(), socket) as arm:
        await asyncio.sleep(1)
        positions = [number(entry, "position") for entry in tables(await state(arm), "joints")]
        assert positions == pytest.approx([0.0] * 5, abs=0.02)


async def test_a_servo_that_was_reset_is_limp_and_is_not_armed_again_by_itself(socket: Path) -> None:
    async with running(quiet_config(), socket) as arm:
        await arm.call("inject", fault="power")
        await asyncio.sleep(0.2)
        await arm.call("inject", fault="power", on=False)
        faulted = await wait_for(arm, lambda f: f["mode"] == "fault" and not joint(f, "gripper")["torque"], 5)
        assert "no answer" in str(faulted["fault"]) or "lost torque unasked" in str(faulted["fault"])
        await asyncio.sleep(1)
        assert not any(j["torque"] for j in tables(await state(arm), "joints"))
        await arm.call("clear_fault")
        assert (await state(arm))["mode"] == "limp"


async def test_a_request_that_comes_before_the_first_tick_is_answered(socket: Path) -> None:
    daemon = Daemon(quiet_config(PLAIN), VirtualClock(), Supervisor(), socket)
    task = asyncio.create_task(daemon.run())
    while not socket.exists():  # noqa: ASYNC110 -- there is no event for a file
        await asyncio.sleep(0)
    async with Client.connect(socket) as arm, asyncio.timeout(5):
        await arm.call("set_meta", "early")
        assert (await state(arm))["meta"] == "early"
    task.cancel()
    with suppress(asyncio.CancelledError):
        await task
