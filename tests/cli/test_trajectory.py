"""A trajectory in a file is read, or refused with the line that is wrong."""

from pathlib import Path

import pytest

from bentod.cli.trajectory import Reach, read_trajectory
from bentod.errors import ConfigError

REACHES = {"elbow": Reach(-0.4, 0.8, 0.5), "wrist": Reach(-1.5, 1.5, 1.0)}
CSV = "time_s,elbow,wrist\n0,0.0,0.1\n1,0.4,0.1\n2.5,0.0,-0.3\n"
TOML = """
[[points]]
time_s = 0.0
elbow = 0.0
wrist = 0.1

[[points]]  # up
time_s = 1.0
elbow = 0.4
wrist = 0.1

[[points]]
time_s = 2.5
elbow = 0
wrist = -0.3
"""


def file(folder: Path, text: str, suffix: str = ".csv") -> Path:
    path = folder / f"path{suffix}"
    path.write_text(text)
    return path


@pytest.mark.parametrize(("text", "suffix"), [(CSV, ".csv"), (TOML, ".toml")])
def test_way_points_are_read_from_either_format_and_joined_by_straight_lines(
    tmp_path: Path, text: str, suffix: str
) -> None:
    found = read_trajectory(file(tmp_path, text, suffix))
    found.check(REACHES)
    assert (found.joints, found.duration) == (("elbow", "wrist"), 2.5)
    assert found.at(0.5) == pytest.approx({"elbow": 0.2, "wrist": 0.1})
    assert found.at(1.75) == pytest.approx({"elbow": 0.2, "wrist": -0.1})
    assert found.at(99) == pytest.approx({"elbow": 0.0, "wrist": -0.3})


@pytest.mark.parametrize(
    ("old", "new", "why"),
    [
        ("1,0.4,0.1", "1,0.9,0.1", "line 3: elbow = 0.9 rad is outside its limits, -0.4 to 0.8 rad"),
        ("1,0.4,0.1", "0.5,0.4,0.1", "line 3: elbow would have to go at 0.8 rad/s; its greatest speed"),
        ("wrist", "wrost", "line 2: there is no joint 'wrost'; did you mean 'wrist'?"),
        ("2.5,", "1,", "line 4: time_s = 1 is not after 1"),
        ("0.4", "much", "line 3: elbow = much is not a number"),
        ("0.4", "nan", "line 3: elbow = nan is not finite"),
        ("1,0.4,0.1", "1,0.4", "line 3: has not as many columns as the first line"),
        ("time_s", "time", "line 2: needs time_s"),
        ("1,0.4,0.1\n2.5,0.0,-0.3\n", "", "1 way points: a trajectory has 2 to 10000"),
    ],
)
def test_what_an_arm_must_not_follow_is_refused_with_its_line(
    tmp_path: Path, old: str, new: str, why: str
) -> None:
    path = file(tmp_path, CSV.replace(old, new))
    with pytest.raises(ConfigError) as caught:
        read_trajectory(path).check(REACHES)
    assert str(path) in str(caught.value)
    assert why in str(caught.value)


def test_the_line_of_a_toml_table_is_where_it_begins(tmp_path: Path) -> None:
    path = file(tmp_path, TOML.replace("0.4", "1.4"), ".toml")
    with pytest.raises(ConfigError, match=r"line 7: elbow = 1.4 rad"):
        read_trajectory(path).check(REACHES)


@pytest.mark.parametrize("text", ["points = [{time_s = 0}]", "points", "[[points]]\n[[points]]", "a = 1"])
def test_toml_that_is_no_list_of_way_points_is_refused(tmp_path: Path, text: str) -> None:
    with pytest.raises(ConfigError, match=r"path.toml: "):
        read_trajectory(file(tmp_path, text, ".toml"))


def test_a_file_that_is_not_there_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="cannot be read"):
        read_trajectory(tmp_path / "none.csv")
