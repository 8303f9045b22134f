import stat
import tomllib
from pathlib import Path

import pytest

from bentod import registry
from bentod.calibration.config_edit import edited, edited_sites, rewrite
from bentod.errors import ConfigError

BENTO = (Path(__file__).parents[2] / "config" / "bento.toml").read_text(encoding="utf-8")


def changed_lines(before: str, after: str) -> list[str]:
    assert len(before.splitlines()) == len(after.splitlines())
    return [new for old, new in zip(before.splitlines(), after.splitlines(), strict=True) if old != new]


def test_one_line_changes_and_every_comment_stays() -> None:
    after = edited(BENTO, "wrist_rotation", {"dead_time_s": 0.0183})
    assert changed_lines(BENTO, after) == ['hardware = { id = 3, model = "MX-28", dead_time_s = 0.0183 }']


def test_a_key_that_is_there_is_replaced() -> None:
    once = edited(BENTO, "gripper", {"dead_time_s": 0.01})
    twice = edited(once, "gripper", {"dead_time_s": 0.02, "goal_acceleration_rad_s2": 2.5})
    hardware = tomllib.loads(twice)["joints"][4]["hardware"]
    assert hardware == {
        "id": 5, "model": "MX-28", "dead_time_s": 0.02, "goal_acceleration_rad_s2": 2.5
    }  # fmt: skip


def test_a_table_of_its_own_is_edited_as_well() -> None:
    text = '[[joints]]\nname = "a"\n[joints.hardware]\nid = 1  # first\n'
    assert edited(text, "a", {"dead_time_s": 0.02}) == text + "dead_time_s = 0.02\n"


@pytest.mark.parametrize("text", ["joints = 3", "[[joints]]\nname = 'b'", "= ="])
def test_a_config_without_the_joint_is_refused(text: str) -> None:
    with pytest.raises(ConfigError):
        edited(text, "a", {"dead_time_s": 0.02})


def test_the_old_file_is_kept_and_the_new_one_loads(tmp_path: Path) -> None:
    path = tmp_path / "arm.toml"
    path.write_text(BENTO, encoding="utf-8")
    path.chmod(0o640)
    backup = rewrite(path, "gripper", {"dead_time_s": 0.02}, registry)
    assert backup.read_text(encoding="utf-8") == BENTO
    assert tomllib.loads(path.read_text(encoding="utf-8"))["joints"][4]["hardware"]["dead_time_s"] == 0.02
    assert stat.S_IMODE(path.stat().st_mode) == 0o640
    assert sorted(one.name for one in tmp_path.iterdir()) == ["arm.toml", "arm.toml.bak"]


def test_a_value_that_the_driver_refuses_is_not_written(tmp_path: Path) -> None:
    path = tmp_path / "arm.toml"
    path.write_text(BENTO, encoding="utf-8")
    with pytest.raises(ConfigError, match="dead_time_s"):
        rewrite(path, "gripper", {"dead_time_s": 5.0}, registry)
    assert path.read_text(encoding="utf-8") == BENTO
    assert [one.name for one in tmp_path.iterdir()] == ["arm.toml"]


def test_a_file_that_cannot_be_read_is_an_error_of_the_config(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="cannot be changed"):
        rewrite(tmp_path / "none.toml", "gripper", {"dead_time_s": 0.02}, registry)


SIM = (Path(__file__).parents[2] / "config" / "sim.toml").read_text(encoding="utf-8")


def test_settings_of_sites_change_their_lines_alone_and_comments_stay() -> None:
    sites = {"flexor": {"threshold_v": 4.3e-6, "max_v": 6.5e-5, "gain": 1.0}, "extensor": {"max_v": 30e-6}}
    first, second = changed_lines(SIM, edited_sites(SIM, sites))
    assert first.startswith("threshold_v = 4.3e-06 ")
    assert first.endswith("# effort is 0 up to here ...")
    assert second.startswith("max_v = 6.5e-05 ")
    assert second.endswith("# ... and 1 from here on")


def test_sites_in_one_line_each_with_the_names_of_brachioplexus_are_edited_as_well() -> None:
    text = '[emg]\nsites = [\n  { name = "a", smin_v = 1e-5, max_v = 3e-5 },  # first\n]\n'
    after = edited_sites(text, {"a": {"threshold_v": 2e-5, "gain": 2.0}})
    assert after.splitlines()[2] == '  { name = "a", smin_v = 2e-05, max_v = 3e-5, gain = 2.0 },  # first'


def test_sites_that_stand_apart_from_their_table_are_found() -> None:
    text = "[emg]\nwindow = 10\n[learn]\n[[emg.sites]]\nname = 'a'\nmax_v = 3e-5  # V\n"
    assert edited_sites(text, {"a": {"max_v": 2e-5}}) == text.replace("3e-5", "2e-05")


@pytest.mark.parametrize(
    "text", ["", "emg = 3", "[emg]\nsites = 3", "[emg]\nsites = 'a'", "[[emg.sites]]\nname = 'b'"]
)
def test_a_config_without_the_site_is_refused(text: str) -> None:
    with pytest.raises(ConfigError, match=r"there is no \[\[emg\.sites\]\] table of the name 'a'"):
        edited_sites(text, {"a": {"gain": 2.0}})
