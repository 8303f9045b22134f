"""The sentences that tell what the arm does, what it expects, how sure it is, and how to stop it."""

import math
from typing import Any

import pytest

from tests.dashboard.frames import NAMES, Table, frame, script
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


async def told(page: Page, *frames: Table | None, **around: object) -> list[Any]:
    """The story of each frame, with plain spaces. `around`: what it does not tell."""
    found = await page.eval(f"{script(frames)}.map((frame) => bentod.now.sentences(frame, {script(around)}))")
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
    very, fairly, hardly, new, silent, unknown, unproven, nothing = await told(
        page,
        expecting(0.42, learned(0.93, 0.05)),
        expecting(0.42, learned(0.7, 0.1)),
        expecting(0.01, learned(-0.3, 0.05)),
        expecting(0.42, learned(0.99, 0.05, familiarity=0.05)),
        expecting(0.42, learned(None, 0.05)),
        expecting(0.42, learned(None)),
        expecting(0.42, learned(0.77)),
        frame(),
    )
    assert very["expects"] == "Shoulder rotation is expected to go to +24° within 0.7 s."
    assert very["sure"]["text"] == "It is very sure (93%); such predictions were off by about 3° so far."
    assert fairly["sure"]["text"].startswith("It is fairly sure (70%); such predictions were off by about 6°")
    assert hardly["expects"] == "Shoulder rotation is expected to stay at about +1° for 0.7 s."
    assert hardly["sure"]["text"].startswith("It is not sure (0%)")
    assert new["sure"]["word"] == "not sure"
    assert "not learned enough" in new["sure"]["text"]
    assert silent["sure"]["share"] is None
    assert "off by about 3°" in silent["sure"]["text"]
    assert unknown["sure"] == unproven["sure"]
    assert unproven["sure"] == {"word": "still learning", "share": None, "text": "It is still learning."}
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


async def test_nobody_is_surer_than_what_came_true(page: Page) -> None:
    degree = math.pi / 180
    stories = await told(page, *(expecting(0.42, learned(0.95, d * degree)) for d in (3, 9, 18, 60)))
    assert [story["sure"]["word"] for story in stories] == [
        "very sure",
        "fairly sure",
        "not sure",
        "not sure",
    ]
    shares = [story["sure"]["share"] for story in stories]
    assert shares == sorted(shares, reverse=True)
    assert shares[1] < 0.85
    assert shares[2] < 0.6
    assert shares[3] == 0


async def test_what_moves_is_never_said_to_stay(page: Page) -> None:
    fast = {"position": -0.31, "velocity": -0.54, "predictions": {"20": -0.31}}
    (story,) = await told(page, frame({"shoulder_rotation": fast}, learn=learned(0.9, 0.05)))
    assert story["expects"] == "Shoulder rotation is expected to be at about −18° within 0.7 s."


async def test_of_joints_that_do_not_answer_no_speed_is_told(page: Page) -> None:
    lost = {"velocity": 0.58, "freshness": "lost", "age": 2.7, "predictions": {"20": 0.5}}
    one, two, every = await told(
        page,
        frame({"elbow_flexion": lost}),
        frame({"elbow_flexion": lost, "gripper": lost}),
        frame(dict.fromkeys(NAMES, lost), mode="fault", fault="The bus is gone."),
    )
    assert [one["headline"], *one["doing"]] == ["Elbow flexion has not answered for 2.7 s."]
    assert two["headline"] == "Elbow flexion and gripper have not answered for 2.7 s."
    assert every["doing"] == ["The bus is gone.", "No joint answers (2.7 s)."]
    assert every["expects"] == ""
    assert every["help"] == "Nothing helps while the arm is stopped by a fault."


async def test_who_sees_an_arm_from_afar_is_told_only_what_is_true_there(page: Page) -> None:
    deaf = frame(mode="paused", emg={"problem": "The config has no [emg] table.", "paused": False})
    pad = {"connected": False, "paused": False, "problem": "No joystick at /dev/input/js0", "held": True}
    (watched,) = await told(page, frame(mode="paused"), operator=False)
    plain_arm, joystick, unplugged = await told(
        page, deaf, deaf | {"joystick": pad}, deaf | {"mode": "active", "joystick": pad}, muscles=False
    )
    assert watched["todo"] == "An operator must release it."
    assert plain_arm["headline"] == "The arm is paused: it holds still."
    assert plain_arm["todo"] == "Release to let it move."
    assert joystick["todo"] == "Release to let the joystick move it."
    assert unplugged["headline"] == "No joystick at /dev/input/js0."
    assert "uscle" not in f"{plain_arm}{joystick}{unplugged}"
    (fingers,) = await told(page, frame(), touch=True)
    assert fingers["stop"] == "Press STOP: all joints stop."


async def test_without_a_connection_nothing_is_told_but_how_to_stop_the_arm_all_the_same(page: Page) -> None:
    await page.until("document.querySelector('.now-headline').textContent.startsWith('The arm is still.')")
    card = await page.eval(
        "(bentod.link.handlers.frame = () => {}, bentod.link.handlers.link = () => {},"
        "bentod._linked({page: true, daemon: false, why: 'It has ended.'}),"
        "document.querySelector('.now').innerText)"
    )
    assert "what stands here is old. It has ended." in card
    assert "STOP cannot reach the arm from here: cut its power." in card
    for word in ("Next", "How sure", "Help", "Escape"):
        assert word not in card, word


async def test_the_page_shows_the_sentences_of_the_arm(page: Page) -> None:
    await page.until("document.querySelector('.now-headline').textContent.startsWith('The arm is still.')")
    await page.key("Escape")
    await page.until("document.querySelector('.now-todo').textContent.startsWith('Release')")
    assert await page.eval(
        "document.querySelector('.now [aria-live]').textContent.startsWith('The arm is paused')"
    )
