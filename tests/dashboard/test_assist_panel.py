"""The assist on the page: each control does what it says, and what the assist does is told in words."""

import math
from collections.abc import Iterator

import pytest

from bentod.frames import Value
from tests.dashboard.page import Page
from tests.dashboard.rig import Lab, soon

pytestmark = pytest.mark.real_time

USUAL: dict[str, Value] = {
    "mode": "dpcc",
    "k": 0.025,
    "timescale": 20,
    "velocity_limit_rad_s": 10,
    "manual_after_toggle_s": 0.5,
}

ON = ".assist-switch"


@pytest.fixture(autouse=True)
def _usual(shared_lab: Lab) -> Iterator[None]:
    """What a test changes is as before for the next one."""
    yield
    with shared_lab.arm() as arm:
        arm.call("assist_set", **USUAL)


def settings(site: Lab) -> dict[str, Value]:
    """Of the assist, as the daemon has them."""
    with site.arm() as arm:
        told = arm.call("assist_get")
    assert isinstance(told, dict)
    return told


async def test_one_switch_is_off_and_on_again_as_before_and_parts_make_a_mode(page: Page, site: Lab) -> None:
    with site.arm() as arm:
        arm.call("assist_set", mode="dpcc_confident", options={"confidence": 0.7})
    await page.click("#tab-assist")
    await page.until("document.querySelector('.assist-follow')?.value === 'dpcc_confident'")
    assert await page.eval(f"document.querySelector('{ON}')?.ariaChecked") == "true"
    await page.click(ON)
    await soon(lambda: settings(site)["mode"] == "off")
    await page.until(f"document.querySelector('{ON}')?.textContent === 'Assist is off'")
    await page.until("document.querySelector('.assist-state')?.textContent === '○ Off'")
    await page.click(ON)
    await soon(lambda: settings(site)["mode"] == "dpcc_confident")
    assert settings(site)["options"] == {"confidence": 0.7}  # which the daemon itself forgets
    await page.click(".assist-mode input[value=adaptive_switching]")
    await soon(lambda: settings(site)["mode"] == "dpcc_confident+adaptive_switching")
    await page.until("document.querySelector('.assist-mode').innerText.includes('+adaptive_switching')")
    await page.fill(".assist-follow", "")
    await soon(lambda: settings(site)["mode"] == "adaptive_switching")


async def test_settings_are_given_in_the_units_of_the_screen(page: Page, site: Lab) -> None:
    await page.click("#tab-assist")
    await page.until("document.querySelector('.assist-velocity_limit_rad_s')?.value === '573'")
    await page.fill(".assist-velocity_limit_rad_s", "90")
    await soon(lambda: settings(site)["velocity_limit_rad_s"] == pytest.approx(math.pi / 2))
    await page.fill(".assist-velocity_limit_rad_s", "600")
    assert not await page.eval("document.querySelector('.assist-velocity_limit_rad_s').checkValidity()")
    await page.fill(".assist-manual_after_toggle_s", "1.5")
    await soon(lambda: settings(site)["manual_after_toggle_s"] == 1.5)
    assert settings(site)["velocity_limit_rad_s"] == pytest.approx(math.pi / 2)  # 600 °/s was never asked for
    await page.fill(".assist-velocity_limit_rad_s-slider", "1000")
    fastest = await page.eval("Math.max(...bentod.info.joints.map((one) => one.max_velocity_rad_s))")
    await soon(lambda: settings(site)["velocity_limit_rad_s"] == pytest.approx(2 * fastest, rel=0.01))
    await page.fill(".assist-timescale", "10")
    await soon(lambda: settings(site)["timescale"] == 10)
    await page.fill(".assist-k-slider", "1000")
    await soon(lambda: settings(site)["k"] == pytest.approx(0.9999, abs=1e-3))


async def test_good_and_bad_are_rewards(page: Page) -> None:
    await page.eval(
        "window.heard = []; bentod.onEvent((event) => heard.push([event.kind, event.data?.reward]))"
    )
    await page.click("#tab-assist")
    await page.click(".assist-good")
    await page.until("heard.some(([kind, reward]) => kind === 'reward' && reward === 1)")
    await page.click(".assist-bad")
    await page.until("heard.some(([kind, reward]) => kind === 'reward' && reward === -1)")
    assert not page.problems


async def test_an_observer_reads_what_the_assist_does_and_changes_nothing(looking: Page) -> None:
    await looking.click("#tab-assist")
    await looking.until("document.querySelector('.assist-velocity_limit_rad_s')?.value === '573'")
    await looking.eval("bentod.link.handlers.frame = () => {}")
    text = await looking.eval(
        "new Promise((resolve) => { const told = structuredClone(bentod.frame);"
        "Object.assign(told.assist, {mode: 'dpcc', engaged: true, moving: {elbow_flexion: -0.34906585},"
        "reason: 'Moves elbow_flexion to where the operator usually has it.', offers_together: true});"
        "bentod.feed(told);"
        "requestAnimationFrame(() => resolve(document.querySelector('.assist').innerText)) })"
    )
    for words in (
        "● Helping",
        "Moves elbow flexion to where the operator usually has it.",
        "Elbow flexion",
        "−20 °/s",
        "All joints together may be selected now",
    ):
        assert words in text, f"{words}\n{text}"
    controls = "[...document.querySelectorAll('.assist button, .assist input, .assist select')]"
    assert await looking.eval(f"{controls}.length > 8 && {controls}.every((control) => control.disabled)")
