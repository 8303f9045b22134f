"""The daemon as its users and its supervisor meet it: as a process that is started, signalled and killed."""

import json
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from click.testing import CliRunner

from bentod.blocking import BlockingClient
from bentod.cli.run import run
from bentod.endpoint import Disconnected
from tests.rig import CONFIGS, Table, joint, number, table
from tests.system.processes import (
    BusProcess,
    DaemonProcess,
    bentod,
    daemon,
    environment,
    eventually,
    sim_bus,
    terminal,
)

pytestmark = pytest.mark.real_time

SIM = ("--config", "sim.toml")


@pytest.fixture(scope="module")
def standing(tmp_path_factory: pytest.TempPathFactory) -> Iterator[DaemonProcess]:
    """A daemon for tests that leave it as it was."""
    with daemon(tmp_path_factory.mktemp("standing"), *SIM) as process:
        yield process


def tick(process: DaemonProcess) -> float:
    return number(process.state(), "tick")


def test_the_supervisor_hears_that_it_is_ready_and_that_the_tick_lives(tmp_path: Path) -> None:
    with daemon(tmp_path, *SIM, watchdog_s=0.2) as process:
        eventually(lambda: process.systemd.pings() >= 3)
        before = process.state()
        process.child.send_signal(signal.SIGSTOP)
        frozen = time.monotonic()
        pings = process.systemd.pings()
        time.sleep(1.0)  # silence takes time
        assert process.systemd.pings() <= pings + 1
        process.child.send_signal(signal.SIGCONT)
        eventually(lambda: process.systemd.pings() >= pings + 3)
        after = process.state()
        due = (time.monotonic() - frozen) * 30
        assert number(after, "missed") - number(before, "missed") >= 25
        assert number(after, "tick") - number(before, "tick") < due - 20
        process.systemd.heard()  # a queue of ten is all that the kernel keeps
        assert process.ends(signal.SIGTERM) == 0
        assert process.systemd.heard().index("READY=1") < process.systemd.heard().index("STOPPING=1")


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_ends_it_within_three_seconds_with_a_limp_arm_and_no_socket(
    tmp_path: Path, number: signal.Signals
) -> None:
    with daemon(tmp_path, *SIM) as process:
        assert process.ends(number, seconds=3) == 0
        assert not process.socket.exists()
        assert process.log().rstrip().endswith("The arm was left limp.")
        assert "Traceback" not in process.log()


def test_after_a_kill_it_starts_again_on_the_socket_that_was_left(tmp_path: Path) -> None:
    with daemon(tmp_path, *SIM) as killed:
        assert killed.ends(signal.SIGKILL) == -signal.SIGKILL
        assert killed.socket.exists()
        with pytest.raises(Disconnected):
            killed.client()
    with daemon(tmp_path, *SIM) as process:
        assert process.state()["mode"] == "active"


def test_a_second_one_on_the_same_socket_is_refused_in_one_line(
    standing: DaemonProcess, tmp_path: Path
) -> None:
    second = bentod("run", "--no-view", "--socket", str(standing.socket), folder=tmp_path)
    assert second.returncode == 1
    assert second.stderr == (
        f"bentod: A daemon already serves {standing.socket}; stop it first, or choose another socket.\n"
    )
    assert standing.state()["mode"] == "active"


def test_every_mistake_of_a_config_is_told_on_a_line_of_its_own(tmp_path: Path) -> None:
    config = tmp_path / "broken.toml"
    text = (CONFIGS / "sim.toml").read_text()
    for right, wrong in (("rate_hz = 30", "rate_hz = 5"), ("seed = 1", "sed = 1"), ('start = "', 'strt = "')):
        assert right in text
        text = text.replace(right, wrong, 1)
    config.write_text(text)
    done = bentod("run", "--no-view", "--config", str(config), folder=tmp_path)
    assert done.returncode == 1
    lines = done.stderr.splitlines()
    assert all(line.startswith(f"bentod: {config}: ") for line in lines)
    for told in ("rate_hz = 5", "driver.sed: unknown key; did you mean 'seed'?", "safety.strt: unknown key"):
        assert [told in line for line in lines].count(True) == 1
    assert len(lines) == 3


def test_a_config_that_does_not_exist_is_told_with_those_that_do() -> None:
    done = CliRunner().invoke(run, ["--no-view", "--config", "bentoo.toml"])
    assert (done.exit_code, done.stderr) == (
        1,
        "bentod: there is no config file bentoo.toml "
        "(shipped: bento.toml, clinic.toml, joystick.toml, myo.toml, nexting.toml, patterns.toml, sim.toml, "
        "wrist.toml)\n",
    )


def release(arm: BlockingClient) -> None:
    """What the config's first lines tell its user to do."""
    arm.call("torque", on=True)
    arm.call("pause", on=False)


def on_the_bus(bus: BusProcess) -> tuple[str, ...]:
    return ("--config", str(CONFIGS / "bento.toml"), "--port", str(bus.link))


def test_the_arm_of_the_real_config_moves_over_a_serial_port(tmp_path: Path) -> None:
    with sim_bus(tmp_path) as bus, daemon(tmp_path, *on_the_bus(bus)) as process:
        assert process.state()["mode"] == "limp"
        with process.client() as arm:
            release(arm)
            arm.call("move", joint="wrist_rotation", velocity=0.8, lease_s=2.0)
            moved = eventually(lambda: is_beyond(process.state(), "wrist_rotation", 0.3))
            assert 0.5 < number(moved, "velocity") < 1.1
            arm.call("move", joint="gripper", position=0.4, velocity=0.9, lease_s=2.0)
            eventually(lambda: is_beyond(process.state(), "gripper", 0.38))
        assert process.ends(signal.SIGTERM, seconds=3) == 0
        assert "The arm was left limp." in process.log()


def is_beyond(frame: Table, name: str, position: float) -> Table | None:
    found = joint(frame, name)
    return found if number(found, "position") > position else None


def _pull(bus: BusProcess) -> None:
    bus.tell("pull")


def _kill(bus: BusProcess) -> None:
    bus.child.kill()


@pytest.mark.parametrize("lose", [_pull, _kill])
def test_a_port_that_vanishes_is_a_fault_within_a_second_and_the_daemon_lives_on(
    tmp_path: Path, lose: Callable[[BusProcess], None]
) -> None:
    with sim_bus(tmp_path) as bus, daemon(tmp_path, *on_the_bus(bus)) as process:
        with process.client() as arm:
            release(arm)
            arm.call("move", joint="wrist_rotation", velocity=0.5, lease_s=2.0)
        lost = time.monotonic()
        lose(bus)
        faulted = eventually(lambda: in_fault(process.state()))
        assert number(faulted, "time") - lost < 1.0
        assert "no answer for more than 0.5 s from " in str(faulted["fault"])
        assert f"Serial port {bus.link}: " in str(faulted["fault"])
        assert "Reconnecting" in str(faulted["fault"])
        later = number(faulted, "tick") + 10
        eventually(lambda: tick(process) > later)
        assert process.ends(signal.SIGTERM, seconds=4) == 0
        assert "Torque may still be on, because nothing confirmed that it is off" in process.log()


def in_fault(frame: Table) -> Table | None:
    return frame if frame["mode"] == "fault" else None


NOTEBOOK = """
import json
import sys

from bentod.blocking import BlockingClient

with BlockingClient(sys.argv[1]) as arm:
    arm.call("emg_pause")
    arm.call("subscribe", "events")
    arm.call("move", joint="wrist_rotation", position=0.3, lease_s=2.0)
    arm.call("subscribe", "state", 30)
    for note in arm.notifications():
        frame = note.params[0]
        if note.method == "state" and frame["joints"][2]["position"] > 0.25:
            break
    arm.call("go_home")
    told = (note.params[0] for note in arm.notifications() if note.method == "event")
    end = next(event for event in told if event["data"].get("status") == "done")
    print(json.dumps([frame["joints"][2]["name"], end["kind"], end["data"]["progress"]]))
"""


def test_a_notebook_moves_the_arm_with_the_blocking_client(standing: DaemonProcess, tmp_path: Path) -> None:
    command = [sys.executable, "-c", NOTEBOOK, str(standing.socket)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=20, env=environment(tmp_path))
    assert done.stderr == ""
    assert json.loads(done.stdout) == ["wrist_rotation", "goal", 1.0]


SHOWN = ("shoulder_rotation", "elbow_flexion", "wrist_rotation", "wrist_flexion", "gripper")
ENTER, LEAVE = "\x1b[?1049h", "\x1b[?1049l"


def test_the_view_shows_the_joints_and_leaves_the_terminal_as_it_was(tmp_path: Path) -> None:
    with terminal(tmp_path, "run", *SIM) as screen:
        eventually(lambda: all(name in screen.read() for name in SHOWN))
        assert ENTER in screen.shown
        screen.type("\x03")
        eventually(screen.has_ended, 4)
        assert screen.child.returncode == 0
        last_words = screen.read().rpartition(LEAVE)[2]
        assert "The arm was left limp. The log is in" in last_words
        assert screen.shown.rfind(ENTER) < screen.shown.rfind(LEAVE)
        assert "Traceback" not in screen.shown
        assert screen.is_as_it_was()


def test_a_terminal_that_is_stopped_holds_up_the_view_but_not_the_arm(tmp_path: Path) -> None:
    path = tmp_path / "bentod" / "bentod.sock"
    with terminal(tmp_path, "run", *SIM) as screen:
        eventually(lambda: "gripper" in screen.read())
        with BlockingClient(path) as arm:
            screen.freeze(True)
            began = time.monotonic()
            first = table(arm.call("get_state"))
            screen.read()
            until = number(first, "tick") + 61
            last = eventually(lambda: reached(table(arm.call("get_state")), until))
            assert time.monotonic() - began < 6
            # A busy machine misses some; a loop that waited for the terminal would miss all.
            assert number(last, "missed") - number(first, "missed") < 61
        screen.freeze(False)
        eventually(lambda: newest_tick(screen.read()) > until)
        screen.type("\x03")
        eventually(screen.has_ended, 4)


def reached(frame: Table, tick: float) -> Table | None:
    return frame if number(frame, "tick") >= tick else None


def newest_tick(shown: str) -> int:
    return max(int(digits) for digits in re.findall(r"tick (\d+) ", shown))
