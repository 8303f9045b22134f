"""A gamepad at the browser: what it moves and does, and when all of that ends."""

import base64
import json
from pathlib import Path

import pytest

from tests.control.test_joystick_axes import LITERAL
from tests.dashboard.chromium import Browser
from tests.dashboard.page import Page
from tests.dashboard.rig import Lab, opened

pytestmark = pytest.mark.real_time

SOURCE = Path(__file__).parents[2] / "bentod" / "dashboard" / "page" / "src" / "padmapping.js"

FAKE = """
  const pad = {id: "Pad of the tests", connected: true, index: 0, mapping: "standard", axes: [0, 0, 0, 0],
               buttons: Array.from({length: 17}, () => ({pressed: false, value: 0}))};
  window.hands = {
    pad,
    push: (axis, value) => (pad.axes[axis] = value),
    hold: (...numbers) => pad.buttons.forEach((one, n) => (one.pressed = numbers.includes(n))),
  };
  navigator.getGamepads = () => [pad.connected ? pad : null];
"""
HOLD, NEXT, PAUSE, HOME, OWN, RELEASE = 5, 0, 1, 2, 3, 9

SPEED = "Math.abs(bentod.frame.joints[0].velocity)"
WAITS = "document.querySelector('.gamepad-status').textContent.includes('until every axis')"
READY = "document.querySelector('.gamepad-status')?.textContent.includes('may drive')"


@pytest.fixture
async def played(browser: Browser, site: Lab) -> Page:
    """The page of a calm arm whose shoulder is selected, with a gamepad that was seen at rest."""
    with site.arm() as arm:
        arm.call("group_activate", group="arm", joint="shoulder_rotation")
    page = await browser.page()
    await page.before_scripts(FAKE + "localStorage.setItem('bentod.tab', '\"controls\"')")
    await opened(page, site.operator)
    await page.until(READY)
    return page


async def hold(page: Page, *buttons: int) -> None:
    """Hold exactly these, long enough to be seen."""
    await page.eval(f"hands.hold({', '.join(map(str, buttons))})")
    await page.eval("new Promise(seen => requestAnimationFrame(() => requestAnimationFrame(seen)))")


async def push(page: Page, way: str = "bentod.frame.joints[0].position > 0 ? -1 : 1") -> None:
    """Hold the dead man, then push the left stick until the shoulder moves; by default towards the middle.

    Whoever is late with pictures must rest and begin again, as on any machine that is too busy.
    """
    for _ in range(30):
        await page.eval("hands.push(0, 0)")
        await hold(page)
        await page.until(READY)
        await hold(page, HOLD)
        await page.eval(f"hands.push(0, {way})")
        moves = f"bentod.motion.keys.length && {SPEED} > 0.1"
        if await page.until(f"({moves}) ? 'moves' : ({WAITS} && 'waits')") == "moves":
            return
    raise AssertionError("pictures come too late for anything to move")


async def test_the_page_shapes_axes_as_the_daemon_does(browser: Browser) -> None:
    page = await browser.page()
    code = base64.b64encode(SOURCE.read_bytes()).decode()
    asked = [
        [
            {"dead_zone": zone, "expo": expo, "invert": invert, "one_sided": one, "max": share},
            str(value).replace("nan", "NaN").replace("inf", "Infinity"),
        ]
        for value, zone, expo, invert, one, share, _ in LITERAL
    ]
    found = await page.eval(
        f"import('data:text/javascript;base64,{code}').then(({{shaped}}) =>"
        f" {json.dumps(asked)}.map(([axis, value]) => shaped(Number(value), axis)))"
    )
    assert found == pytest.approx([literal[-1] for literal in LITERAL], abs=1e-12)


async def test_a_push_moves_the_arm_while_the_dead_man_is_held_and_shows_it(played: Page, site: Lab) -> None:
    await played.eval("hands.push(0, 1)")
    await played.until("document.querySelector('.gamepad-counts').textContent === 'asks in vain'")
    assert await played.eval(SPEED) < 0.05
    await played.eval("hands.push(0, 0)")
    await push(played)
    assert "is held" in await played.eval("document.querySelector('.gamepad-deadman').textContent")
    assert await played.eval("document.querySelector('.gamepad-counts').textContent") == "moves"
    await hold(played)
    await played.until(f"{SPEED} < 0.05 && !bentod.motion.keys.length")
    assert not played.problems


async def test_what_ends_a_push_leaves_it_ended_until_the_pad_was_at_rest(played: Page) -> None:
    ends = {
        "hands.pad.connected = false": "hands.pad.connected = true",
        "document.querySelector('.gamepad-own').click()": "document.querySelector('.gamepad-own').click()",
        "dispatchEvent(new Event('blur'))": "0",
    }
    for end, again in ends.items():
        await push(played)
        await played.eval(end)
        left = await played.eval("bentod.motion.keys.join()")
        assert not left or "pad" in end, (end, left)
        await played.until("!bentod.motion.keys.length")
        await played.eval(again)
        await played.until(WAITS)
        assert not await played.eval("bentod.motion.keys.length")
    await push(played)
    await played.hide()
    assert not await played.eval("bentod.motion.keys.length")
    await played.hide(False)
    await played.until(WAITS)


async def test_its_buttons_do_what_they_say(played: Page, site: Lab) -> None:
    active = await played.eval("bentod.frame.groups[0].active")
    await hold(played, NEXT)
    await played.until(f"bentod.frame.groups[0].active !== '{active}'")
    await hold(played)
    await hold(played, NEXT)
    await played.until(f"bentod.frame.groups[0].active === '{active}'")
    await hold(played, PAUSE)
    await played.until("bentod.frame.mode === 'paused'")
    await hold(played, RELEASE)
    await played.until("document.querySelector('.notices').textContent.includes('Hold the right bumper (5)')")
    assert site.state()["mode"] == "paused"
    while await played.eval("bentod.frame.mode !== 'active'"):
        await hold(played)
        await played.until(READY)
        await hold(played, HOLD)
        await hold(played, HOLD, RELEASE)
        await played.until(f"bentod.frame.mode === 'active' || {WAITS}")
    await hold(played, OWN)
    await played.until("document.querySelector('.gamepad-own').getAttribute('aria-pressed') === 'true'")


async def test_the_way_home_lasts_as_long_as_the_dead_man_is_held(played: Page) -> None:
    while not await played.eval("Math.abs(bentod.frame.joints[0].position) > 0.3"):
        await push(played, "bentod.frame.joints[0].position < 0 ? -1 : 1")
        await played.until(f"Math.abs(bentod.frame.joints[0].position) > 0.3 || {WAITS}")
    await played.eval("hands.push(0, 0)")
    while await played.eval("bentod.frame.goal?.status !== 'moving'"):
        await hold(played)
        await played.until(READY)
        await hold(played, HOLD)
        await hold(played, HOLD, HOME)
        await played.until(f"bentod.frame.goal?.status === 'moving' || {WAITS}")
    await hold(played)
    await played.until("bentod.frame.goal?.status === 'cancelled'")
