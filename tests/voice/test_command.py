"""`bentod voice --list` and `--render`: what would be heard, shown and written."""

from pathlib import Path

import pytest
from click.testing import CliRunner

from bentod.cli.voice import voice


@pytest.fixture(autouse=True)
def _no_words(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", "/nowhere")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))


def test_it_shows_what_each_event_sounds_like_and_writes_it(tmp_path: Path) -> None:
    words = ["--config", "sim.toml", "--list", "--render", str(tmp_path / "out")]
    done = CliRunner().invoke(voice, words)
    assert done.exit_code == 0
    lines = dict(line.split(maxsplit=1) for line in done.stdout.splitlines())
    assert lines["joint.elbow_flexion"] == "say:{}"
    assert lines["mark.contact"] == "tone:165/120"
    written = {path.name.removesuffix(".wav") for path in (tmp_path / "out").glob("*.wav")}
    assert written == {event for event, sound in lines.items() if sound != "none"}


def test_a_folder_that_takes_no_files_is_told(tmp_path: Path) -> None:
    (tmp_path / "out").write_text("a file")
    done = CliRunner().invoke(voice, ["--config", "sim.toml", "--render", str(tmp_path / "out")])
    assert done.exit_code == 2
    assert f"{tmp_path / 'out'}: " in done.stderr


def test_without_a_daemon_and_a_config_there_is_nothing_to_list(tmp_path: Path) -> None:
    done = CliRunner().invoke(voice, ["--list", "--socket", str(tmp_path / "none")])
    assert (done.exit_code, done.stdout) == (3, "")
    assert "No daemon answers" in done.stderr
