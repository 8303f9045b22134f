"""Events as WAV: espeak-ng is asked once for each text, files of the user's win, and tones stand in."""

import logging
import wave
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest

from bentod.config_voice import Voice
from bentod.voice import speech
from bentod.voice.render import LONGEST, Renderer
from bentod.voice.tones import RATE_HZ, Sound, from_wav, note, to_wav, tone

JOINTS = ("shoulder_rotation", "elbow_flexion", "wrist_rotation")


class Espeak:
    """A program of that name on the path, which notes what it is asked."""

    def __init__(self, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        self._folder = folder
        self.cache = folder / "cache" / "bentod" / "voice"
        (folder / "bin").mkdir()
        monkeypatch.setenv("PATH", f"{folder / 'bin'}:/usr/bin:/bin")
        monkeypatch.setenv("XDG_CACHE_HOME", str(folder / "cache"))
        monkeypatch.delenv("CACHE_DIRECTORY", raising=False)
        (folder / "spoken.wav").write_bytes(to_wav(0.1 * np.ones(RATE_HZ // 10)))
        self.does(f"cat {folder / 'spoken.wav'}")

    def does(self, command: str) -> None:
        program = self._folder / "bin" / "espeak-ng"
        note = f'echo "$@ [$(cat)]" >> {self._folder / "asked"}'
        program.write_text(f"#!/bin/sh\n{note}\n{command}\n")
        program.chmod(0o755)

    def asked(self) -> list[str]:
        file = self._folder / "asked"
        return file.read_text().splitlines() if file.exists() else []

    def kept(self) -> list[Path]:
        return sorted(self.cache.glob("*"))


@pytest.fixture
def espeak(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Espeak:
    return Espeak(tmp_path, monkeypatch)


def sound(wav: bytes | None) -> Sound:
    assert wav is not None
    return from_wav(wav, 60)


def pitch(wav: bytes | None) -> float:
    """Hz of the strongest part."""
    heard = sound(wav)
    return float(np.abs(np.fft.rfft(heard, 4 * RATE_HZ)).argmax() / 4)


def test_a_name_is_spoken_once_and_then_kept(espeak: Espeak) -> None:
    for _ in range(2):
        renderer = Renderer(Voice(), JOINTS)
        heard = sound(renderer.wav(("joint.elbow_flexion",)))
        assert sound(renderer.wav(("joint.elbow_flexion",))) == pytest.approx(heard)
    assert espeak.asked() == ["-b 1 -v en -s 170 --stdin --stdout [elbow flexion]"]
    assert heard == pytest.approx(0.08 * np.ones(RATE_HZ // 10), abs=1e-3)  # at the usual volume of 0.8
    assert len(espeak.kept()) == 1


def test_another_voice_or_speed_is_another_word(espeak: Espeak) -> None:
    for table in (Voice(), Voice(voice="de"), Voice(speed=200)):
        Renderer(table, JOINTS).wav(("pause",))
    assert [words.split()[3:6:2] for words in espeak.asked()] == [["en", "170"], ["de", "170"], ["en", "200"]]


def test_no_text_is_an_option_or_a_command(espeak: Espeak) -> None:
    text = "--path=/tmp; $(touch gone) `touch gone` 'x' \"y\""
    Renderer(Voice(sounds={"stop": f"say:{text}"}), JOINTS).wav(("stop",))
    assert espeak.asked() == [f"-b 1 -v en -s 170 --stdin --stdout [{text}]"]


def test_a_broken_file_in_the_cache_is_made_again(espeak: Espeak) -> None:
    good = Renderer(Voice(), JOINTS).wav(("pause",))
    (path,) = espeak.kept()
    whole = path.read_bytes()
    flipped = whole[:99] + bytes([whole[99] ^ 1]) + whole[100:]
    for broken in (b"", whole[:50], whole[:-40], flipped, b"RIFF" * 50):
        path.write_bytes(broken)
        assert Renderer(Voice(), JOINTS).wav(("pause",)) == good
        assert path.read_bytes() == whole
    assert len(espeak.asked()) == 6


def test_the_cache_does_not_grow_for_ever(espeak: Espeak, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(speech, "KEPT", 2)
    renderer = Renderer(Voice(), JOINTS)
    for name in JOINTS:
        renderer.wav((f"joint.{name}",))
    assert len(espeak.kept()) == 2


@pytest.mark.parametrize("failure", ["exit 1", "true", "echo no such voice >&2", "printf RIFF"])
def test_where_no_word_can_be_spoken_each_joint_has_a_tone(
    espeak: Espeak, failure: str, caplog: pytest.LogCaptureFixture
) -> None:
    espeak.does(failure)
    renderer = Renderer(Voice(), JOINTS)
    pitches = [pitch(renderer.wav((f"joint.{name}",))) for name in JOINTS]
    assert pitches == pytest.approx([note(0), note(1), note(2)], abs=1.0)
    assert espeak.kept() == []
    assert renderer.wav(("pause",)) is not None
    (told,) = (record.message for record in caplog.records if record.name.startswith("bentod.voice"))
    assert told.startswith("espeak-ng cannot speak with the voice en: ")
    assert told.endswith(". Tones stand in for words.")


def test_a_machine_without_espeak_is_told_of_once(
    espeak: Espeak, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setenv("PATH", "/nowhere")
    renderer = Renderer(Voice(), JOINTS)
    assert all(renderer.wav((event,)) for event in renderer.events() if renderer.words(event) != "none")
    assert [record.message for record in caplog.records if record.levelno >= logging.WARNING] == [
        "espeak-ng is not installed. Tones stand in for words."
    ]


def test_one_that_does_not_answer_is_left(espeak: Espeak, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(speech, "PATIENCE", 0.05)
    espeak.does("exec sleep 20")
    assert pitch(Renderer(Voice(), JOINTS).wav((f"joint.{JOINTS[0]}",))) == pytest.approx(note(0), abs=1.0)


def test_a_cache_that_cannot_be_written_only_costs_time(espeak: Espeak) -> None:
    espeak.cache.parent.mkdir(parents=True)
    espeak.cache.write_text("a file, where a folder should be")
    assert Renderer(Voice(), JOINTS).wav(("pause",)) == Renderer(Voice(), JOINTS).wav(("pause",))
    assert len(espeak.asked()) == 2


def test_the_users_own_file_wins_over_what_the_config_says(espeak: Espeak, tmp_path: Path) -> None:
    (tmp_path / "joint.elbow_flexion.wav").write_bytes(to_wav(tone(1000, 0.2)))
    (tmp_path / "mark.waypoint.wav").write_bytes(to_wav(tone(500, 0.2)))
    renderer = Renderer(Voice(folder=tmp_path, sounds={"joint.elbow_flexion": "say:elbow"}), JOINTS)
    assert pitch(renderer.wav(("joint.elbow_flexion",))) == pytest.approx(1000, abs=1)
    assert pitch(renderer.wav(("mark.waypoint_7",))) == pytest.approx(500, abs=1)
    assert renderer.words("joint.elbow_flexion") == "file:joint.elbow_flexion.wav"
    assert espeak.asked() == []


@pytest.mark.parametrize("content", [None, b"", b"OggS" * 20])
def test_a_file_that_cannot_be_played_is_told_of_and_a_tone_stands_in(
    espeak: Espeak, tmp_path: Path, content: bytes | None, caplog: pytest.LogCaptureFixture
) -> None:
    if content is not None:
        (tmp_path / "elbow.wav").write_bytes(content)
    renderer = Renderer(Voice(folder=tmp_path, sounds={"joint.elbow_flexion": "file:elbow.wav"}), JOINTS)
    assert pitch(renderer.wav(("joint.elbow_flexion",))) == pytest.approx(note(1), abs=1)
    assert "elbow.wav" in caplog.text


@pytest.mark.parametrize(
    ("width", "channels", "rate"), [(1, 1, 8000), (2, 2, 44_100), (3, 1, 48_000), (4, 2, 22_050)]
)
def test_a_file_of_another_kind_sounds_the_same(
    espeak: Espeak, tmp_path: Path, width: int, channels: int, rate: int
) -> None:
    sine = 0.9 * np.sin(2 * np.pi * 700 * np.arange(rate // 4) / rate)
    whole = np.round(sine * (2 ** (8 * width - 1) - 1)).astype(np.int64) + (128 if width == 1 else 0)
    raw = np.repeat(whole, channels).astype("<i8").view(np.uint8).reshape(-1, 8)[:, :width].tobytes()
    with wave.open(str(tmp_path / "stop.wav"), "wb") as file:
        file.setparams((channels, width, rate, 0, "NONE", ""))
        file.writeframes(raw)
    wav = Renderer(Voice(folder=tmp_path), JOINTS).wav(("stop",))
    assert pitch(wav) == pytest.approx(700, abs=2)
    assert len(sound(wav)) == pytest.approx(RATE_HZ / 4, rel=0.01)
    assert np.abs(sound(wav)).max() == pytest.approx(0.72, abs=0.03)


def test_several_events_are_heard_one_after_the_other(espeak: Espeak) -> None:
    renderer = Renderer(Voice(), JOINTS)
    both = sound(renderer.wav(("mark.contact", "trial.start")))
    parts = [sound(renderer.wav((event,))) for event in ("mark.contact", "trial.start")]
    assert len(both) == pytest.approx(sum(map(len, parts)) + 0.04 * RATE_HZ, abs=2)


def test_no_sound_is_longer_than_the_page_takes(espeak: Espeak) -> None:
    endless = " + ".join(["tone:440/2000"] * 5)
    wav = Renderer(Voice(sounds={"stop": endless}), JOINTS).wav(("stop",))
    assert wav is not None
    assert len(wav) <= 200_000
    assert len(sound(wav)) / RATE_HZ == pytest.approx(LONGEST)
    assert abs(sound(wav)[-1]) < 1e-3


def test_what_is_to_be_silent_is_nothing(espeak: Espeak) -> None:
    renderer = Renderer(Voice(sounds={"pause": "none"}), JOINTS)
    assert renderer.wav(("pause",)) is None
    assert renderer.wav(("mark.of_no_kind",)) is None
    assert renderer.wav(("mark.waypoint_3_left",)) is None
    assert sound(renderer.wav(("pause", "trial.start"))) == pytest.approx(
        sound(renderer.wav(("trial.start",)))
    )


def test_a_waypoint_that_is_reached_is_higher_than_a_contact(espeak: Espeak) -> None:
    renderer = Renderer(Voice(), JOINTS)
    entered, held, contact = (
        pitch(renderer.wav((f"mark.{mark}",))) for mark in ("waypoint_2", "waypoint_2_held", "contact")
    )
    assert contact < 250 < 900 < entered < held


def test_every_shipped_sound_is_a_wav_that_any_player_takes(espeak: Espeak) -> None:
    renderer = Renderer(Voice(), JOINTS)
    for event in renderer.events():
        wav = renderer.wav((event,))
        if wav is not None:
            with wave.open(BytesIO(wav)) as file:
                assert (file.getnchannels(), file.getsampwidth(), file.getframerate()) == (1, 2, RATE_HZ)
                assert len(file.readframes(10**6)) == len(wav) - 44
