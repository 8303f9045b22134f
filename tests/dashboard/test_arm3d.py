"""The drawn arm is where the arm is, its ghost where it is expected, and only changes are drawn."""

import math
import random
from typing import Any

import numpy as np
import pytest

from tests.dashboard.chromium import Browser
from tests.dashboard.frames import NAMES, Table, frame, script
from tests.dashboard.kinematics import BENTO, Matrix, pose, read_joints
from tests.dashboard.page import Page
from tests.dashboard.rig import Lab, opened

pytestmark = pytest.mark.real_time

JOINTS = read_joints(BENTO)
EXACT = 1e-4  # m, and sines of angles


@pytest.fixture
async def drawn(webgl_browser: Browser, site: Lab) -> Page:
    """The page in a browser with WebGL, once it has drawn the arm."""
    page = await opened(await webgl_browser.page(), site.operator)
    await page.until("bentod.arm3d.drawn > 0")
    return page


def at(angles: dict[str, float], expected: dict[str, float] | None = None) -> Table:
    """A frame of an arm at these angles, that expects those."""
    told = expected or {}
    return frame(
        {
            name: {"position": angle, "predictions": {"20": told[name]} if name in told else {}}
            for name, angle in angles.items()
        },
        learn=learned(dict.fromkeys(told, 0.9)),
    )


def learned(confidence: dict[str, float], error: float = 0.03) -> Table:
    """What was learned by joints of this confidence, whose predictions were off by so many rad."""
    names = {name: f"{name}.position@20" for name in confidence}
    return {
        "confidence": {names[name]: sure for name, sure in confidence.items()},
        "error": dict.fromkeys(names.values(), error),
        "familiarity": {},
    }


def anywhere(chance: random.Random) -> dict[str, float]:
    """Angles within and beyond the limits, rad."""
    return {name: chance.uniform(-2.5, 2.5) for name in NAMES}


def matrices(found: dict[str, list[float]]) -> dict[str, Matrix]:
    """What the page tells, column by column, as 4 x 4 matrices."""
    return {link: np.array(numbers).reshape(4, 4).T for link, numbers in found.items()}


def assert_same(found: dict[str, list[float]], angles: dict[str, float]) -> None:
    expected = pose(JOINTS, angles)
    assert found.keys() == expected.keys()
    for link, matrix in matrices(found).items():
        np.testing.assert_allclose(matrix, expected[link], atol=EXACT, err_msg=f"{link} at {angles}")


async def test_arm_and_ghost_are_where_forward_kinematics_puts_them(page: Page) -> None:
    chance = random.Random(1)
    tried = [(anywhere(chance), anywhere(chance)) for _ in range(25)]
    await page.until("!!bentod.arm3d.model")
    found: list[Any] = await page.eval(
        f"{script([at(*angles) for angles in tried])}.map((frame) => {{ bentod.arm3d.show(frame);"
        "return [bentod.arm3d.pose(), bentod.arm3d.ghostPose()] })"
    )
    for (angles, expected), (arm, ghost) in zip(tried, found, strict=True):
        assert_same(arm, angles)
        assert_same(ghost, expected)


async def test_there_is_no_ghost_where_nothing_else_is_expected_or_the_arm_waits(page: Page) -> None:
    here, there = dict.fromkeys(NAMES, 0.0), dict.fromkeys(NAMES, 0.3)
    unproven = at(here, there) | {"learn": {**learned(dict.fromkeys(NAMES, 0.9)), "error": {}}}
    frames = [
        at(here, there),
        at(here),
        at(here, here),
        at(here, there) | {"mode": "paused"},
        unproven,
    ]
    await page.until("!!bentod.arm3d.model")
    ghosts = await page.eval(
        f"{script(frames)}.map((frame) => (bentod.arm3d.show(frame), bentod.arm3d.ghostPose() !== null))"
    )
    assert ghosts == [True, False, False, False, False]


async def test_the_fainter_the_ghost_the_less_sure_it_is(page: Page) -> None:
    here, there = dict.fromkeys(NAMES, 0.0), dict.fromkeys(NAMES, 0.3)
    frames = [
        at(here, there) | {"learn": learned(dict.fromkeys(NAMES, sure), error)}
        for sure, error in ((-0.5, 0.03), (0.9, 0.4), (0.9, 0.03))
    ]
    opacities = await page.eval(
        f"{script(frames)}.map((frame) => (bentod.arm3d.show(frame), bentod.arm3d.picture.ghost.opacity))"
    )
    assert 0 < opacities[0] < opacities[1] < opacities[2] < 1


async def test_what_is_no_longer_known_is_drawn_without_ghost_or_ring(page: Page) -> None:
    here, there = dict.fromkeys(NAMES, 0.0), dict.fromkeys(NAMES, 0.3)
    await page.until("!!bentod.arm3d.model")
    before, after, old = await page.eval(
        "(bentod.link.handlers.frame = () => {}, bentod.link.handlers.link = () => {},"
        f"bentod.feed({script(at(here, there))}), bentod.arm3d.show(bentod.frame),"
        "[bentod.arm3d.ghostPose() !== null,"
        "(bentod._linked({page: true, daemon: false, why: ''}), bentod.arm3d.ghostPose() !== null),"
        "document.querySelector('.arm3d').matches('.arm3d-old')])"
    )
    assert (before, after, old) == (True, False, True)


async def test_the_drawn_arm_follows_the_living_one(page: Page, site: Lab) -> None:
    with site.arm() as arm:
        arm.call("move", joint="shoulder_rotation", position=0.5, lease_s=10.0)
        arm.call("move", joint="wrist_flexion", position=-0.6, lease_s=10.0)
        await page.until("!!bentod.arm3d.model && bentod.frame.joints[3].position < -0.2")
    found = await page.eval(
        "(bentod.arm3d.show(bentod.frame), [bentod.arm3d.pose(),"
        "bentod.frame.joints.map((joint) => [joint.name, joint.position])])"
    )
    angles = dict(found[1])
    assert angles["wrist_flexion"] < -0.2
    assert_same(found[0], angles)


async def test_without_webgl_the_arm_is_drawn_as_lines_and_the_page_says_so(page: Page) -> None:
    await page.until("document.querySelector('.arm3d-note').textContent.includes('no WebGL')")
    points = await page.eval(
        f"(bentod.arm3d.show({script(at({'shoulder_rotation': 0.0, 'elbow_flexion': math.pi / 2}))}),"
        "document.querySelector('.arm3d-line').getAttribute('points'))"
    )
    shown = await page.eval(
        "[...document.querySelectorAll('.arm3d-bar-of-buttons, .arm3d-legend')]"
        ".filter((part) => part.getClientRects().length).map((part) => part.innerText)"
    )
    assert len(shown) == 1  # nothing to turn or zoom, and a legend of lines
    assert "┅ ○ expected" in shown[0]
    right, down = (float(number) for number in points.split()[-1].split(","))
    assert (right, -down) == pytest.approx((131.2, 124.3 + 351.0), abs=0.1)  # mm: the hand is above the elbow
    assert not page.problems


async def test_nothing_is_drawn_unless_something_has_changed(drawn: Page) -> None:
    still, moved = at({"elbow_flexion": 0.2}), at({"elbow_flexion": 0.21})
    before, same, after = await drawn.eval(
        f"{script([still, still, moved])}.map((frame) => (bentod.arm3d.show(frame), bentod.arm3d.drawn))"
    )
    assert same == before
    assert after == before + 1
    assert not drawn.problems


async def test_the_joint_that_is_attended_to_has_a_ring_and_its_name(drawn: Page) -> None:
    driven = frame(
        {"elbow_flexion": {"position": 0.2, "velocity": 0.3}}, assist={"attended": "elbow_flexion"}
    )
    label, place, way = await drawn.eval(
        f"(bentod.arm3d.show({script(driven)}), [document.querySelector('.arm3d-label').textContent,"
        "bentod.arm3d.model.ring.parent.urdfName, bentod.arm3d.model.ring.arrows[0].visible])"
    )
    assert label == "Elbow flexion +11°"
    assert place == "upper_arm"
    assert way


async def test_keys_turn_the_view_and_home_turns_it_back(drawn: Page) -> None:
    await drawn.eval("document.querySelector('.arm3d-canvas').focus()")
    first = await drawn.eval("({...bentod.arm3d.stage.orbit.at})")
    for key in ("ArrowLeft", "ArrowUp", "+"):
        await drawn.key(key)
    turned = await drawn.eval("({...bentod.arm3d.stage.orbit.at})")
    assert turned["azimuth"] < first["azimuth"]
    assert turned["elevation"] > first["elevation"]
    assert turned["distance"] < first["distance"]
    await drawn.key("Home")
    assert await drawn.eval("({...bentod.arm3d.stage.orbit.at})") == first


async def test_lost_graphics_leave_lines_until_they_are_back(drawn: Page) -> None:
    await drawn.eval(
        "window.graphics = bentod.arm3d.stage.renderer.getContext().getExtension('WEBGL_lose_context');"
        "graphics.loseContext()"
    )
    await drawn.until("bentod.arm3d.flat && document.querySelector('.arm3d-line').getClientRects().length")
    assert "were lost" in await drawn.eval("document.querySelector('.arm3d-note').textContent")
    await drawn.eval("graphics.restoreContext()")
    await drawn.until("!bentod.arm3d.flat && document.querySelector('.arm3d-canvas').getClientRects().length")
