"""The table [voice]: what may stand there, and what is said of what may not."""

from pathlib import Path

import pytest

from bentod import registry
from bentod.config import Config
from bentod.config_file import parse
from bentod.config_sounds import DEFAULTS, File, Say, Tone, event_problem, parse_sound
from bentod.config_voice import Voice
from bentod.errors import ConfigError
from bentod.furnish import about
from bentod.voice.settings import table_of
from tests.rig import CONFIGS


def config(voice: str) -> Config:
    text = (CONFIGS / "sim.toml").read_text() + f"\n[voice]\n{voice}\n"
    return parse(text, "sim.toml", registry)


def complaint(voice: str) -> str:
    with pytest.raises(ConfigError) as caught:
        config(voice)
    return str(caught.value)


def test_an_empty_table_is_as_good_as_none() -> None:
    assert config("").voice == Voice()
    assert Voice().enabled


def test_everything_that_may_be_said_is_understood(tmp_path: Path) -> None:
    table = config(
        f'voice = "de+f3"\nspeed = 200\nvolume = 0.5\ncue = "tone"\nfolder = "{tmp_path}"\n'
        '[voice.sounds]\n"joint.elbow_flexion" = "say:Ellbogen"\nfault = "tone:880/100 + file:alarm.wav"\n'
        'home.done = "none"\n"mark.grasp" = "say:{} done"\n'
    ).voice
    assert table.sounds == {
        "joint.elbow_flexion": "say:Ellbogen",
        "fault": "tone:880/100 + file:alarm.wav",
        "home.done": "none",
        "mark.grasp": "say:{} done",
    }


def test_what_clients_are_told_of_it_says_the_same_to_them() -> None:
    found = config('folder = "~/sounds"\n[voice.sounds]\nstop = "none"')
    assert table_of({"voice": dict(about(found).voice)}) == found.voice


@pytest.mark.parametrize(
    "info", [None, {}, {"voice": None}, {"voice": {"newer": 1}}, {"voice": {"speed": 0}}]
)
def test_a_daemon_of_another_age_is_spoken_of_as_usual(info: dict[str, object] | None) -> None:
    assert table_of(info) == Voice()  # type: ignore[arg-type]  # what a stranger sends is of any type


@pytest.mark.parametrize(
    ("voice", "told"),
    [
        ("sped = 3", "sim.toml: voice.sped: unknown key; did you mean 'speed'?"),
        ("speed = 500", "voice.speed = 500: input should be less than or equal to 450"),
        ("volume = 1.5", "voice.volume = 1.5: input should be less than or equal to 1"),
        ("cue_volume = 0.5", "voice.cue_volume = 0.5: input should be less than or equal to 0.2"),
        ('cue = "tones"', "voice.cue = 'tones': input should be 'off' or 'tone'"),
        ('voice = "-w/etc/passwd"', "voice.voice = '-w/etc/passwd': string should match pattern"),
        ('folder = "sounds"', "folder = 'sounds' must begin with / or ~"),
        ('sounds.falt = "none"', "sounds.falt: there is no such event; did you mean 'fault'?"),
        (
            'sounds."joint.elbow" = "none"',
            "voice.sounds.joint.elbow: there is no joint 'elbow'; did you mean 'elbow_",
        ),
        ('sounds."mark.a/b" = "none"', "sounds.mark.a/b: there is no such event"),
        ('sounds.stop = "tone:440"', "sounds.stop = 'tone:440': 'tone:440' must be tone:HZ/MS"),
        ('sounds.stop = "tone:9000/200"', "tone of 9000 Hz: must be 50 to 4000 Hz"),
        ('sounds.stop = "tone:440/9000"', "tone of 9000 ms: must be 20 to 2000 ms"),
        (
            'sounds.stop = "sai:halt"',
            "'sai:halt' is none of say:TEXT, tone:HZ/MS, file:NAME.wav, none; did you mean",
        ),
        ('sounds.stop = "say: "', "sounds.stop = 'say: ': 'say:' needs words"),
        ('sounds.stop = "file:a.wav"', "'file:a.wav': needs voice.folder"),
        ('folder = "/a"\nsounds.stop = "file:../a.wav"', "'../a.wav' is not the bare name of a .wav file"),
        ('sounds.stop = "say:{}"', "{} stands for a name, and only joint, mark, emg.prompt have one"),
        (f'sounds.stop = "say:{"a" * 80}"', "must be 1 to 80 characters"),
        ('sounds.stop = "say:a\\u0007"', "characters that can be printed"),
        ("sounds.stop = 3", "voice.sounds.stop = 3: input should be a valid string"),
    ],
)
def test_a_mistake_is_named_with_its_key_its_value_and_what_it_must_be(voice: str, told: str) -> None:
    assert told in complaint(voice)


def test_all_mistakes_are_named_at_once() -> None:
    told = complaint('folder = "here"\nsounds.falt = "none"\nsounds.stop = "beep"').splitlines()
    assert len(told) == 3


def test_a_sound_may_have_several_parts() -> None:
    assert parse_sound("tone:440/200 + say:one + one + file:a b.wav") == (
        Tone(440.0, 0.2),
        Say("one + one"),
        File("a b.wav"),
    )
    assert parse_sound("none") == ()


@pytest.mark.parametrize("event", sorted(DEFAULTS))
def test_what_is_heard_as_usual_might_stand_in_a_config(event: str) -> None:
    assert event_problem(event) == ""
    assert Voice(sounds={event: DEFAULTS[event]}).sounds == {event: DEFAULTS[event]}
