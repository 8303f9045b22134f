"""Joint groups on the page: each button does to the arm what it says."""

import pytest

from tests.dashboard.page import Page
from tests.dashboard.rig import Lab
from tests.rig import table

pytestmark = pytest.mark.real_time

HAND = '.groups-card[data-group="hand"]'
ACTIVE = f"{HAND} [aria-pressed=true]"


def active(site: Lab, group: str = "hand") -> object:
    with site.arm() as arm:
        listed = arm.call("group_list")
    assert isinstance(listed, list)
    return next(one["active"] for one in map(table, listed) if one["name"] == group)


async def shows(page: Page, name: str) -> None:
    """Wait until the page marks that joint of the hand as the active one: pressed, and in a word."""
    await page.until(f"document.querySelector('{ACTIVE}')?.textContent === '{name}▸ active'")


async def test_a_joint_is_made_active_and_toggled_with_buttons_and_keys(page: Page, site: Lab) -> None:
    with site.arm() as arm:
        arm.call("group_activate", group="hand", joint="wrist_rotation")
        arm.call("group_activate", group="arm", joint="shoulder_rotation")
    await shows(page, "Wrist rotation")
    await page.click(f"{HAND} [data-joint=gripper]")
    await shows(page, "Gripper")
    assert active(site) == "gripper"
    await page.click(f"{HAND} .groups-forward")
    await shows(page, "Wrist rotation")
    assert active(site) == "wrist_rotation"
    await page.click(f"{HAND} .groups-backward")
    await shows(page, "Gripper")
    await page.key("]")
    await page.until("bentod.frame.groups[0].active === 'elbow_flexion'")
    await page.key("[")
    await page.until("bentod.frame.groups[0].active === 'shoulder_rotation'")
    assert active(site, "arm") == "shoulder_rotation"
    assert not page.problems


async def test_a_push_moves_the_active_joint_for_as_long_as_it_is_held(page: Page, site: Lab) -> None:
    with site.arm() as arm:
        arm.call("group_activate", group="hand", joint="wrist_flexion")
    await shows(page, "Wrist flexion")
    bar = f"document.querySelector('{HAND} .groups-bar')"
    await page.eval("window.flexion = () => bentod.frame.joints.find(j => j.name === 'wrist_flexion')")
    for button, way, side in (("plus", 1, "+25%"), ("minus", -1, "−25%")):
        async with page.held(f"{HAND} .groups-{button}"):
            await page.until(f"flexion().sent?.velocity * {way} > 0.1")
            await page.until(
                f"document.querySelector('{HAND} .groups-effort').textContent === 'effort {side}'"
            )
            assert await page.eval(f"{bar}.ariaValueNow ?? {bar}.getAttribute('aria-valuenow')") == str(
                25 * way
            )
            driver = await page.eval(f"document.querySelector('{HAND} .groups-driver').textContent")
            assert driver.startswith("● driven by page")
            elbow = "bentod.frame.joints.find(j => j.name === 'elbow_flexion').sent.kind"
            assert await page.eval(elbow) == "stop"
        await page.until("flexion().sent?.kind === 'stop'")
        await page.until(f"document.querySelector('{HAND} .groups-driver').textContent.startsWith('○')")
    assert not page.problems


async def test_a_joint_that_is_paused_cannot_be_pushed_and_who_looks_changes_nothing(
    page: Page, looking: Page, site: Lab
) -> None:
    name = str(active(site))
    with site.arm() as arm:
        arm.call("pause", joints=name, on=True)
    await page.until(f"document.querySelector('{HAND} .groups-plus').disabled")
    assert not await page.eval(f"document.querySelector('{HAND} .groups-forward').disabled")
    held = await looking.until(f"[...document.querySelectorAll('{HAND} button')].map(b => b.disabled)")
    assert len(held) == 7
    assert all(held)
