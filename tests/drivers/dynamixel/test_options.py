import math

import pytest

from bentod.errors import ConfigError
from bentod.frames import JointSpec, Value
from drivers.dynamixel.options import Options, parse_hardware, parse_options, tuning, with_dead_man


def spec(**hardware: Value) -> JointSpec:
    return JointSpec("wrist_flexion", -1.0, 1.0, 1.0, 0.0, hardware)


def test_a_port_is_all_that_a_bus_needs() -> None:
    options = parse_options({"port": "/dev/ttyUSB0"})
    assert (options.baud, options.reply_margin_s, options.stop) == (1_000_000, 0.005, "full")


def test_an_unknown_key_is_answered_with_the_nearest_known_one() -> None:
    with pytest.raises(ConfigError, match=r"Dynamixel bus: bauds is not known, did you mean baud\?"):
        parse_options({"port": "/dev/ttyUSB0", "bauds": 9600})


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("baud", 12), ("baud", "fast"), ("reply_margin_s", 1.0), ("lost_after_s", math.inf), ("stop", "soon"),
        ("attempts", 0), ("limit_margin_rad", -0.1), ("bus_time_s", math.nan), ("port", ""),
    ],
)  # fmt: skip
def test_every_value_has_bounds_and_the_error_names_the_key(key: str, value: Value) -> None:
    with pytest.raises(ConfigError, match=key) as caught:
        parse_options({"port": "/dev/ttyUSB0", key: value})
    assert caught.value.field == key


def test_all_mistakes_are_told_at_once_with_the_joint() -> None:
    with pytest.raises(ConfigError) as caught:
        parse_hardware(spec(id=300, dead_time=0.02))
    text = str(caught.value)
    assert text.startswith("Servo of joint wrist_flexion: ")
    assert "id is 300" in text
    assert "model is missing" in text
    assert "did you mean dead_time_s?" in text


def test_only_the_models_that_are_known_are_accepted() -> None:
    with pytest.raises(ConfigError, match="model is 'AX-12'"):
        parse_hardware(spec(id=1, model="AX-12"))


def test_a_gain_that_is_not_given_is_the_models_own() -> None:
    gains = {model: parse_hardware(spec(id=1, model=model)).p_gain for model in ("MX-64", "MX-64(2.0)")}
    assert gains == {"MX-64": 32, "MX-64(2.0)": 850}


@pytest.mark.parametrize(
    ("hardware", "complaint"),
    [
        ({"model": "MX-28", "p_gain": 300}, "p_gain is 300; of an MX-28 it is 1 to 254"),
        ({"model": "AX-12A", "p_gain": 32}, "p_gain is 32; of an AX-12A it is 38, which cannot be changed"),
        ({"model": "AX-12A", "goal_acceleration_rad_s2": 5.0}, "of an AX-12A it is 0, which cannot"),
        ({"model": "MX-28", "goal_acceleration_rad_s2": 50.0}, "of an MX-28 it is 0 to 38.05"),
    ],
)
def test_what_a_model_cannot_do_is_refused_with_its_bound(hardware: dict[str, Value], complaint: str) -> None:
    with pytest.raises(ConfigError, match=complaint):
        parse_hardware(spec(id=1, **hardware))


def test_the_dead_mans_time_fits_the_rate_of_the_ticks() -> None:
    options = parse_options({"port": "x"})
    assert with_dead_man(options, 1 / 30).dead_man_s == pytest.approx(0.3)
    assert (with_dead_man(options, 0.1).dead_man_s or 0) > 0.3
    with pytest.raises(ConfigError, match=r"dead_man_s is 0\.1, which must be at least"):
        with_dead_man(parse_options({"port": "x", "dead_man_s": 0.1}), 1 / 30)


def test_a_joints_tuning_is_its_servos_and_the_buses() -> None:
    hardware = parse_hardware(spec(id=4, model="MX-28", dead_time_s=0.03, goal_acceleration_rad_s2=5))
    found = tuning(Options(port="x", stop="thesis", bus_time_s=0.004), hardware)
    assert (found.dead_time_s, found.bus_time_s, found.rule) == (0.03, 0.004, "thesis")
    assert (found.p_gain, found.goal_acceleration) == (32, 5.0)
