"""`bentod check`: what it says of learners, and of mistakes that only show when they are built."""

from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from bentod.cli.check import check
from tests.rig import CONFIGS

HEAD = '\n[[learn.gvfs]]\nname = "mine"\ntimescale = 20\n'


def checked(folder: Path, more: str = "", old: str = "", new: str = "") -> Result:
    """The shipped simulation with a piece replaced and more at its end."""
    text = (CONFIGS / "sim.toml").read_text()
    assert old in text
    file = folder / "my_arm.toml"
    file.write_text(text.replace(old, new, 1) + more)
    return CliRunner().invoke(check, [str(file)])


def test_it_tells_what_is_learned_in_which_order_from_what_and_where_it_is_kept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", "/state")
    monkeypatch.delenv("STATE_DIRECTORY", raising=False)
    more = HEAD + 'cumulant = "emg.flexor"\nvariance = true\n'
    more += '\n[[learn.gvfs]]\nname = "until"\ncumulant = "1"\ngamma = "1 - arm.toggled"\nstep_size = 0.1\n'
    lines = checked(tmp_path, more).stdout.splitlines()
    (first,) = [place for place, line in enumerate(lines) if "GVFs learn" in line]
    assert lines[first].startswith("13 GVFs learn with the kernel ")
    assert "10 ticks ahead (0.33 s), λ 0.95, true_online over arm: shoulder_rotation" in lines[first + 1]
    assert lines[first + 1].endswith("wrist_flexion.position@10 and 1 more")
    assert lines[first + 2].startswith("  20 ticks ahead (0.67 s), λ 0.95, true_online over arm: shoulder_")
    assert any(line.endswith("true_online over arm: mine.variance") for line in lines)
    assert "  γ = 1 - arm.toggled, λ 0.95, true_online over arm: until" in lines
    assert lines.index("Representation arm: 2049 features, 101 active at most, for 13 GVFs.") > first
    assert (
        "What is learned is kept in /state/bentod/learned/my_arm.snapshot, every 60 s and at the end."
        in lines
    )


@pytest.mark.parametrize(
    ("more", "told"),
    [
        (
            'cumulant = "elbow.position"\n',
            "learn.gvfs.0.cumulant: column 1 of 'elbow.position': unknown name",
        ),
        ('cumulant = "norm(emg.flexor, 1)"\n', "learn.gvfs.0.cumulant: column 1"),
        ('cumulant = "1"\npolicy = "1"\n', "mine: policy: true_online learns on policy only"),
        ('cumulant = "1"\nalgorithm = "tdd"\n', "mine: algorithm tdd: 'tdd' is unknown; did you mean 'td'?"),
        ('cumulant = "prediction(\\"mine\\")"\n', "in a circle: mine -> mine"),
        (
            'cumulant = "1"\ninterval = 1\n',
            "learn.gvfs.0: interval: it takes 2 past weight vectors at least, or 0 for none",
        ),
        (
            'cumulant = "1"\nalgorithm = "gtd"\noptions = { eta = -1 }\n',
            "The option eta must be 0 to 1000, not -1",
        ),
    ],
)
def test_a_question_that_is_none_is_told_with_the_file_and_the_place(
    tmp_path: Path, more: str, told: str
) -> None:
    done = checked(tmp_path, HEAD + more)
    assert done.exit_code == 1
    (line,) = done.stderr.splitlines()
    assert line.startswith(f"{tmp_path / 'my_arm.toml'}: ")
    assert told in line
    assert done.stdout == ""


def test_without_a_snapshot_it_says_that_nothing_is_kept(tmp_path: Path) -> None:
    done = checked(tmp_path, old="[learn.snapshot]\nevery_s = 60 ", new="# ")
    assert "What is learned is forgotten at the end: there is no [learn.snapshot] table.\n" in done.stdout
