"""The page itself: what its bar says and does, who may do what, and when a motion ends."""

import pytest

from tests.dashboard.page import Page
from tests.dashboard.rig import Lab

pytestmark = pytest.mark.real_time


async def test_the_bar_says_what_the_arm_does(page: Page) -> None:
    await page.until("document.querySelector('.mode-word').textContent === 'Active'")
    assert not page.problems


async def test_stop_pauses_the_arm(page: Page, site: Lab) -> None:
    await page.click("#stop")
    await page.until("bentod.frame.mode === 'paused'")
    assert site.state()["mode"] == "paused"


async def test_escape_stops_the_arm_even_while_somebody_types(page: Page, site: Lab) -> None:
    await page.eval("document.body.append(Object.assign(document.createElement('input'), {id: 'typing'}))")
    await page.eval("document.querySelector('#typing').focus()")
    await page.key("Escape")
    await page.until("bentod.frame.mode === 'paused'")
