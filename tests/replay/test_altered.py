"""Other values for keys of a recorded config."""

from dataclasses import replace

import pytest

from bentod.errors import ConfigError
from bentod.frames import Value
from bentod.replay.altered import altered, kept
from tests.record.rig import HEADER
from tests.rig import CONFIGS

SIM = replace(HEADER, config=(CONFIGS / "sim.toml").read_text(), config_name="sim.toml")


def test_keys_of_tables_and_of_entries_of_lists_by_name_or_number_are_changed() -> None:
    changes: dict[str, Value] = {
        "learn.step_size": 0.1,
        "learn.timescales": [20, 30],
        "joints.elbow_flexion.max_velocity_rad_s": 0.4,
        "joints.0.min_rad": -1.0,
        "record.enabled": False,
    }
    config = altered(SIM, changes)
    assert config.learn
    assert (config.learn.step_size, config.learn.timescales) == (0.1, (20, 30))
    assert config.joints[1].spec().max_velocity == 0.4
    assert config.joints[0].spec().minimum == -1.0
    assert not config.record.enabled
    assert altered(SIM, {}).learn != config.learn


@pytest.mark.parametrize(
    ("key", "value", "told"),
    [
        ("learn", 1, "of the form TABLE.KEY=VALUE"),
        ("learn.step_sise", 0.1, "did you mean 'step_size'"),
        ("learn.step_size", 2, "learn.step_size"),
        ("learn.step_size", None, "cannot hold this value"),
        ("joints.elbow_flexon.min_rad", 1, "there is no 'elbow_flexon'; did you mean 'elbow_flexion'"),
        ("joints.9.min_rad", 1, "there is no '9'"),
        ("arm.name.first", 1, "there is no table above 'name'"),
        ("arm.name", 1, "of the form TABLE.KEY=VALUE"),
    ],
)
def test_a_change_that_cannot_be_is_a_sentence(key: str, value: Value, told: str) -> None:
    with pytest.raises(ConfigError) as error:
        altered(SIM, {key: value})
    assert told in str(error.value)


def test_keys_of_the_assist_are_kept_from_being_undone() -> None:
    assert kept(["assist.k", "learn.step_size", "assist.timescale"]) == ["k", "timescale"]
