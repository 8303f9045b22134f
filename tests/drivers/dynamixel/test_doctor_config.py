from math import pi
from pathlib import Path

import pytest

from bentod.errors import ConfigError
from drivers.dynamixel.doctor.vitals import Vitals
from drivers.dynamixel.doctor.wanted import compare, load

ROOT = Path(__file__).parents[3]
BENTO = load(ROOT / "config" / "bento.toml", "/dev/ttyUSB0")
NUMBERS = {1: 310, 2: 320, 3: 29, 4: 29, 5: 29}


def found(
    id_: int, low: int = 0, high: int = 4095, number: int | None = None, baud: int = 1_000_000
) -> Vitals:
    raw = {"CW Angle Limit": low, "CCW Angle Limit": high}
    return Vitals(id_, 1, baud, NUMBERS[id_] if number is None else number, raw)


def told(*servos: Vitals) -> list[str]:
    """Findings about servo 3, the others being as they should."""
    others = [found(id_) for id_ in NUMBERS if id_ != 3]
    return [finding.text for finding in compare(BENTO, [*others, *servos])]


def test_an_arm_as_the_config_wants_it_is_good() -> None:
    assert told(found(3)) == []


def test_limits_at_the_configs_own_ticks_are_wide_enough() -> None:
    low, high = (2048 + round(angle / (2 * pi / 4096)) for angle in (-1.564, 1.571))
    assert told(found(3, low, high)) == []


def test_limits_inside_the_configs_are_found_in_degrees() -> None:
    (text,) = told(found(3, 1100, 3073))
    assert text == (
        "Servo 3 (wrist_rotation) may go -83.3 to 90.1 degrees, and the config wants -89.6 to 90.0 degrees."
    )


def test_an_absent_servo_is_found_with_its_joint() -> None:
    assert told() == ["Joint wrist_rotation should be servo 3, an MX-28, which does not answer."]


def test_another_model_is_found() -> None:
    assert told(found(3, number=12)) == ["Joint wrist_rotation should be an MX-28; Servo 3 is AX-12A."]


def test_another_rate_is_found() -> None:
    (text,) = told(found(3, baud=57_600))
    assert text == "Servo 3 (wrist_rotation) talks at 57600 bit/s; the config says 1000000."


def test_a_servo_that_is_in_no_joint_is_noted() -> None:
    stranger = Vitals(9, 1, 1_000_000, 29, {})
    (finding,) = compare([], [stranger])
    assert finding.note


def test_with_two_drivers_only_the_joints_on_this_port_count(tmp_path: Path) -> None:
    path = tmp_path / "arm.toml"
    path.write_text(
        """
[driver]
name = "dynamixel"
port = "/dev/one"
[drivers.wrist]
name = "dynamixel"
port = "/dev/two"
baud = 57600
[drivers.elbow]
name = "can"
[[joints]]
name = "a"
min_rad = 0
max_rad = 1
hardware = { id = 1, model = "MX-28" }
[[joints]]
name = "b"
driver = "wrist"
min_rad = 0
max_rad = 1
hardware = { id = 2, model = "AX-12A" }
[[joints]]
name = "c"
driver = "elbow"
min_rad = 0
max_rad = 1
hardware = { node = 1 }
""",
        encoding="utf-8",
    )
    (one,) = load(path, "/dev/two")
    assert (one.joint, one.hardware.model, one.baud) == ("b", "AX-12A", 57_600)


@pytest.mark.parametrize("text", ["= =", "joints = 3", "[driver]\nname = 'dynamixel'\nbaud = 'x'\n"])
def test_a_config_that_says_nothing_of_joints_is_an_error(text: str, tmp_path: Path) -> None:
    path = tmp_path / "arm.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(ConfigError):
        load(path, "/dev/one")
