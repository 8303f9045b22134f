"""When what is told: literal frames and events in, words out."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bentod.config_sounds import candidates, named
from bentod.voice.cues import SETTLE, Cues
from bentod.voice.glance import Glance, GroupSeen, glance, told
from tests.voice.scripted import Case, Step, cases


def take(cues: Cues, step: Step) -> None:
    if step.what == "frame":
        cues.frame(step.time, glance(step.value))
    elif step.what == "event":
        cues.event(step.time, told(step.value))
    elif step.what == "lost":
        cues.lost()


@pytest.mark.parametrize("case", cases(), ids=lambda case: case.name)
def test_what_is_told_is_as_written(case: Case) -> None:
    cues = Cues()
    heard = []
    for step in case.steps:
        take(cues, step)
        heard.append((step.time, cues.due(step.time), cues.selected(step.time)))
    assert heard == [(step.time, step.due, step.selected) for step in case.steps]


def seen(joint: str, word: str) -> Glance:
    group = GroupSeen("arm", joint, together=False, driven=False)
    return Glance(word, (group,), False, (0, ""), 0, True, frozenset())


@given(st.lists(st.tuples(st.sampled_from("abc"), st.sampled_from(("release", "pause", "fault", "limp")))))
def test_whatever_happens_what_lasts_is_told_last(lasts: list[tuple[str, str]]) -> None:
    cues, now, said = Cues(), 0.0, ["joint.a"]
    for joint, word in [("a", "release"), *lasts, *(lasts[-1:] * 60)]:
        cues.frame(now, seen(joint, word))
        said += cues.due(now)
        now += 1 / 30
    joint, word = lasts[-1] if lasts else ("a", "release")
    assert [event for event in said if event.startswith("joint.")][-1] == f"joint.{joint}"
    words = ["release", *(event for event in said if not event.startswith("joint."))]
    assert words[-1] == word
    assert cues.due(math.inf) == []


def test_no_word_comes_later_than_it_must_to_be_the_last_one() -> None:
    assert SETTLE <= 0.2


@pytest.mark.parametrize(
    ("event", "keys"),
    [
        ("fault", ("fault",)),
        ("joint.wrist_2", ("joint.wrist_2", "joint")),
        ("mark.contact", ("mark.contact", "mark")),
        (
            "mark.waypoint_2_held",
            ("mark.waypoint_2_held", "mark.waypoint_held", "mark.waypoint_2", "mark.waypoint", "mark"),
        ),
        ("emg.prompt.hand_open", ("emg.prompt.hand_open", "emg.prompt.hand", "emg.prompt")),
        ("mark", ("mark",)),
    ],
)
def test_the_most_special_sound_is_looked_for_first(event: str, keys: tuple[str, ...]) -> None:
    assert candidates(event) == keys


@given(st.text())
def test_whatever_is_marked_has_the_name_of_an_event_and_of_a_file(text: str) -> None:
    event = named("mark", text)
    assert event.startswith("mark")
    assert len(event) <= 70
    assert not set(event) & set("/\\ \0\n\t-")
