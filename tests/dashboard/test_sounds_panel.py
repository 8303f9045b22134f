"""Sound in a real browser: what is said when, and what hums."""

import json

import pytest

from bentod.voice.tones import note
from tests.dashboard.page import Page
from tests.dashboard.rig import Lab
from tests.voice.scripted import cases

pytestmark = pytest.mark.real_time

ON = "#page-controls .sounds-controls button:nth-of-type(1)"
CUE = "#page-controls .sounds-controls button:nth-of-type(2)"
HEARD = "bentod.sounds.board.heard"


@pytest.fixture
def rested(site: Lab) -> Lab:
    """An arm of which the first joint is selected, before there is a page to hear of it."""
    with site.arm() as arm:
        arm.call("group_activate", group="arm", joint="shoulder_rotation")
    return site


@pytest.fixture
async def loud(rested: Lab, page: Page) -> Page:
    """The page with its sound switched on, as a person does it."""
    await page.click("#tab-controls")
    await page.click(ON)
    await page.until("bentod.sounds.board.context?.state === 'running'")
    return page


async def test_the_page_tells_what_the_voice_tells_of_the_same_frames(page: Page) -> None:
    for case in cases():
        steps = json.dumps([(step.time, step.what, step.value) for step in case.steps])
        heard = await page.eval(f"bentod.sounds.rehearse({steps})")
        assert heard == [[step.due, step.selected] for step in case.steps], case.name
    pitches = await page.eval("Array.from({length: 32}, (_, index) => bentod.sounds.note(index))")
    assert pitches == pytest.approx([note(index) for index in range(32)])


async def test_before_it_is_switched_on_the_page_is_silent(page: Page, site: Lab) -> None:
    with site.arm() as arm:
        arm.call("group_toggle", group="arm")
    await page.click("#tab-controls")
    assert await page.eval("bentod.sounds.board.context") is None
    assert await page.eval(f"document.querySelector('{ON}').textContent") == "Sound: off"
    assert await page.eval(HEARD) == []


async def test_a_joint_that_is_selected_is_told_and_a_pause_too(loud: Page, site: Lab) -> None:
    with site.arm() as arm:
        arm.call("group_activate", group="arm", joint="elbow_flexion")
        await loud.until(f"{HEARD}.at(-1) === 'joint.elbow_flexion'")
        arm.call("stop")
        await loud.until(f"{HEARD}.at(-1) === 'stop'")
    await loud.until("document.querySelector('.sounds-last').textContent === 'Last: Stop.'")
    assert not loud.problems


async def test_the_quiet_tone_tells_the_joint_and_ends_with_a_pause_or_a_hidden_page(
    loud: Page, site: Lab
) -> None:
    await loud.eval(
        "window.ear = bentod.sounds.board.context.createAnalyser(); bentod.sounds.board.output.connect(ear);"
        "window.loudness = () => { const a = new Float32Array(2048); ear.getFloatTimeDomainData(a);"
        "return Math.max(...a.map(Math.abs)) }; 0"
    )
    assert await loud.eval("bentod.sounds.board.level") == 0
    await loud.click(CUE)
    await loud.until("bentod.sounds.board.level === 0.03 && loudness() > 0.01")
    assert await loud.eval("loudness()") < 0.035
    await loud.hide()
    await loud.until("bentod.sounds.board.level === 0 && loudness() < 0.0005")
    await loud.hide(False)
    await loud.until("loudness() > 0.01")
    with site.arm() as arm:
        arm.call("pause")
        await loud.until("bentod.sounds.board.level === 0")
    assert not loud.problems


async def test_every_sound_can_be_tried_and_the_switch_is_remembered(loud: Page) -> None:
    await loud.click("#page-controls details:has(.sounds-list) summary")
    await loud.click("[data-event='mark.contact'] button")
    await loud.until(f"{HEARD}.includes('mark.contact')")
    assert await loud.eval("document.querySelectorAll('.sounds-list li').length") > 20
    assert await loud.eval("localStorage.getItem('bentod.sound.on')") == "true"
    await loud.click(ON)
    await loud.until("bentod.sounds.board.context === null")
    assert not loud.problems
