"""`bentod recording`: what it says of recordings, good and bad, and how it ends."""

import json
import os
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from bentod.cli.recording import recording
from bentod.record.reader import Recording
from tests.analysis.helpers import excerpt, frames, header, record, recorded, session, ticks
from tests.cli.results import refused

Run = Callable[..., Result]


def run(*arguments: object) -> Result:
    return CliRunner().invoke(recording, [str(argument) for argument in arguments])


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return recorded(tmp_path_factory.getbasetemp())


@pytest.fixture(scope="module")
def short(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return record(tmp_path_factory.mktemp("short"), excerpt())


def cut(folder: Path, whole: Path) -> Path:
    """A copy of a recording whose last third is gone."""
    path = folder / whole.name
    content = whole.read_bytes()
    path.write_bytes(content[: len(content) * 2 // 3])
    return path


def test_info_tells_everything_at_a_glance(file: Path) -> None:
    text = run("info", file).output
    assert "2026-11-22T19-04-05Z-3f2a: Bento Arm (simulated), 30 Hz, 5 joints" in text
    assert f"{len(frames(session()))} ticks (30/s)" in text
    assert "state    complete" in text
    assert "missing  nothing that is known" in text
    assert "trial    4 rectangle, dpcc: at 55.0 s, 12.0 s" in text
    assert "meta     at" in text
    assert '{"participant": "P7", "session": 2}' in text
    assert "fault    at 10" in text
    assert "2 client commands" in text
    assert "bentod 0.1.0" in text


def test_info_of_several_files_as_json(file: Path, tmp_path: Path) -> None:
    other = record(tmp_path, ticks(10), replace(header(ticks(1)), session="other"))
    first, second = json.loads(run("info", file, other, "--json").stdout)
    assert first["info"]["counts"]["frames"] == len(frames(session()))
    assert first["info"]["whole"] is True
    assert [span["trial"]["condition"] for span in first["info"]["trials"]][-1] == "dpcc"
    assert second["header"]["session"] == "other"


def test_info_says_what_is_missing_from_a_file_that_was_cut_off(file: Path, tmp_path: Path) -> None:
    text = run("info", cut(tmp_path, file)).output
    assert "state    not complete" in text
    assert "is cut off" in text


def test_recover_mends_and_says_what_was_saved(short: Path, tmp_path: Path) -> None:
    path = cut(tmp_path, short)
    text = run("recover", path).output
    assert "is mended" in text
    assert path.with_name(f"{path.name}.cut").exists()
    assert "cut off here, and mended" in run("info", path).output
    assert "nothing to mend" in run("recover", path).output


def test_recover_can_leave_the_file_alone_and_mend_a_copy(short: Path, tmp_path: Path) -> None:
    path = cut(tmp_path, short)
    before = path.read_bytes()
    out = tmp_path / "mended.mcap"
    text = run("recover", path, "-o", out).output
    assert "mended.mcap is mended" in text
    assert path.read_bytes() == before
    assert {found.name for found in tmp_path.iterdir()} == {path.name, out.name}
    with Recording(out) as mended, Recording(path) as broken:
        assert "cut off here, and mended" in " ".join(mended.info.problems)
        assert list(mended.frames()) == list(broken.frames())
    assert "exists already" in refused(run("recover", path, "-o", out))


def test_tasks_show_the_table_and_what_it_rests_on(file: Path) -> None:
    text = run("tasks", file).output
    lines = text.splitlines()
    assert lines[0].split()[:4] == ["participant", "timescale", "condition", "n"]
    assert lines[1].split()[:4] == ["P7", "20", "toggling", "3"]
    assert lines[2].split()[:4] == ["P7", "20", "dpcc", "3"]
    assert "not recorded" in text
    assert "dpcc minus toggling" in text
    assert "exact permutation test" in text
    assert "A toggle is a change" in text


def test_tasks_of_two_recordings_are_one_table(file: Path) -> None:
    told = json.loads(run("tasks", file, file, "--json").stdout)
    assert len(told["circuits"]) == 12
    assert [summary["circuits"] for summary in told["summaries"]] == [6, 6]
    assert told["circuits"][0]["contacts"] is None


def test_export_says_what_it_wrote(file: Path, tmp_path: Path) -> None:
    text = run("export", file, "--format", "npz", "-o", tmp_path / "out", "--topics", "events, ticks").output
    assert f"{len(frames(session()))} ticks" in text
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == [
        "dictionary.json",
        "events.npz",
        "ticks.npz",
    ]
    assert "did you mean 'emg'" in refused(run("export", file, "--format", "csv", "--topics", "eng"))


def test_plot_and_report_write_files(file: Path, short: Path, tmp_path: Path) -> None:
    assert (
        run("plot", file, "-o", tmp_path / "a.svg", "--what", "emg", "--from", 10, "--to", 20).exit_code == 0
    )
    assert run("report", short, "-o", tmp_path / "a.html").exit_code == 0
    assert (tmp_path / "a.html").read_text(encoding="utf-8").startswith("<!DOCTYPE html>")
    assert "--to 5 must be after --from 9" in refused(
        run("plot", file, "-o", tmp_path / "b.svg", "--from", 9, "--to", 5)
    )


EVERY = (
    ("info",),
    ("tasks",),
    ("recover",),
    ("export", "--format", "csv"),
    ("plot", "-o", "x.svg"),
    ("report", "-o", "x.html"),
)


@pytest.mark.parametrize("command", EVERY, ids=lambda command: command[0])
def test_what_is_no_recording_is_told_in_a_sentence(tmp_path: Path, command: tuple[str, ...]) -> None:
    wrong = tmp_path / "wrong.mcap"
    wrong.write_bytes(b"neither fish nor flesh" * 100)
    assert "wrong.mcap" in refused(run(*command, wrong))
    assert "nowhere" in refused(run(*command, tmp_path / "nowhere.mcap"))
    (tmp_path / "empty").mkdir()
    refused(run(*command, tmp_path / "empty"))


@pytest.mark.parametrize("command", EVERY, ids=lambda command: command[0])
def test_a_file_of_a_newer_version_says_so(tmp_path: Path, command: tuple[str, ...]) -> None:
    path = record(tmp_path, ticks(5), replace(header(ticks(1)), schema=999))
    assert "999" in refused(run(*command, path))


@pytest.mark.parametrize("command", EVERY, ids=lambda command: command[0])
@pytest.mark.skipif(os.geteuid() == 0, reason="root may read everything")
def test_a_file_that_may_not_be_read_says_so(tmp_path: Path, command: tuple[str, ...]) -> None:
    path = record(tmp_path, ticks(5))
    path.chmod(0)
    refused(run(*command, path))


def test_an_error_of_the_system_is_a_sentence(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def locked(path: Path) -> Recording:
        raise PermissionError(13, "Permission denied", str(path))

    monkeypatch.setattr("bentod.cli.recording.Recording", locked)
    assert refused(run("info", tmp_path / "x.mcap")).endswith("x.mcap: Permission denied")


@pytest.mark.parametrize(
    ("command", "words"),
    [
        (("tasks",), "there is no trial"),
        (("export", "--format", "csv"), "is empty"),
        (("plot", "-o", "x.svg"), "holds no tick"),
        (("report", "-o", "x.html"), "holds no tick"),
    ],
)
def test_an_empty_recording_is_told_in_a_sentence(
    tmp_path: Path, command: tuple[str, ...], words: str
) -> None:
    path = record(tmp_path, [])
    assert run("info", path).exit_code == 0
    assert words in refused(run(*command, path))


def test_figures_of_what_there_is_not_say_so(tmp_path: Path) -> None:
    path = record(tmp_path, ticks(60))
    assert "holds no EMG" in refused(run("plot", path, "--what", "emg", "-o", tmp_path / "x.svg"))
    assert "no trial" in refused(run("plot", path, "--what", "trials", "-o", tmp_path / "x.svg"))
    assert not (tmp_path / "x.svg").exists()


def test_a_place_that_cannot_be_written_is_told(file: Path, tmp_path: Path) -> None:
    assert "nowhere" in refused(run("report", file, "-o", tmp_path / "nowhere" / "x.html"))
    assert "nowhere" in refused(run("plot", file, "-o", tmp_path / "nowhere" / "x.svg"))
    assert "nowhere" in refused(run("export", file, "--format", "csv", "-o", tmp_path / "nowhere" / "x"))


def test_without_matplotlib_the_extra_is_named(
    file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in list(sys.modules):
        if name.partition(".")[0] == "matplotlib" or name.startswith(
            ("bentod.analysis.report", "bentod.analysis.figures", "bentod.analysis.drawing")
        ):
            monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    assert "bentod[analysis]" in refused(run("report", file, "-o", tmp_path / "x.html"))


def test_names_from_outside_do_not_steer_the_terminal(tmp_path: Path) -> None:
    frames_ = [replace(frame, meta={"participant": "\x1b[2J\x07"}) for frame in ticks(5)]
    path = record(tmp_path, frames_, replace(header(frames_), arm="\x1b]0;x\x07"))
    assert "\x1b" not in run("info", path).output
