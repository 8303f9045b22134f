"""The session's panel: what is recorded, marked and noted is what the daemon is told."""

from pathlib import Path

import pytest

from bentod.record.reader import Recording
from tests.dashboard.page import Page
from tests.dashboard.rig import Lab
from tests.rig import table

pytestmark = pytest.mark.real_time

START, END = ".session-start", ".session-end"


def recording(site: Lab) -> dict[str, object]:
    with site.arm() as arm:
        return dict(table(arm.call("get_recording")))


async def session(page: Page) -> Page:
    await page.click("#tab-session")
    return page


async def test_a_recording_is_ended_on_the_second_press_and_another_begun(page: Page, site: Lab) -> None:
    await session(page)
    await page.until("document.querySelector('.session-state').textContent === '● Recording'")
    first = recording(site)["file"]
    await page.click(END)
    assert recording(site)["recording"] is True
    await page.click(END)
    await page.until(
        "document.querySelector('.session-state').textContent.startsWith('■ Nothing is recorded')"
    )
    assert recording(site)["recording"] is False
    await page.fill(".session [aria-label='Note for the next file']", "after the break")
    await page.click(START)
    await page.until("document.querySelector('.session-state').textContent === '● Recording'")
    now = recording(site)
    assert (now["recording"], now["note"]) == (True, "after the break")
    assert now["file"] != first
    assert Path(str(now["file"])).name in await page.text()
    with Recording(Path(str(first))) as whole:
        assert whole.info.complete


async def test_trials_marks_and_notes_reach_the_arm_and_its_events_are_listed(page: Page, site: Lab) -> None:
    await session(page)
    await page.fill(".session-trial input", "maze <b>1</b>")
    await page.fill(".session-trial label:nth-of-type(2) input", "dpcc")
    await page.click(".session-trial [type=submit]")
    await page.until(
        "bentod.frame.trial?.name === 'maze <b>1</b>' && bentod.frame.trial.condition === 'dpcc'"
    )
    await page.until("document.querySelector('.session-time').textContent.startsWith('running for 0:0')")
    await page.click(".session-mark[aria-label='Mark contact']")
    await page.until("document.querySelector('.events-text')?.textContent.endsWith('marked: contact')")
    await page.click(".session-trial-stop")
    await page.until("bentod.frame.trial === null")
    await page.fill(".session-mark-form input", "door opened")
    await page.click(".session-mark-form [type=submit]")
    await page.until("document.querySelector('.events-text').textContent.endsWith('marked: door opened')")
    await page.fill(".session-meta-row:nth-child(1) input:nth-child(2)", "P07")
    await page.fill(".session-meta-row:nth-child(2) input:nth-child(2)", "3")
    await page.click(".session-meta [type=submit]")
    await page.until("bentod.frame.meta?.participant === 'P07' && bentod.frame.meta.session === 3")
    await page.eval(
        "Object.assign(document.querySelector('[aria-label=\"Kind of events\"]'), {value: 'mark'})"
        ".dispatchEvent(new Event('change'))"
    )
    assert await page.eval("document.querySelectorAll('.events-list li').length") == 1


async def test_of_a_thousand_events_the_newest_500_are_kept(page: Page) -> None:
    await session(page)
    await page.eval(
        "for (let n = 0; n < 1000; n++)"
        "bentod._emit('event', {time: n, kind: 'flood', text: `n ${n}`, data: {}})"
    )
    assert await page.eval("document.querySelectorAll('.events-list li').length") == 500
    assert "n 999" in str(await page.eval("document.querySelector('.events-list li').textContent"))


async def test_an_observer_sees_the_recording_and_changes_nothing(looking: Page) -> None:
    await session(looking)
    await looking.until("document.querySelector('.session-state').textContent === '● Recording'")
    fields = "[...document.querySelectorAll('.session form *, .session-mark, .session-start, .session-end')]"
    assert await looking.eval(f"{fields}.filter((e) => 'disabled' in e).every((e) => e.disabled)")
