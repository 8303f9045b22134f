"""The daemon that starts because somebody connects."""

import os
import shutil
import signal
import stat
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from bentod.blocking import BlockingClient
from tests.rig import number, table
from tests.system.processes import BENTOD, PATIENCE, Child, environment, eventually, started

pytestmark = [
    pytest.mark.real_time,
    pytest.mark.skipif(
        shutil.which("systemd-socket-activate") is None, reason="systemd-socket-activate is not installed"
    ),
]


@contextmanager
def activating(folder: Path, *options: str) -> Iterator[tuple[Path, Path, Child]]:
    """A socket that is listened on for a daemon that does not run yet, its log, and the process."""
    path, log = folder / "bentod.sock", folder / "log"
    daemon = [*BENTOD, "run", "--config", "sim.toml", "--no-view", *options]
    # A variable reaches the daemon only when it is named.
    kept = [f"--setenv={name}" for name in ("PATH", "XDG_STATE_HOME", "XDG_RUNTIME_DIR")]
    command = ["systemd-socket-activate", "-l", str(path), *kept, *daemon]
    before = os.umask(0o117)  # what SocketMode=0660 is in a unit
    try:
        with log.open("ab") as output, started(command, environment(folder), output) as child:
            eventually(path.is_socket)
            yield path, log, child
    finally:
        os.umask(before)


def test_the_daemon_starts_when_somebody_connects_answers_and_ends_by_a_signal(tmp_path: Path) -> None:
    with activating(tmp_path) as (path, log, child):
        assert "serving" not in log.read_text()
        with BlockingClient(path, PATIENCE) as arm:
            assert number(table(arm.call("get_state")), "tick") >= 0
            arm.call("stop")
        assert f"serving Bento Arm (simulated) on {path}" in log.read_text()
        child.send_signal(signal.SIGTERM)
        assert child.wait(PATIENCE) == 0
        assert "The arm was left limp." in log.read_text()
        assert path.is_socket()
        assert not (tmp_path / "bentod.sock.lock").exists()


def test_a_client_that_waits_while_the_daemon_starts_is_not_lost(tmp_path: Path) -> None:
    with activating(tmp_path, "--ticks", "30") as (path, log, child):
        with BlockingClient(path, PATIENCE) as first, BlockingClient(path, PATIENCE) as second:
            assert table(first.call("get_info"))["arm"] == table(second.call("get_info"))["arm"]
        assert child.wait(PATIENCE) == 0, log.read_text()


def test_a_socket_that_everybody_may_connect_to_is_refused_in_one_line(tmp_path: Path) -> None:
    with activating(tmp_path) as (path, log, child):
        path.chmod(stat.S_IMODE(path.stat().st_mode) | 0o666)
        with BlockingClient(path, PATIENCE):
            assert child.wait(PATIENCE) == 1
        assert f"bentod: Everybody may connect to {path}; set SocketMode=0660" in log.read_text()


CHILD = """
import os
print([name for name in os.environ if name.startswith("LISTEN_")], sorted(os.listdir("/proc/self/fd")))
"""


def test_the_view_is_told_nothing_of_the_passed_socket(tmp_path: Path) -> None:
    program = (
        "import os, subprocess, sys; from bentod.activation import passed_socket; passed_socket(os.environ); "
        f"subprocess.run([sys.executable, '-c', {CHILD!r}], close_fds=False)"
    )
    path = tmp_path / "bentod.sock"
    command = ["systemd-socket-activate", "-l", str(path), "--setenv=PATH", sys.executable, "-c", program]
    with started(command, environment(tmp_path), subprocess.PIPE) as child:
        eventually(path.is_socket)
        with BlockingClient(path, PATIENCE):
            child.wait(PATIENCE)
        assert child.stdout
        said = child.stdout.read().decode()
    assert "[] ['0', '1', '2', '3']" in said  # the last one is the listing itself
