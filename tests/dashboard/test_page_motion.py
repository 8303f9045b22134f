"""A motion lasts for as long as somebody holds it and sees the arm: in a real browser, on a real daemon."""

import asyncio
import os
import signal
import time
from collections.abc import Awaitable, Callable

import pytest

from tests.dashboard.chromium import Browser
from tests.dashboard.page import PATIENCE, Page
from tests.dashboard.rig import Lab, opened, soon

pytestmark = pytest.mark.real_time

PUSH = "bentod.hold('test', 'move', {joint: 'wrist_flexion', velocity: 0.1})"


def moved(site: Lab) -> bool:
    """Whether a page moves the arm."""
    joints = site.state()["joints"]
    assert isinstance(joints, list)
    return any(joint["holder"].startswith("client:page") for joint in joints)


async def push(page: Page, site: Lab) -> None:
    """Have the page hold a joint; on a busy machine it may see the arm too late at first, and is refused."""
    deadline = time.monotonic() + PATIENCE
    while not moved(site):
        assert time.monotonic() < deadline, "nothing moved"
        assert await page.eval(f"bentod.motion.keys.includes('test') || {PUSH}")
        await asyncio.sleep(0.02)


async def test_a_hold_is_renewed_until_it_is_let_go(page: Page, site: Lab) -> None:
    await page.eval("window.sent = 0")
    await page.eval(
        "const hold = bentod.link.hold; bentod.link.hold = (...a) => (sent += 1, hold.apply(bentod.link, a))"
    )
    await push(page, site)
    await page.until("sent >= 8")
    await page.eval("bentod.release('test')")
    await soon(lambda: not moved(site))
    sent = await page.eval("sent")
    await page.until(f"bentod.frame.tick > {site.state()['tick']}")
    assert await page.eval("sent") == sent


@pytest.mark.parametrize(
    "happens",
    [
        lambda page: page.hide(),
        lambda page: page.eval("dispatchEvent(new Event('blur'))"),
        lambda page: page.eval("dispatchEvent(new Event('pagehide'))"),
        lambda page: page.eval("dispatchEvent(new Event('offline'))"),
        lambda page: page.eval("bentod.link._socket.close()"),
        lambda page: page.key("Escape"),
        lambda page: page.goto("about:blank"),
    ],
    ids=["hidden tab", "other window", "page left", "offline", "connection lost", "Escape", "another page"],
)
async def test_it_ends_when(happens: Callable[[Page], Awaitable[None]], page: Page, site: Lab) -> None:
    await push(page, site)
    await happens(page)
    await soon(lambda: not moved(site))


async def test_it_ends_when_the_page_hangs(page: Page, site: Lab) -> None:
    await push(page, site)
    hanging = asyncio.create_task(
        page.eval("(() => { const t = Date.now(); while (Date.now() - t < 1500); })()")
    )
    await soon(lambda: not moved(site))
    assert not hanging.done(), "it ended before the page lived again"
    await hanging


async def test_what_is_hidden_begins_no_motion(page: Page) -> None:
    await page.hide()
    assert await page.eval(PUSH) is False


async def test_who_only_looks_begins_no_motion(looking: Page) -> None:
    assert await looking.eval(PUSH) is False
    assert await looking.eval("document.querySelector('#pause').disabled")
    await looking.click("#stop")
    await looking.until("bentod.frame.mode === 'paused'")


async def test_going_home_is_ended_by_its_button_and_by_a_hidden_tab(page: Page, site: Lab) -> None:
    with site.arm() as arm:
        arm.call("move", joint="wrist_flexion", position=1.2, lease_s=10.0)
        await soon(lambda: site.angle("wrist_flexion") > 0.8)
    await page.click("#home")
    await page.until("document.querySelector('#home').textContent.startsWith('Cancel')")
    await page.click("#home")
    await page.until("document.querySelector('#home').textContent === 'Home'")
    assert site.goal() == "cancelled"
    await page.click("#home")
    assert await page.eval("!bentod.motion.keys.length"), "a button that has just turned round waits"
    await page.until("bentod.motion.keys.length || (document.querySelector('#home').click(), false)")
    await page.until("bentod.frame.goal?.status === 'moving'")
    await page.hide()
    await soon(lambda: site.goal() == "cancelled")


async def test_the_server_that_is_killed_comes_back_and_so_does_the_page(browser: Browser, site: Lab) -> None:
    page = await opened(await browser.page(), site.operator)
    before = site.state()["tick"]
    (worker,) = site.workers()
    os.kill(worker, signal.SIGKILL)
    await page.until("!bentod.linkState.page")
    await page.until("window.bentod?.linkState.daemon && bentod.frame?.tick > 0")
    assert site.workers() != [worker]
    after = site.state()["tick"]
    assert isinstance(before, int)
    assert isinstance(after, int)
    assert after > before
    await page.click("#stop")
    await page.until("bentod.frame.mode === 'paused'")
