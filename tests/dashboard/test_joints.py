"""The rows of the joints: they show what is, and their buttons do what they say."""

import pytest

from tests.dashboard.frames import frame, script
from tests.dashboard.page import Page
from tests.dashboard.rig import Lab

pytestmark = pytest.mark.real_time

ELBOW = ".joints-row:nth-child(2)"
MORE, PAUSE = (f"{ELBOW} .joints-actions button:nth-child({n})" for n in (2, 3))


def says(selector: str, text: str) -> str:
    return f"document.querySelector({script(selector)}).textContent.includes({script(text)})"


async def test_a_joint_moves_only_while_its_button_is_held(page: Page, site: Lab) -> None:
    with site.arm() as arm:  # to the middle of its range, from where there is room to move
        arm.call("move", joint="elbow_flexion", position=0.2, lease_s=2.0)
        await page.until("Math.abs(bentod.frame.joints[1].position - 0.2) < 0.02")
    await page.until("bentod.frame.joints[1].holder === ''")
    before = await page.eval("bentod.frame.joints[1].position")
    async with page.held(MORE):
        await page.until("bentod.frame.joints[1].holder.startsWith('client')")
        await page.until(f"bentod.frame.joints[1].position > {before + 0.01}")
    await page.until("bentod.frame.joints[1].holder === '' && bentod.frame.joints[1].velocity === 0")


async def test_one_joint_is_paused_and_released_by_its_own_button(page: Page, site: Lab) -> None:
    await page.until(says(PAUSE, "Pause"))
    await page.click(PAUSE)
    await page.until("bentod.frame.joints[1].mode === 'paused' && bentod.frame.mode === 'active'")
    await page.until(says(PAUSE, "Release"))
    await page.click(PAUSE)
    assert await page.eval("bentod.frame.joints[1].mode") == "paused"  # too soon: it was Pause a moment ago
    await page.eval("new Promise((resolve) => setTimeout(resolve, 650))")
    await page.click(PAUSE)
    await page.until("bentod.frame.joints[1].mode === 'active'")


async def test_a_joint_goes_limp_only_by_a_second_press(page: Page) -> None:
    torque = ".joints-row:nth-child(5) .joints-actions button:nth-child(4)"  # the gripper's: it does not fall
    await page.until(says(torque, "Torque off"))
    await page.click(torque)
    await page.until(says(torque, "May fall"))
    assert await page.eval("bentod.frame.joints[4].torque")
    await page.click(torque)
    await page.until("!bentod.frame.joints[4].torque")
    await page.until(says(torque, "Torque on"))
    await page.click(torque)
    await page.until("bentod.frame.joints[4].torque")


async def test_an_observer_sees_the_joints_and_can_move_none(looking: Page) -> None:
    await looking.until("document.querySelectorAll('.joints-row').length === 5")
    assert await looking.eval(
        "[...document.querySelectorAll('.joints-actions button')].every((b) => b.disabled)"
    )


async def test_a_row_tells_numbers_with_units_and_warnings_in_words(page: Page) -> None:
    told = frame(
        {
            "elbow_flexion": {
                "position": 0.35,
                "velocity": -0.2,
                "load": 0.31,
                "temperature": 61.0,
                "holder": "emg",
                "limited": "warm",
                "errors": ["overheating"],
                "predictions": {"10": 0.1, "20": 0.5},
            }
        }
    )
    await page.until(f"!!document.querySelector({script(ELBOW)})")
    await page.eval("bentod.link.handlers.frame = () => {}")  # from here on only the frame below
    row = await page.eval(
        f"new Promise((resolve) => {{ bentod.feed({script(told)});"
        f"requestAnimationFrame(() => resolve(document.querySelector({script(ELBOW)}).innerText)) }})"
    )
    for words in (
        "+20.1°",
        "−11 °/s",
        "load 31%",
        "61 °C",
        "expected +28.6°",
        "moved by muscles",
        "⚠ overheating",
        "slowed: warm",
    ):
        assert words in row, words


async def test_rows_and_groups_tell_no_more_than_is_known(page: Page) -> None:
    expected = {"predictions": {"20": 0.5}}
    lost = {"freshness": "lost", "age": 2.7, "velocity": 0.5}
    moments = [
        frame({"elbow_flexion": expected}, mode="paused"),
        frame(
            dict.fromkeys([joint["name"] for joint in frame()["joints"]], lost), mode="fault", fault="Gone."
        ),
    ]
    await page.until(f"!!document.querySelector({script(ELBOW)})")
    paused, fault, old = await page.eval(
        "(async () => { bentod.link.handlers.frame = bentod.link.handlers.link = () => {};"
        "const seen = () => document.querySelector('#section-groups').parentElement.parentElement.innerText;"
        "const after = (frame) => new Promise((done) => { bentod.feed(frame); requestAnimationFrame("
        "() => done(seen())) }); const told = [];"
        f"for (const one of {script(moments)}) told.push(await after(one));"
        "bentod._linked({page: true, daemon: false, why: ''}); "
        "return [...told, seen()].map((text) => text.replaceAll('\\u00a0', ' ')) })()"
    )
    assert "○ paused" in paused
    assert "expected" not in paused
    assert fault.count("2.7 s") == 1
    assert "⚠ No joint answers (2.7 s)." in fault
    assert "+29 °/s" not in fault
    assert old.count("not known now") == 6  # five joints and a group
