"""What a daemon that is killed has learned is there at the next start, whole."""

import signal
import subprocess
import sys
from pathlib import Path

import pytest

from bentod.learn.keeper import previous, restore
from bentod.learn.snapshot import read
from tests.rig import CONFIGS, PLAIN
from tests.system.processes import daemon, environment, eventually

pytestmark = pytest.mark.real_time

WRITER = """
import sys
from pathlib import Path
import numpy as np
from bentod.learn.keeper import keep
from bentod.learn.snapshot import Snapshot

path, number = Path(sys.argv[1]), 0
while True:
    keep(path, Snapshot({"number": number}, {"w": np.full(1_000_000, float(number))}))
    print(number, flush=True)
    number += 1
"""
"""Writes one snapshot after the other, as fast as it can, and says which stand."""


def test_a_daemon_that_is_killed_leaves_what_it_knew_and_the_next_goes_on_with_it(tmp_path: Path) -> None:
    config = tmp_path / "arm.toml"
    text = (CONFIGS / "sim.toml").read_text()
    for old, new in (("every_s = 60 ", "every_s = 5 "), PLAIN):
        assert old in text
        text = text.replace(old, new)
    config.write_text(text)
    kept = tmp_path / "bentod" / "learned" / "arm.snapshot"
    with daemon(tmp_path, "--config", str(config)) as killed:
        eventually(kept.exists)
        assert killed.ends(signal.SIGKILL) == -signal.SIGKILL
    known = read(kept)
    assert known.header["arm"] == "Bento Arm (simulated)"
    with daemon(tmp_path, "--config", str(config)) as process:
        assert f"Learning goes on from {kept}" in process.log()
        assert process.ends(signal.SIGTERM) == 0
    assert read(previous(kept)).digest == known.digest


def test_a_kill_in_the_middle_of_writing_leaves_a_whole_snapshot(tmp_path: Path) -> None:
    path = tmp_path / "kept"
    for round_ in range(2):
        with subprocess.Popen(
            [sys.executable, "-c", WRITER, str(path)],
            stdout=subprocess.PIPE,
            text=True,
            env=environment(tmp_path),
        ) as writer:
            assert writer.stdout
            stands = [int(writer.stdout.readline()) for _ in range(3 + round_)][-1]
            writer.kill()  # it is writing the next one
        found = restore(path)
        assert found is not None
        number = found.header["number"]
        assert isinstance(number, int)
        assert number >= stands
        assert set(found.arrays["w"].tolist()) == {float(number)}
    assert not list(tmp_path.glob("*refused*"))
