"""What the README tells a newcomer to type is typed here, against real processes."""

import os
import re
import shlex
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result

from bentod.blocking import BlockingClient
from bentod.cli.main import bentod
from bentod.endpoint import Disconnected, RpcError
from bentod.serve.reference import renewed
from tests.rig import joint, table

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")

pytestmark = pytest.mark.real_time


def _commands() -> list[list[str]]:
    """Every line after a prompt, in order, without its comment."""
    lines = re.findall(r"^\$ (.*)$", README, flags=re.MULTILINE)
    return [shlex.split(line, comments=True) for line in lines]


def _bentod(*words: str) -> list[str]:
    return [sys.executable, "-m", "bentod", *words]


@pytest.fixture
def runtime(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A place of our own for the socket and what is kept, so that nobody else's daemon is met."""
    monkeypatch.delenv("RUNTIME_DIRECTORY", raising=False)
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    return tmp_path


@contextmanager
def _process(*words: str) -> Iterator["subprocess.Popen[str]"]:
    with subprocess.Popen(
        words, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env=os.environ
    ) as process:
        try:
            yield process
        finally:
            process.terminate()
            process.communicate(timeout=20)


def _wait_until_active(mode: str = "active") -> None:
    deadline = time.monotonic() + 20
    while time.monotonic() < deadline:
        try:
            with BlockingClient() as arm:
                state = arm.call("get_state")
        except (Disconnected, RpcError):  # not there yet, or no tick yet
            time.sleep(0.05)
            continue
        if isinstance(state, dict) and state["mode"] == mode:
            return
    raise AssertionError(f"the arm did not become {mode}")


def test_the_table_of_methods_is_up_to_date() -> None:
    api = (ROOT / "docs" / "api.md").read_text(encoding="utf-8")
    assert renewed(api) == api, "run `make reference`"


def test_every_ctl_command_is_obeyed_by_the_simulated_arm(runtime: Path) -> None:
    first, *others = [words[1:] for words in _commands() if words[:2] == ["bentod", "ctl"]]
    assert len(others) >= 13
    with _process(*_bentod("run", "--config", "config/sim.toml")):
        _wait_until_active()
        done = subprocess.run(_bentod(*first), capture_output=True, text=True, timeout=30, check=False)
        assert done.returncode == 0, (first, done.stdout, done.stderr)
        for words in others:
            result = _obeyed(words)
            assert result.exit_code == 0, (words, result.output)


def _obeyed(words: list[str]) -> Result:
    """What came of a command; `torque on` is asked until the arm hangs still, as its user would."""
    deadline = time.monotonic() + 10
    while True:
        done = CliRunner().invoke(bentod, words, prog_name="bentod")
        if done.exit_code == 0 or words[-2:] != ["torque", "on"] or time.monotonic() > deadline:
            return done


def test_a_recording_drives_the_arm(runtime: Path) -> None:
    recording = runtime / "recording.npz"
    samples = np.zeros((2000, 8), np.int8)
    samples[:, 0] = np.random.default_rng(1).normal(0, 40, 2000).clip(-127, 127)
    samples[np.arange(2000) % 500 < 100] = 0  # muscles must have been at rest before they may drive
    np.savez(recording, emg=samples, fs=200)
    (words,) = [words for words in _commands() if any("replay:" in word for word in words)]
    words = [word.replace("RECORDING.npz", str(recording)) for word in words]
    with _process(*_bentod(*words[1:])):
        _wait_until_active()
        with BlockingClient() as arm:
            arm.call("subscribe", topic="state", rate_hz=30)
            for notice in arm.notifications(timeout_s=20):
                assert isinstance(notice.params, list)
                if joint(table(notice.params[0]), "shoulder_rotation")["holder"] == "emg":
                    return
    raise AssertionError("the recording moved nothing")


def test_the_hardware_config_runs_on_the_simulated_bus(runtime: Path) -> None:
    simulate, run = [words[1:] for words in _commands() if "/tmp/bento-bus" in words]  # noqa: S108
    link = runtime / "bento-bus"
    simulate, run = ([w.replace("/tmp/bento-bus", str(link)) for w in words] for words in (simulate, run))  # noqa: S108
    with _process(*_bentod(*simulate)):
        deadline = time.monotonic() + 20
        while not link.exists() and time.monotonic() < deadline:
            time.sleep(0.05)
        with _process(*_bentod(*run)):
            _wait_until_active("limp")


def test_the_python_example_moves_the_arm(runtime: Path) -> None:
    (code,) = re.findall(r"```python\n(.*?)```", README, flags=re.DOTALL)
    with _process(*_bentod("run", "--config", "config/sim.toml")):
        _wait_until_active()
        done = subprocess.run(
            [sys.executable, "-c", code], capture_output=True, text=True, timeout=30, check=False
        )
        assert done.returncode == 0, done.stderr
        assert re.fullmatch(r"-?\d\.\d+\n", done.stdout)


def test_the_two_commands_at_the_top_are_targets_of_the_makefile() -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    for target in re.findall(r"`?make (\w+)", README):
        assert re.search(rf"^{target}:", makefile, flags=re.MULTILINE), target
