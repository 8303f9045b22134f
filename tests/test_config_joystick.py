"""The table of the joystick: every mistake is named with its key, its value and its bound."""

import tomllib

import pytest

from bentod import registry
from bentod.config import Config
from bentod.config_file import parse
from bentod.errors import ConfigError
from bentod.record.provenance import as_toml
from tests.rig import CONFIGS

PLAIN = '[joystick]\ndead_man = 5\nsource = { name = "sim" }\n'
STICK = '[[joystick.axes]]\naxis = 1\ngroup = "arm"\n'
NEXT = '[[joystick.buttons]]\nbutton = 0\naction = "toggle"\ngroup = "arm"\n'


def read(more: str) -> Config:
    return parse((CONFIGS / "sim.toml").read_text() + "\n" + more, "mine.toml", registry)


def test_an_axis_has_a_dead_zone_and_the_whole_speed_unless_it_says_otherwise() -> None:
    table = read(PLAIN + STICK).joystick
    assert table is not None
    (axis,) = table.axes
    assert (axis.dead_zone, axis.expo, axis.invert, axis.one_sided, axis.max) == (0.15, 0, False, False, 1)
    assert (table.dead_man_button, table.still_s) == (5, 4.0)


def test_to_do_without_a_dead_man_must_be_said() -> None:
    table = read(PLAIN.replace("5", "false")).joystick
    assert table is not None
    assert table.dead_man_button is None
    with pytest.raises(ConfigError, match=r"joystick\.dead_man: is missing"):
        read(PLAIN.replace("dead_man = 5\n", ""))


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (PLAIN + STICK + "dead_zon = 0.1\n", "axes.0.dead_zon: unknown key; did you mean 'dead_zone'?"),
        (PLAIN + STICK + "dead_zone = 0.95\n", "axes.0.dead_zone = 0.95: input should be less than or"),
        (PLAIN + STICK + "expo = -1\n", "axes.0.expo = -1: input should be greater than or equal to 0"),
        (PLAIN + STICK + "max = 1.5\n", "axes.0.max = 1.5: input should be less than or equal to 1"),
        (PLAIN + STICK + 'joint = "gripper"\n', "axes.0: give a group or a joint, one of both"),
        (PLAIN + STICK.replace('group = "arm"', ""), "axes.0: give a group or a joint, one of both"),
        (PLAIN + STICK.replace("arm", "arms"), "axes.0.group: there is no group 'arms'; did you mean 'arm'?"),
        (PLAIN + STICK.replace('group = "arm"', 'joint = "griper"'), "there is no joint 'griper'; did you"),
        (PLAIN + STICK + STICK, "joystick: axis 1 stands 2 times"),
        (PLAIN + NEXT + NEXT, "joystick: button 0 stands 2 times"),
        (PLAIN + NEXT.replace("0", "5"), "joystick: dead_man = 5: the same button has an action, too"),
        (PLAIN + NEXT.replace('group = "arm"', ""), "buttons.0: action 'toggle' needs group"),
        (PLAIN + NEXT.replace("toggle", "stop"), "buttons.0: action 'stop' takes no group"),
        (PLAIN + NEXT.replace("toggle", "mark"), "buttons.0: action 'mark' needs mark"),
        (PLAIN + NEXT.replace("toggle", "jump"), "buttons.0.action = 'jump': input should be 'toggle'"),
        (PLAIN + NEXT.replace("toggle", "home") + "on = false\n", "action 'home' takes no on"),
        (PLAIN.replace("5", "200"), "dead_man: 200 must be the number of a button, 0 to 127, or false"),
        (PLAIN.replace("5", "true"), "joystick.dead_man: True must be the number of a button"),
        (PLAIN + "still_s = 0\n", "joystick.still_s = 0: input should be greater than or equal to 0.2"),
        (PLAIN.replace('"sim"', '"simm"'), "joystick.source.name: 'simm' is unknown; did you mean 'sim'?"),
        (
            PLAIN.replace('"sim"', '"linux", devise = "x"'),
            "joystick.source.devise: unknown key; did you mean 'device'?",
        ),
        (PLAIN.replace('"sim"', '"sim", axes = 99'), "joystick.source.axes = 99: input should be less"),
    ],
)
def test_a_mistake_is_told_where_it_is_and_how_to_mend_it(text: str, told: str) -> None:
    with pytest.raises(ConfigError) as found:
        read(text)
    assert told in str(found.value)
    assert str(found.value).startswith("mine.toml: joystick")


def test_what_a_recording_keeps_of_it_can_be_read_again() -> None:
    for dead_man in ("5", "false"):
        config = read(PLAIN.replace("5", dead_man) + STICK + NEXT)
        again = Config.model_validate(tomllib.loads(as_toml(config)))
        assert again.joystick == config.joystick
