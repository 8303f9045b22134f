from pathlib import Path

import pytest

from bentod import registry
from bentod.cli.check import explain
from bentod.cli.configs import find, parse_source, read
from bentod.config import Config
from bentod.config_file import parse
from bentod.errors import ConfigError
from bentod.furnish import mind_of

SIM = (Path(__file__).parents[1] / "config" / "sim.toml").read_text()


def _problems(text: str) -> list[str]:
    with pytest.raises(ConfigError) as caught:
        parse(text, "arm.toml", registry)
    return str(caught.value).splitlines()


def _changed(old: str, new: str) -> str:
    assert old in SIM
    return SIM.replace(old, new, 1)


def test_the_shipped_simulation_is_read_in_si_units() -> None:
    config = parse(SIM, "sim.toml", registry)
    spec = config.joints[1].spec()
    assert (spec.name, spec.minimum, spec.maximum, spec.max_velocity) == ("elbow_flexion", -0.405, 0.8, 0.537)
    assert spec.hardware == {"id": 2, "model": "MX-106"}


def test_an_unknown_key_is_an_error_that_names_the_nearest_known_one() -> None:
    assert _problems(_changed("rate_hz = 30", "rate_hs = 30")) == [
        "arm.toml: rate_hs: unknown key; did you mean 'rate_hz'?"
    ]
    (line,) = _problems(
        _changed("max_velocity_rad_s = 0.80", "max_velocity_rads = 0.80\nmax_velocity_rad_s = 1")
    )
    assert line == "arm.toml: joints.0.max_velocity_rads: unknown key; did you mean 'max_velocity_rad_s'?"


def test_every_mistake_is_told_at_once_with_file_key_value_and_bound() -> None:
    text = _changed("rate_hz = 30", "rate_hz = 5000").replace("min_rad = -1.347", "min_rad = 99")
    text = text.replace('exit = "limp"', 'exit = "fall"').replace("k = 0.025", "k = 2")
    problems = _problems(text)
    assert any("rate_hz = 5000" in line and "1000" in line for line in problems)
    assert any("joints.0.min_rad = 99" in line and "6.3" in line for line in problems)
    assert any("safety.exit = 'fall'" in line and "'hold'" in line for line in problems)
    assert any("assist.k = 2" in line for line in problems)
    assert len(problems) == 4
    assert all(line.startswith("arm.toml: ") for line in problems)


def test_a_drivers_own_keys_are_checked_by_the_driver() -> None:
    (line,) = _problems(_changed('model = "MX-64"', 'model = "MX-65"'))
    assert "joints.0.hardware.model = 'MX-65'" in line
    (line,) = _problems(_changed("seed = 1", "sead = 1"))
    assert line == "arm.toml: driver.sead: unknown key; did you mean 'seed'?"


def test_a_sources_own_keys_are_checked_by_the_source() -> None:
    (line,) = _problems(_changed('name = "synthetic"', 'name = "synthetic"\nfull_v = -1'))
    assert "emg.source.full_v = -1" in line


def test_an_unknown_driver_or_source_names_the_nearest_known_one() -> None:
    (line,) = _problems(_changed("sim-dynamixel", "sim-dinamixel"))
    assert line == "arm.toml: driver.name: 'sim-dinamixel' is unknown; did you mean 'sim-dynamixel'?"
    (line,) = _problems(_changed('name = "synthetic"', 'name = "syntetic"'))
    assert "did you mean 'synthetic'?" in line


def test_limits_that_contradict_each_other_are_refused() -> None:
    (line,) = _problems(_changed("min_rad = -1.347", "min_rad = 1.5"))
    assert line == "arm.toml: joints.0: min_rad = 1.5 must be below max_rad = 1.354"
    (line,) = _problems(_changed("max_v = 30e-6", "max_v = 5e-6"))
    assert "emg.sites.0: threshold_v = 1e-05 must be below max_v = 5e-06" in line


def test_references_to_what_does_not_exist_are_told_together() -> None:
    text = _changed('["shoulder_rotation", "elbow_flexion"]\n\n', '["shoulder_rotation", "elbow"]\n\n')
    text = text.replace('toggle = "other_forearm"', 'toggle = "foot"').replace(
        'group = "arm"\ntimescale', 'group = "leg"\ntimescale'
    )
    assert _problems(text) == [
        "arm.toml: groups.arm.joints: there is no joint 'elbow'",
        "arm.toml: emg.pairs.0: there is no site 'foot'",
        "arm.toml: assist.group: there is no group 'leg'",
    ]


def test_a_name_stands_only_once_in_a_list() -> None:
    (line,) = _problems(
        _changed('name = "gripper"', 'name = "wrist_flexion"').replace('"gripper"]', '"wrist_flexion"]')
    )
    assert line == "arm.toml: joints: the name 'wrist_flexion' stands 2 times"


def test_an_assist_needs_a_prediction_to_follow() -> None:
    (line,) = _problems(_changed("timescale = 20\n", "timescale = 15\n"))
    assert line == "arm.toml: assist.timescale = 15 is not among learn.timescales (10, 20)"


def test_a_file_that_is_no_toml_says_where() -> None:
    (line,) = _problems("arm = \n")
    assert line.startswith("arm.toml: not valid TOML")
    assert "line 1" in line


def test_a_missing_file_names_those_that_are_shipped() -> None:
    with pytest.raises(ConfigError, match=r"no config file nowhere\.toml \(shipped: .*sim\.toml"):
        find(Path("nowhere.toml"))


def test_the_source_can_be_replaced_on_the_command_line(tmp_path: Path) -> None:
    config = read(Path("sim.toml"), f"replay:{tmp_path}/emg.npz#stream")
    assert config.emg is not None
    assert config.emg.source.name == "replay"
    assert config.emg.source.options == {"file": f"{tmp_path}/emg.npz", "array": "stream"}
    assert parse_source("synthetic").options == {}


def test_check_explains_the_arm_the_muscles_and_the_mind() -> None:
    config = parse(SIM, "sim.toml", registry)
    told = "\n".join(explain(config, mind_of(config)))
    assert "5 joints on the driver 'sim-dynamixel', 30 ticks a second" in told
    assert "flexor minus extensor drives the group arm, toggled by other_forearm" in told
    assert "10 GVFs learn with the kernel " in told


def test_what_was_read_cannot_be_changed() -> None:
    config: Config = parse(SIM, "sim.toml", registry)
    with pytest.raises(ValueError, match="frozen"):
        config.rate_hz = 60.0  # type: ignore[misc]


def test_a_rate_too_slow_to_stop_for_dead_muscles_is_refused() -> None:
    (line,) = _problems(_changed("rate_hz = 30", "rate_hz = 10"))
    assert "emg.stall_s = 0.06 at rate_hz = 10" in line
    assert "up to 160 ms; the bound is 100 ms" in line


def test_a_source_can_only_be_replaced_where_there_is_one() -> None:
    with pytest.raises(ConfigError, match=r"only be replaced in the table \[emg\]"):
        read(Path("bento.toml"), "synthetic")
    with pytest.raises(ConfigError, match="did you mean 'replay'"):
        read(Path("sim.toml"), "Replay:x")
