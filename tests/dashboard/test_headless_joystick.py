"""An arm with a joystick of its own and no muscles: the page shows the one, and has no part for the other."""

import json
from pathlib import Path

import pytest

from tests.dashboard.chromium import Browser
from tests.dashboard.rig import CONFIG, lab, opened

pytestmark = pytest.mark.real_time

TOLD = {"connected": True, "paused": False, "problem": "", "held": False, "axes": {}}


async def test_the_arms_own_joystick_is_shown_and_muscles_it_has_not_are_not(
    browser: Browser, tmp_path: Path
) -> None:
    with lab(tmp_path, CONFIG.with_name("joystick.toml")) as site:
        page = await opened(await browser.page(), site.operator)
        assert not await page.eval("document.querySelector('#tab-muscles')")
        await page.click("#tab-controls")
        await page.until("document.querySelector('.joystick-state')?.checkVisibility()")
        await page.until("document.querySelector('.joystick-state').textContent.startsWith('○')")
        facts = "document.querySelector('.gamepad-facts').innerText"
        assert "not plugged in" in await page.eval(facts)
        await page.eval("bentod.link.handlers.frame = () => {}")
        shown = "document.querySelector('.joystick-state').textContent"
        for change, words, fact in (
            ({}, "until its dead man is held", "let go: button "),
            ({"held": True}, "may drive", "■ held: button "),
            ({"paused": True}, "paused", "paused by its own button"),
        ):
            await page.eval(f"bentod.feed({{...bentod.frame, joystick: {json.dumps(TOLD | change)}}})")
            await page.until(f"{shown}.includes('{words}')")
            assert fact in await page.eval(facts)
        assert not page.problems
