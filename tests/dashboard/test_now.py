"""The sentences that tell what the arm does, what it expects, how sure it is, and how to stop it."""

from typing import Any

import pytest

from tests.dashboard.frames import Table, frame, script
from tests.dashboard.page import Page

pytestmark = pytest.mark.real_time

UP = {"velocity": 0.21, "holder": "emg"}


def learned(confidence: float | None, error: float | None = None, familiarity: float = 1.0) -> Table:
    name = "shoulder_rotation.position@20"
    return {
        "confidence": {} if confidence is None else {name: confidence},
        "error": {} if error is None else {name: error},
        "familiarity": {"arm": familiarity},
    }


def expecting(rad: float, learn: Table) -> Table:
    return frame({"shoulder_rotation": {"predictions": {"10": 9.0, "20": rad}}}, learn=learn)


async def told(page: Page, *frames: Table | None) -> list[Any]:
    """The story of each frame, with plain spaces."""
    found = await page.eval(f"{script(frames)}.map((frame) => bentod.now.sentences(frame))")
    return [plain(story) for story in found]


def plain(value: Any) -> Any:
    match value:
        case str():
            return value.replace("\u00a0", " ")
        case list():
            return [plain(one) for one in value]
        case dict():
            return {key: plain(one) for key, one in value.items()}
    return value


async def test_what_moves_is_told_with_its_way_its_speed_and_who_moves_it(page: Page) -> None:
    muscles, helped, client, odd, still = await told(
        page,
        frame({"elbow_flexion": UP}),
        frame(
            {"elbow_flexion": UP, "shoulder_rotation": {"velocity": -0.1, "holder": "assist"}},
            assist={"attended": "elbow_flexion", "reason": "Moves shoulder_rotation to where it goes."},
        ),
        frame({"gripper": {"velocity": -0.3, "holder": "client:notebook"}}),
        frame(joints=None) | {"joints": [{**frame()["joints"][0], "name": "third_thumb", "velocity": 0.1}]},
        frame(),
    )
    assert muscles["headline"] == "Elbow flexion is moving up at 12 °/s, driven by the muscles."
    assert helped["headline"] == muscles["headline"]
    assert helped["doing"] == ["Shoulder rotation is turning right at 6 °/s, moved by the assist."]
    assert helped["help"] == "Moves shoulder rotation to where it goes."
    assert client["headline"] == "Gripper is closing at 17 °/s, moved by notebook."
    assert odd["headline"] == "Third thumb is moving to higher angles at 6 °/s, coming to rest."
    assert still["headline"] == "The arm is still. Shoulder rotation is selected."
    assert {story["stop"] for story in (muscles, still)} == {"Press Escape or STOP: all joints stop."}


async def test_what_is_expected_is_told_with_how_soon_and_how_sure(page: Page) -> None:
    very, fairly, hardly, new, silent, unknown, nothing = await told(
        page,
        expecting(0.42, learned(0.93, 0.05)),
        expecting(0.42, learned(0.7, 0.4)),
        expecting(0.01, learned(-0.3)),
        expecting(0.42, learned(0.99, familiarity=0.05)),
        expecting(0.42, learned(None, 0.05)),
        expecting(0.42, learned(None)),
        frame(),
    )
    assert very["expects"] == "Shoulder rotation is expected to go to +24° within 0.7 s."
    assert very["sure"]["text"] == "It is very sure (93%); such predictions were off by about 3° so far."
    assert fairly["sure"]["text"].startswith("It is fairly sure (70%), though such predictions were off")
    assert hardly["expects"] == "Shoulder rotation is expected to stay at about +1° for 0.7 s."
    assert hardly["sure"] == {"word": "not sure", "share": 0, "text": "It is not sure (0%)."}
    assert new["sure"]["word"] == "not sure"
    assert "not learned enough" in new["sure"]["text"]
    assert silent["sure"]["share"] is None
    assert "off by about 3°" in silent["sure"]["text"]
    assert "not learned enough" in unknown["sure"]["text"]
    assert nothing["expects"] == ""


async def test_an_arm_that_waits_says_why_first_and_what_to_do_next(page: Page) -> None:
    paused, limp, holding, fault, silent, none = await told(
        page,
        frame({"elbow_flexion": UP}, mode="paused"),
        frame(mode="limp"),
        frame(mode="holding"),
        frame(mode="fault", fault="Elbow flexion is silent"),
        frame({"elbow_flexion": {"freshness": "lost", "age": 0.61}}),
        None,
    )
    assert paused["headline"] == "The arm is paused: it holds still, whatever the muscles say."
    assert paused["todo"] == "Release to let the muscles move it."
    assert paused["expects"] == ""
    assert limp["todo"].startswith("Switch the torque on")
    assert limp["stop"].startswith("It cannot move by itself now.")
    assert holding["todo"] == paused["todo"]
    assert fault["doing"][0] == "Elbow flexion is silent."
    assert fault["todo"].startswith("Clear the fault when its cause is gone")
    assert silent["headline"] == "Elbow flexion has not answered for 0.6 s."
    assert none["headline"] == "Waiting for the arm."


async def test_the_page_shows_the_sentences_of_the_arm(page: Page) -> None:
    await page.until("document.querySelector('.now-headline').textContent.startsWith('The arm is still.')")
    await page.key("Escape")
    await page.until("document.querySelector('.now-todo').textContent.startsWith('Release')")
    assert await page.eval(
        "document.querySelector('.now [aria-live]').textContent.startsWith('The arm is paused')"
    )
