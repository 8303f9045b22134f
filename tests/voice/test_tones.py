"""Tones: the right pitch, soft edges, and no click where they change."""

from itertools import pairwise

import numpy as np
import pytest

from bentod.voice.hum import CHUNK, Hum
from bentod.voice.tones import NOTES, RATE_HZ, Sound, note, tone

PITCHES = {"shoulder": 220.0, "elbow": 440.0}


def listen(hum: Hum, chunks: int) -> Sound:
    raw = b"".join(hum.chunk() for _ in range(chunks))
    return np.frombuffer(raw, "<i2") / 32_767


@pytest.mark.parametrize("pitch", [50, 440, 4000])
def test_a_tone_begins_and_ends_softly(pitch: float) -> None:
    sound = tone(pitch, 0.2)
    assert len(sound) == round(0.2 * RATE_HZ)
    assert np.abs(sound).max() == pytest.approx(1, abs=0.05)
    steepest = 2 * np.pi * pitch / RATE_HZ
    assert np.abs(np.diff(sound)).max() <= steepest * 1.05 + 0.02
    assert np.abs(sound[:20]).max() < 0.03
    assert np.abs(sound[-20:]).max() < 0.03


def test_neighbouring_joints_are_two_semitones_apart_at_least() -> None:
    pitches = [note(index) for index in range(NOTES)]
    assert pitches[0] == 220
    assert all(high / low > 2 ** (1.9 / 12) for low, high in pairwise(pitches))
    assert pitches[-1] < 4000


def test_the_quiet_tone_follows_what_is_selected_without_a_click() -> None:
    selected = "shoulder"
    hum = Hum(0.03, PITCHES, lambda: selected)
    parts = [listen(hum, 20)]
    selected = "elbow"
    parts.append(listen(hum, 20))
    selected = ""
    parts.append(listen(hum, 20))
    whole = np.concatenate(parts)
    assert np.abs(whole).max() <= 0.03 + 1e-4
    assert np.abs(np.diff(whole)).max() < 0.03 * 2 * np.pi * 440 / RATE_HZ * 1.1 + 1e-4
    for part, expected in ((parts[0], 220), (parts[1], 440)):
        settled = part[2 * CHUNK :]
        assert np.abs(np.fft.rfft(settled, 2 * RATE_HZ)).argmax() / 2 == pytest.approx(expected, abs=2)
    assert len(parts[2]) == CHUNK  # it fades, and then there is nothing
    assert abs(parts[2][-1]) < 1e-4


def test_while_nothing_is_selected_there_is_nothing_to_be_heard() -> None:
    assert Hum(0.03, PITCHES, lambda: "").chunk() == b""
    assert Hum(0.03, PITCHES, lambda: "a stranger").chunk() == b""
