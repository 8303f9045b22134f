"""`bentod voice` as a process: a real daemon, and programs that only pretend to make sound."""

import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

from bentod.config_voice import Voice
from bentod.voice.render import Renderer
from bentod.voice.tones import to_wav
from tests.system.processes import BENTOD, Child, daemon, environment, eventually, started

pytestmark = pytest.mark.real_time

JOINTS = ("shoulder_rotation", "elbow_flexion", "wrist_rotation", "wrist_flexion", "gripper")
EVENTS = tuple(f"joint.{name}" for name in JOINTS)


class Room:
    """What was spoken and played in it."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        for name in ("bin", "words", "played"):
            (folder / name).mkdir()
        for number, name in enumerate(JOINTS):
            word = 0.1 * (number + 1) * np.ones(2000)
            (folder / "words" / f"{name.replace('_', ' ')}.wav").write_bytes(to_wav(word))
        self._program("espeak-ng", f'cat "{folder}/words/$(cat).wav"')
        self._program("aplay", f'cat /dev/stdin > "{folder}/$$"; mv "{folder}/$$" "{folder}/played/$$"')
        path = f"{folder / 'bin'}:/usr/bin:/bin"
        self.variables = environment(folder, PATH=path, XDG_CACHE_HOME=str(folder / "cache"))
        self.log = folder / "voice.log"

    def _program(self, name: str, command: str) -> None:
        program = self.folder / "bin" / name
        program.write_text(f"#!/bin/sh\n{command}\n")
        program.chmod(0o755)

    def played(self) -> set[str]:
        """Events whose sound was played."""
        files = {path.read_bytes() for path in (self.folder / "played").iterdir()}
        renderer = Renderer(Voice(), JOINTS, self.variables)
        return {event for event in EVENTS if renderer.wav((event,)) in files}

    @contextmanager
    def voice(self) -> Iterator[Child]:
        """`bentod voice` under way."""
        command = [sys.executable, *BENTOD[1:], "voice", "--socket", str(self.folder / "bentod.sock")]
        with self.log.open("wb") as log, started(command, self.variables, log) as child:
            yield child


def test_a_toggle_is_spoken_and_ctrl_c_ends_the_voice(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    room = Room(tmp_path)
    monkeypatch.setenv("PATH", room.variables["PATH"])  # the test renders with the same espeak-ng
    with daemon(tmp_path, "--config", "sim.toml", "--no-record") as arm, room.voice() as voice:
        with arm.client() as client:
            client.call("emg_pause", on=True)
            eventually(lambda: "telling what the daemon does" in room.log.read_text())
            eventually(room.played)
            client.call("group_activate", group="hand", joint="gripper")
            eventually(lambda: "joint.gripper" in room.played())
            client.call("group_activate", group="arm", joint="elbow_flexion")
            client.call("group_activate", group="arm", joint="shoulder_rotation")
            client.call("group_activate", group="arm", joint="elbow_flexion")
            eventually(lambda: "joint.elbow_flexion" in room.played())
        voice.send_signal(signal.SIGINT)
        assert voice.wait(10) == 0
    assert "WARNING" not in room.log.read_text()
