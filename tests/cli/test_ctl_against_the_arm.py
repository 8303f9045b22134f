"""Every command of `bentod ctl` on the real method table: a daemon of its own, on a simulated arm."""

import json
import re
import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TypeAlias, cast

import pytest
from click.testing import CliRunner, Result

from bentod.blocking import BlockingClient
from bentod.cli.ctl import ctl
from bentod.frames import Value
from tests.rig import Table, joint, number, table, tables
from tests.system.processes import (
    BENTOD,
    PATIENCE,
    DaemonProcess,
    daemon,
    environment,
    eventually,
    started,
)

pytestmark = pytest.mark.real_time

Ctl: TypeAlias = Callable[..., Result]
JOINTS = ("shoulder_rotation", "elbow_flexion", "wrist_rotation", "wrist_flexion", "gripper")


@pytest.fixture(scope="module")
def process(tmp_path_factory: pytest.TempPathFactory) -> Iterator[DaemonProcess]:
    with daemon(tmp_path_factory.mktemp("ctl"), "--config", "sim.toml") as process:
        yield process


@pytest.fixture
def arm(process: DaemonProcess) -> Iterator[BlockingClient]:
    """A connection to the arm, which is free to move and has a wearer who rests."""
    with process.client() as arm:
        arm.call("emg_pause")
        arm.call("inject", fault="cable", on=False)
        arm.call("inject", fault="silent", on=False)
        with_fault_cleared(arm)
        arm.call("torque", on=True)
        arm.call("pause", on=False)
        yield arm


def with_fault_cleared(arm: BlockingClient) -> None:
    """Clear the fault, if there is one, as soon as its cause is gone."""
    eventually(lambda: all(found["freshness"] == "fresh" for found in tables(state(arm), "joints")))
    if state(arm)["fault"]:
        arm.call("clear_fault")


@pytest.fixture
def ask(process: DaemonProcess, arm: BlockingClient) -> Ctl:
    return lambda *words: CliRunner().invoke(ctl, ["--socket", str(process.socket), *words])


def state(arm: BlockingClient) -> Table:
    return table(arm.call("get_state"))


def modes(arm: BlockingClient) -> dict[str, Value]:
    return {str(found["name"]): found["mode"] for found in tables(state(arm), "joints")}


def done(result: Result) -> str:
    """What a command said that went well."""
    assert (result.exit_code, result.stderr) == (0, "")
    return result.stdout


def answer(result: Result) -> Value:
    """The JSON of a command that went well."""
    return cast("Value", json.loads(done(result)))


def failed(result: Result, code: int) -> str:
    """The one line that a command failed with."""
    assert (result.exit_code, result.stdout) == (code, "")
    (line,) = result.stderr.splitlines()
    return line


def test_pause_holds_all_joints_or_some_and_releases_them(arm: BlockingClient, ask: Ctl) -> None:
    assert done(ask("pause")) == ""
    assert set(modes(arm).values()) == {"paused"}
    assert done(ask("pause", "off", "gripper", "wrist_flexion")) == ""
    assert [name for name, mode in modes(arm).items() if mode == "active"] == ["wrist_flexion", "gripper"]
    done(ask("pause", "off"))
    assert set(modes(arm).values()) == {"active"}


def test_torque_makes_limp_and_pins_and_a_limp_joint_is_not_released(arm: BlockingClient, ask: Ctl) -> None:
    done(ask("torque", "off", "gripper"))
    assert modes(arm) == dict.fromkeys(JOINTS, "active") | {"gripper": "limp"}
    refusal = failed(ask("pause", "off", "gripper"), 1)
    assert refusal == "Error: torque is off on gripper: switch it on first"
    done(ask("torque", "on"))
    assert modes(arm)["gripper"] == "holding"


def test_stop_pauses_everything(arm: BlockingClient, ask: Ctl) -> None:
    arm.call("move", joint="gripper", velocity=0.2, lease_s=2.0)
    done(ask("stop"))
    assert set(modes(arm).values()) == {"paused"}


def test_go_home_shows_its_progress_to_the_end(arm: BlockingClient, ask: Ctl) -> None:
    done(ask("move", "wrist_rotation", "--position", "0.2", "--for", "0.4"))
    said = done(ask("go-home")).splitlines()
    assert said[-1] == "done 100%"
    assert all(line.startswith("moving ") for line in said[1:-1])
    assert abs(number(joint(state(arm), "wrist_rotation"), "position")) < 0.04


def test_go_home_need_not_wait_and_is_cancelled_by_stop(arm: BlockingClient, ask: Ctl) -> None:
    done(ask("move", "gripper", "--position", "0.4", "--for", "0.4"))
    said = table(answer(ask("--json", "go-home", "gripper", "--no-wait")))
    done(ask("stop"))
    goal = table(state(arm)["goal"])
    assert (goal["id"], goal["status"]) == (said["goal"], "cancelled")
    assert str(goal["reason"]).startswith("stopped by pid ")


def test_go_home_of_a_limp_joint_is_refused(ask: Ctl) -> None:
    done(ask("torque", "off", "gripper"))
    assert "torque is off on gripper" in failed(ask("go-home"), 1)


def test_move_goes_to_a_position_or_at_a_velocity_and_ends_with_the_command(
    arm: BlockingClient, ask: Ctl
) -> None:
    done(ask("go-home", "wrist_flexion"))
    done(ask("move", "wrist_flexion", "--position", "0.2", "--velocity", "0.8", "--for", "0.5"))
    before = number(joint(state(arm), "wrist_flexion"), "position")
    assert before == pytest.approx(0.2, abs=0.05)
    done(ask("move", "wrist_flexion", "--velocity", "-0.5", "--for", "0.3", "--lease", "0.2"))
    eventually(lambda: joint(state(arm), "wrist_flexion")["holder"] == "")
    assert number(joint(state(arm), "wrist_flexion"), "position") < before - 0.05


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (
            ("move", "gripper", "--velocity", "3"),
            "velocity = 3 rad/s is beyond gripper's maximum, 1.07 rad/s",
        ),
        (("move", "gripper", "--position", "-1"), "position = -1 rad is outside gripper's limits"),
        (("move", "griper", "--velocity", "0.1"), "there is no joint 'griper'; did you mean 'gripper'?"),
        (("pause", "griper"), "there is no joint 'griper'; did you mean 'gripper'?"),
        (("activate", "hand", "elbow_flexion"), "the group 'hand' has no joint 'elbow_flexion'"),
        (("toggle", "leg"), "there is no group 'leg' (groups: arm, hand)"),
        (("emg-set", "flexr", "gain=2"), "there is no EMG site 'flexr'; did you mean 'flexor'?"),
        (("emg-set", "flexor", "max_v=1e-9"), "must be above the threshold"),
        (("assist-set", "timescale=15"), "nothing is predicted 15 steps ahead (timescales: 10, 20)"),
        (("assist-set", "kay=1"), "assist_set has no parameter kay"),
        (("inject", "sulk"), "there is no fault 'sulk'"),
        (("inject", "cable", "gripper"), "'cable' is of the whole arm and takes no joint"),
        (("call", "get_stat"), "There is no method 'get_stat'"),
    ],
)
def test_what_is_wrong_with_a_request_is_told_in_one_line_with_exit_code_2(
    ask: Ctl, words: tuple[str, ...], told: str
) -> None:
    assert told in failed(ask(*words), 2)


def test_a_homing_is_cancelled_and_pauses_nothing(arm: BlockingClient, ask: Ctl) -> None:
    done(ask("move", "wrist_flexion", "--velocity", "0.8", "--for", "0.6"))
    done(ask("go-home", "--no-wait"))
    assert done(ask("go-home", "--cancel")) == "cancelled\n"
    assert done(ask("go-home", "--cancel")) == "nothing was on its way home\n"
    assert set(modes(arm).values()) == {"active"}
    assert "give no joints" in ask("go-home", "gripper", "--cancel").stderr


def test_recordings_are_shown_begun_ended_and_marked(ask: Ctl) -> None:
    assert "recording: yes" in done(ask("recording")).splitlines()
    assert "note: P01" in done(ask("recording", "start", "--note", "P01")).splitlines()
    done(ask("mark", "door opened"))
    assert "recording: no" in done(ask("recording", "stop")).splitlines()
    assert failed(ask("recording", "stop"), 1) == "Error: nothing is recorded"


def test_groups_are_listed_toggled_and_set(ask: Ctl) -> None:
    assert done(ask("activate", "hand", "gripper")) == "active: gripper\ntogether: no\n"
    assert done(ask("toggle", "hand")) == "active: wrist_rotation\ntogether: no\n"
    assert done(ask("toggle", "hand", "backward")) == "active: gripper\ntogether: no\n"
    listed = answer(ask("--json", "groups"))
    assert isinstance(listed, list)
    told = {"name": "hand", "joints": list(JOINTS[2:]), "active": "gripper", "together": False}
    assert table(listed[1]) == told
    assert "  joints: wrist_rotation, wrist_flexion, gripper" in done(ask("groups")).splitlines()


def test_a_group_moves_by_a_share_of_its_top_speed(arm: BlockingClient, ask: Ctl) -> None:
    done(ask("activate", "hand", "wrist_rotation"))
    before = number(joint(state(arm), "wrist_rotation"), "position")
    done(ask("group", "hand", "-0.5", "--for", "0.4"))
    assert number(joint(state(arm), "wrist_rotation"), "position") < before - 0.05


def test_emg_is_shown_tuned_and_paused(arm: BlockingClient, ask: Ctl) -> None:
    done(ask("emg-set", "flexor", "gain=2", "max_v=5e-5"))
    shown = table(answer(ask("--json", "emg")))
    assert shown["paused"]
    assert tables(shown, "sites")[0] == {
        "name": "flexor",
        "channel": 0,
        "gain": 2.0,
        "threshold_v": 1e-5,
        "max_v": 5e-5,
        "release": 1.0,
    }
    done(ask("emg-pause", "off"))
    assert not table(state(arm)["emg"])["paused"]
    done(ask("emg-pause"))
    assert table(state(arm)["emg"])["paused"]


def test_a_reward_is_given_to_a_group_or_to_all(ask: Ctl) -> None:
    done(ask("reward", "-1"))
    done(ask("reward", "0.5", "--group", "arm"))
    assert "there is no group 'leg'" in ask("reward", "1", "--group", "leg").stderr
    assert ask("reward", "11").exit_code == 2


def test_assist_is_shown_and_tuned(ask: Ctl) -> None:
    done(ask("assist-set", "k=0.1", "timescale=10", "mode=dpcc"))
    shown = table(answer(ask("--json", "assist")))
    assert (shown["mode"], shown["k"], shown["timescale"]) == ("dpcc", 0.1, 10)
    assert "k: 0.1" in done(ask("assist")).splitlines()


def test_meta_is_in_the_state_from_then_on(arm: BlockingClient, ask: Ctl) -> None:
    done(ask("set-meta", "trial 3"))
    assert state(arm)["meta"] == "trial 3"
    done(ask("call", "set_meta", 'meta={"trial": 4}'))
    assert state(arm)["meta"] == {"trial": 4}


def test_an_injected_fault_is_shown_and_cleared_once_its_cause_is_gone(arm: BlockingClient, ask: Ctl) -> None:
    assert failed(ask("clear-fault"), 1) == "Error: there is no fault to clear"
    done(ask("inject", "silent", "gripper"))
    eventually(lambda: state(arm)["mode"] == "fault")
    assert "FAULT   fault: no answer for more than 0.5 s from gripper" in done(ask("state"))
    assert "the cause is still there" in failed(ask("clear-fault"), 1)
    assert "a fault is latched" in failed(ask("pause", "off"), 1)
    done(ask("inject", "silent", "gripper", "off"))
    eventually(lambda: joint(state(arm), "gripper")["freshness"] == "fresh")
    done(ask("clear-fault"))
    assert set(modes(arm).values()) == {"holding"}


def test_the_state_is_a_line_for_each_joint_or_one_of_json(ask: Ctl) -> None:
    said = done(ask("state")).splitlines()
    assert said[0].startswith("tick ")
    named = [line.split()[0] for line in said[1:]]
    assert named[: len(JOINTS)] == list(JOINTS)
    assert set(named[len(JOINTS) :]) <= {"assist"}
    shown = table(answer(ask("--json", "state")))
    assert [found["name"] for found in tables(shown, "joints")] == list(JOINTS)
    assert table(tables(shown, "joints")[0]["predictions"]).keys() == {"10", "20"}


def test_info_is_what_does_not_change(ask: Ctl) -> None:
    shown = table(answer(ask("--json", "info")))
    assert (shown["driver"], shown["rate_hz"], shown["emg"]) == ("sim-dynamixel", 30, "synthetic")
    assert isinstance(shown["faults"], list)
    assert {"cable", "silent", "stuck"} <= set(map(str, shown["faults"]))
    assert "driver: sim-dynamixel" in done(ask("info")).splitlines()


def test_any_method_can_be_called_by_name(arm: BlockingClient, ask: Ctl) -> None:
    done(ask("call", "pause", 'joints=["gripper"]', "on=on"))
    assert modes(arm)["gripper"] == "paused"
    assert table(answer(ask("--json", "call", "group_toggle", "group=arm")))["active"] in JOINTS


def test_the_help_ends_with_every_method_of_the_daemon(arm: BlockingClient, ask: Ctl) -> None:
    said = done(ask("--help"))
    methods = arm.call("list_methods")
    assert isinstance(methods, list)
    assert len(methods) > 20
    assert all(f"\n  {table(method)['name']!s}" in said for method in methods)


@contextmanager
def watching(process: DaemonProcess, folder: Path, *words: str) -> Iterator[Callable[[], list[str]]]:
    """`ctl` with `words` as a process that is interrupted at the end; gives the lines that it has said."""
    said = folder / "said"
    command = [*BENTOD, "ctl", "--socket", str(process.socket), *words]
    with said.open("wb") as output, started(command, environment(folder), output) as child:
        yield lambda: said.read_text().splitlines()
        child.send_signal(signal.SIGINT)
        assert child.wait(PATIENCE) == 0
    assert "Traceback" not in said.read_text()


def test_events_are_shown_as_they_happen_until_ctrl_c(
    arm: BlockingClient, process: DaemonProcess, tmp_path: Path
) -> None:
    def noted() -> list[str]:
        arm.call("set_meta", "noted")
        return said()

    with watching(process, tmp_path, "events") as said:
        first = eventually(noted)[0]
        assert re.fullmatch(r"\d+\.\d{3}  meta: meta set", first)


def test_the_state_is_watched_until_ctrl_c(
    arm: BlockingClient, process: DaemonProcess, tmp_path: Path
) -> None:
    with watching(process, tmp_path, "--json", "state", "--watch", "--rate", "30") as said:
        eventually(lambda: len(said()) > 4)
        ticks = [json.loads(line)["tick"] for line in said()[:4]]
        assert ticks == sorted(set(ticks))


def test_questions_are_asked_shown_begun_anew_and_forgotten(arm: BlockingClient, ask: Ctl) -> None:
    def told() -> dict[str, list[str]]:
        lines = [line.split() for line in done(ask("gvfs")).splitlines()]
        return {words[0]: words[1:] for words in lines}

    done(ask("gvf-add", "push", "abs(elbow_flexion.velocity)", "timescale_s=0.5", "variance=on"))
    assert told()["GVF"] == ["predicts", "confidence", "surprise", "error", "share", "of", "sd"]
    assert {"elbow_flexion.position@20", "push", "push.variance"} <= told().keys()
    eventually(lambda: float(told()["push"][0]) >= 0)
    shown = answer(ask("--json", "gvfs"))
    assert isinstance(shown, list)
    push = next(found for found in map(table, shown) if found["name"] == "push")
    assert push["cumulant"] == "abs(elbow_flexion.velocity)"
    done(ask("gvf-reset", "push", "elbow_flexion.position@20"))
    assert "remove it first" in failed(ask("gvf-remove", "push"), 2)
    done(ask("gvf-remove", "push", "push.variance"))
    assert "push" not in told()


def test_a_question_that_cannot_be_asked_is_one_line(ask: Ctl) -> None:
    assert "did you mean 'timescale'" in failed(ask("gvf-add", "push", "1", "timescal=5"), 2)
    assert "needs exactly one of timescale" in failed(ask("gvf-add", "push", "1"), 2)
    assert "there is no GVF 'elbow'" in failed(ask("gvf-reset", "elbow"), 2)
    assert ask("gvf-remove").exit_code == 2


def test_who_is_connected_is_shown(arm: BlockingClient, ask: Ctl) -> None:
    arm.call("hello", name="researcher")
    assert "name: researcher" in done(ask("clients"))
