"""Learners on the page: predictions against what came, and thousands of questions in few rows."""

import pytest

from bentod.blocking import BlockingClient
from tests.dashboard.page import Page
from tests.dashboard.rig import Lab

pytestmark = pytest.mark.real_time

STILL = "bentod.link.handlers.frame = () => {}; bentod.call = () => new Promise(() => {})"
"""Nothing arrives any more but what a test feeds."""

RAMP = """(() => {
    const {chart} = bentod.learners;
    const base = structuredClone(bentod.frame);
    for (let n = 0; n < 200; n++) {
        if (n === 50) continue;
        base.time = (1000 + n) / 30;
        base.rate_hz = 30;
        base.learn.older = n === 60 ? {'gripper.position@20': 1} : {};
        base.learn.error = {'gripper.position@20': 0.02};
        const joint = base.joints[4];
        joint.freshness = n === 70 ? 'stale' : 'fresh';
        joint.position = 0.001 * n;
        joint.predictions = {'20': 0.001 * (n + 20)};
        bentod.feed(structuredClone(base));
        if (n === 0) {
            chart.joint.value = 'gripper';
            chart.timescale.value = '20';
            chart.joint.dispatchEvent(new Event('change'));
        }
    }
    return chart.columns();
})()"""


async def test_a_prediction_stands_where_what_it_is_about_came(page: Page) -> None:
    await page.eval(STILL)
    seconds, came, expected, low, high = await page.eval(RAMP)
    degree = 180 / 3.141592653589793
    assert seconds[0] == -20
    assert seconds[-1] == pytest.approx(20 / 30)  # as far as the newest prediction
    now = seconds.index(0)
    for place in range(now - 199, now + 21):
        n = place - now + 199
        angle = pytest.approx(0.001 * n * degree, abs=1e-9)
        assert came[place] == (None if n in (50, 70) or n > 199 else angle), n
        unknown = n < 20 or n - 20 in (50, 60)  # a tick that was missed, and a prediction from an earlier one
        assert expected[place] == (None if unknown else angle), n
        if not unknown:
            assert high[place] - expected[place] == pytest.approx(0.02 * degree)
            assert expected[place] - low[place] == pytest.approx(0.02 * degree)


async def test_thousands_of_questions_are_few_rows_to_be_found_and_sorted(page: Page) -> None:
    await page.eval(STILL)
    await page.click("#tab-learning")
    await page.eval(
        "bentod.learners.table.take(Array.from({length: 2000}, (_, n) => ({name: `question.${n}`,"
        "scaled: true, cumulant: 'elbow_flexion.velocity', gamma: 0.95,"
        "representation: n === 1234 ? 'needle' : 'body',"
        "policy: '', algorithm: 'td', prediction: n / 1000, surprise: (n * 7) % 2000, confidence: 0.5,"
        "error: null})))"
    )
    row = "document.querySelector('.learners-row .learners-name').textContent"
    rows = "document.querySelectorAll('.learners-row').length"
    assert 5 < await page.eval(rows) < 60
    await page.eval("document.querySelector('.learners-window').scrollTop = 1e9")
    await page.until("document.querySelector('.learners-table').innerText.includes('question.1999')")
    assert await page.eval(rows) < 60
    await page.eval("document.querySelector('.learners-window').scrollTop = 0")
    await page.click("[data-key=surprise] button")
    await page.until(f"{row} === 'question.857'")  # 7 · 857 = 5999 = 1999 modulo 2000
    await page.click("[data-key=surprise] button")
    await page.until(f"{row} === 'question.0'")
    await page.fill(".learners-filter", "needle velocity")
    assert await page.eval(rows) == 1
    text = await page.eval("document.querySelector('.learners-row').innerText")
    for words in ("question.1234", "elbow flexion, velocity, 0.67 s ahead", "71 °/s", "50%", "638.00"):
        assert words in text, f"{words}\n{text}"


async def test_a_question_about_a_muscle_is_listed_and_drawn(page: Page, site: Lab) -> None:
    with site.arm() as arm:
        arm.call("gvf_add", gvf={"name": "soon.flexor", "cumulant": "emg.flexor", "timescale": 5})
        try:
            await _drawn(page, arm)
        finally:
            arm.call("gvf_remove", name="soon.flexor")


async def _drawn(page: Page, arm: BlockingClient) -> None:
    told = arm.call("gvf_list")
    assert isinstance(told, list)
    await page.click("#tab-learning")
    await page.until(
        "[...document.querySelectorAll('.learners-name')].some((name) => name.textContent === 'soon.flexor')"
    )
    assert await page.eval("bentod.learners.table.gvfs.map(({name}) => name)") == [
        gvf["name"] for gvf in told if isinstance(gvf, dict)
    ]
    await page.eval(
        "[...document.querySelectorAll('.learners-name')]"
        ".find((one) => one.textContent === 'soon.flexor').click()"
    )
    await page.until(
        "document.querySelector('.outcome-words').textContent.startsWith('Emg, flexor: the solid line')"
    )
    await page.until("document.querySelector('.outcome-chart canvas')?.width > 100")
    await page.until("/Predicted next: \\d+%/.test(document.querySelector('.outcome-now').textContent)")
    words = await page.eval(
        "(bentod.learners.chart.error = NaN, bentod.learners.chart.draw(),"
        " document.querySelector('.outcome-now').textContent)"
    )
    assert "give or take" not in words
    assert not page.problems
