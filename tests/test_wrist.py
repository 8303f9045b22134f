"""One arm on two buses: the shipped config, its mistakes, and a whole daemon on it in virtual time."""

import asyncio
from pathlib import Path

import pytest

from bentod import registry
from bentod.cli.check import explain
from bentod.config import Config
from bentod.config_file import Overrides, parse
from bentod.endpoint import RpcError
from bentod.errors import ConfigError
from bentod.furnish import mind_of
from tests.rig import CONFIGS, joint, number, running, state, table, tables, wait_for

WRIST = (CONFIGS / "wrist.toml").read_text()


@pytest.fixture
def socket(tmp_path: Path) -> Path:
    return tmp_path / "bentod.sock"


def config(*changes: tuple[str, str]) -> Config:
    text = WRIST
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new, 1)
    return parse(text, "wrist.toml", registry)


def quiet(*changes: tuple[str, str]) -> Config:
    """Without a wearer: only clients move the arm."""
    return config(*changes).model_copy(update={"emg": None})


def problems(*changes: tuple[str, str]) -> list[str]:
    with pytest.raises(ConfigError) as caught:
        config(*changes)
    return str(caught.value).splitlines()


def test_check_tells_which_joint_is_on_which_driver() -> None:
    both = config()
    told = explain(both, mind_of(both))[0]
    assert "5 joints on 2 drivers (" in told
    assert "shoulder_rotation, elbow_flexion, wrist_flexion, gripper on 'sim-dynamixel' ([driver])" in told
    assert "wrist_rotation on 'sim-can' ([drivers.wrist])" in told


def test_every_drivers_table_and_joints_are_checked_at_once() -> None:
    assert problems(
        ("seed = 1\n", "sead = 1\n"),
        ("bitrate = 500_000", "bitrate = 5"),
        ("gear_ratio = 8.0", "gear_ratio = 0.0"),
        ('model = "MX-106"', 'modell = "MX-106"'),
    ) == [
        "wrist.toml: driver.sead: unknown key; did you mean 'seed'?",
        "wrist.toml: joints.1.hardware.model: is missing",
        "wrist.toml: joints.1.hardware.modell: unknown key; did you mean 'model'?",
        "wrist.toml: drivers.wrist.bitrate = 5: input should be greater than or equal to 10000",
        "wrist.toml: joints.2.hardware.gear_ratio: must be at least 0.01, or at most -0.01 for a motor that "
        "turns the other way",
    ]


def test_a_joint_on_a_driver_that_does_not_exist_is_told_which_do() -> None:
    (first, second) = problems(('driver = "wrist"', 'driver = "wirst"'))
    assert first == "wrist.toml: joints.2.driver: there is no [drivers.wirst]; did you mean 'wrist'?"
    assert second == "wrist.toml: drivers.wrist: no joint is on it"


def test_a_driver_without_a_joint_is_a_mistake() -> None:
    (line,) = problems(("[safety]", '[drivers.spare]\nname = "sim"\n\n[safety]'))
    assert line == "wrist.toml: drivers.spare: no joint is on it"


def test_a_driver_that_is_unknown_names_the_nearest_known_one() -> None:
    (line,) = problems(('"sim-can"', '"sim-cam"'))
    assert line == "wrist.toml: drivers.wrist.name: 'sim-cam' is unknown; did you mean 'sim-can'?"


def test_the_default_driver_may_be_absent_when_every_joint_names_another() -> None:
    text = WRIST.replace("[driver]", "[drivers.servos]").replace(
        "max_velocity_rad_s = 0", 'driver = "servos"\nmax_velocity_rad_s = 0'
    )
    (line,) = _problems_of(text)
    assert line == "wrist.toml: driver: is missing, and not every joint names another"
    text = text.replace('name = "gripper"', 'name = "gripper"\ndriver = "servos"')
    assert [share.key for share in parse(text, "wrist.toml", registry).shares()] == ["servos", "wrist"]
    (line,) = _problems_of(text, Overrides(port="there"))
    assert line == "wrist.toml: a port can only be replaced in the table [driver], and there is none"


def _problems_of(text: str, overrides: Overrides | None = None) -> list[str]:
    with pytest.raises(ConfigError) as caught:
        parse(text, "wrist.toml", registry, overrides or Overrides())
    return str(caught.value).splitlines()


async def test_muscles_move_joints_on_both_buses(socket: Path) -> None:
    async with running(config(), socket) as arm:
        await wait_for(arm, lambda f: number(joint(f, "elbow_flexion"), "position") > 0.2)
        await wait_for(arm, lambda f: tables(f, "groups")[0]["active"] == "wrist_rotation", 60)
        await wait_for(arm, lambda f: number(joint(f, "wrist_rotation"), "position") > 0.2, 60)
        assert table(await arm.call("get_info"))["driver"] == "sim-dynamixel, sim-can"


async def test_clients_move_pause_and_send_home_joints_on_both_buses(socket: Path) -> None:
    async with running(quiet(), socket) as arm:
        for name in ("wrist_rotation", "wrist_flexion"):
            await arm.call("move", joint=name, velocity=0.5, lease_s=2.0)
        both = ("wrist_rotation", "wrist_flexion")
        await wait_for(arm, lambda f: all(number(joint(f, name), "position") > 0.3 for name in both))
        await arm.call("pause")
        assert {tuple(table(j["sent"])) for j in tables(await state(arm), "joints")} == {("kind",)}
        await asyncio.sleep(0.5)
        frame = await state(arm)
        assert all(abs(number(joint(frame, name), "velocity")) < 0.02 for name in both)
        await arm.call("go_home")
        done = await wait_for(arm, lambda f: table(f["goal"])["status"] == "done")
        assert all(abs(number(j, "position")) < 0.03 for j in tables(done, "joints"))


async def test_torque_is_switched_on_both_buses(socket: Path) -> None:
    async with running(quiet(), socket) as arm:
        await arm.call("torque", on=False)
        assert not any(j["torque"] for j in tables(await state(arm), "joints"))
        await arm.call("torque", joints=["wrist_rotation", "gripper"], on=True)
        on = [j["name"] for j in tables(await state(arm), "joints") if j["torque"]]
        assert on == ["wrist_rotation", "gripper"]


@pytest.mark.parametrize(
    ("fault", "lost", "why"),
    [
        ("wrist.cable", "wrist_rotation", "simulated CAN bus takes no frames"),
        ("driver.cable", "shoulder_rotation", "simulated cable is pulled"),
    ],
)
async def test_a_pulled_cable_of_one_bus_is_a_fault_of_the_whole_arm(
    socket: Path, fault: str, lost: str, why: str
) -> None:
    async with running(quiet(), socket) as arm:
        for name in ("wrist_rotation", "wrist_flexion"):
            await arm.call("move", joint=name, velocity=0.3, lease_s=2.0)
        await wait_for(arm, lambda f: number(joint(f, "wrist_flexion"), "velocity") > 0.2)
        await arm.call("inject", fault=fault)
        faulted = await wait_for(arm, lambda f: f["mode"] == "fault", 3)
        assert why in str(faulted["fault"])
        assert lost in str(faulted["fault"])
        await asyncio.sleep(1)
        heard = [j for j in tables(await state(arm), "joints") if j["freshness"] == "fresh"]
        assert heard
        assert all(abs(number(j, "velocity")) < 0.02 for j in heard)
        with pytest.raises(RpcError, match="the cause is still there"):
            await arm.call("clear_fault")


async def test_a_wrist_that_lets_go_by_itself_is_a_fault_and_says_why(socket: Path) -> None:
    async with running(quiet(), socket) as arm:
        await arm.call("inject", fault="overheat", joint="wrist_rotation")
        faulted = await wait_for(arm, lambda f: f["mode"] == "fault", 3)
        assert "wrist_rotation lost torque unasked" in str(faulted["fault"])
        assert joint(faulted, "wrist_rotation")["errors"] == ["MOTOR_OVER_TEMP"]
