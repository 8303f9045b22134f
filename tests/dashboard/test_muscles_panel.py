"""Muscles on the page: the charts tell the truth, and what is set there is what the daemon obeys."""

import itertools
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from tests.dashboard.chromium import Browser
from tests.dashboard.page import Page
from tests.dashboard.rig import Lab, lab, opened
from tests.rig import CONFIGS, Table, number, table, tables
from tests.system.processes import eventually

pytestmark = pytest.mark.real_time

RATE_HZ = 1000
AMPLITUDE, GAIN = 40e-6, 2.0
"""V before gain, and the gain: the chart shows ±80 µV."""

CHART = '[data-site="flexor"] .stripchart'
LINE = f"{CHART}-threshold"
HEAR = "document.querySelector('.muscles').charts"


def signals(file: Path) -> None:
    """A sine of 25 Hz, a ramp of 1 s, and next to nothing."""
    time = np.arange(2 * RATE_HZ) / RATE_HZ
    ramp = 50e-6 * (time % 1.0)
    channels = [AMPLITUDE * np.sin(2 * np.pi * 25 * time), ramp, 1e-6 * np.sin(2 * np.pi * 100 * time)]
    np.savez(file, emg=np.stack(channels, axis=1), fs=RATE_HZ)


@pytest.fixture(scope="module")
def played(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Lab]:
    """An arm whose wearer gives known signals."""
    folder = tmp_path_factory.mktemp("played")
    signals(folder / "known.npz")
    text = (CONFIGS / "sim.toml").read_text()
    for old, new in (
        ('"sim-dynamixel"', '"sim"'),
        ("rate_hz = 200\nwindow = 10 ", f"rate_hz = {RATE_HZ}\nwindow = 200 "),
        ('name = "synthetic"', f'name = "replay"\nfile = "{folder / "known.npz"}"'),
        ("seed = 1\n\n[[emg.sites]]", "\n[[emg.sites]]"),
        ("channel = 0\nthreshold_v = 10e-6 ", f"channel = 0\ngain = {GAIN}\nthreshold_v = 20e-6 "),
        ("max_v = 30e-6               # ... and", "max_v = 100e-6               # ... and"),
    ):
        assert old in text, old
        text = text.replace(old, new)
    (folder / "arm.toml").write_text(text)
    with lab(folder, folder / "arm.toml") as found:
        yield found


@pytest.fixture
async def muscles(browser: Browser, played: Lab) -> Page:
    """The page with the muscles in sight."""
    played.calm()
    page = await opened(await browser.page(), played.operator)
    await page.click("#tab-muscles")
    await page.place(CHART)
    await page.until(f"document.querySelector('{CHART}').chart.bins")
    return page


def flexor(site: Lab) -> Table:
    """What the daemon has of that site."""
    with site.arm() as arm:
        return tables(table(arm.call("emg_get")), "sites")[0]


async def test_a_chart_shows_a_known_signal_its_level_and_gaps_in_volts_after_gain(muscles: Page) -> None:
    chart = f"document.querySelector('{CHART}').chart"
    await muscles.eval("document.querySelector('#muscles-span').value = 2")
    await muscles.eval("document.querySelector('#muscles-span').dispatchEvent(new Event('input'))")
    await muscles.until(f"{chart}.span === 2 && {chart}.bins.high.slice(-300).every(v => v > -1)")
    await muscles.until(f"{chart}.bins.level.slice(-20).every(v => v > 0)")
    high, low, level, top = await muscles.eval(
        f"(() => {{ const c = {chart}; const newest = [...c.bins.high].slice(-300);"
        "const ratio = devicePixelRatio, {data, width} = c.plot.ctx.getImageData("
        "0, 0, c.plot.ctx.canvas.width, c.plot.ctx.canvas.height);"
        "const blue = i => data[i + 2] > data[i] + 60 && data[i + 3] > 60;"
        "let at = 0; while (at < data.length && !blue(at)) at += 4;"
        "return [Math.max(...newest), Math.min(...[...c.bins.low].slice(-300)), c.bins.level.at(-1),"
        "c.toVolts(Math.floor(at / 4 / width) / ratio)] })()"
    )
    assert high == pytest.approx(AMPLITUDE * GAIN, rel=0.01)
    assert low == pytest.approx(-AMPLITUDE * GAIN, rel=0.01)
    assert level == pytest.approx(AMPLITUDE * GAIN * 2 / np.pi, rel=0.02)
    assert top == pytest.approx(AMPLITUDE * GAIN, rel=0.05)  # of pixels
    other = '[data-site="extensor"] .stripchart'
    await muscles.place(other)
    newest = f"[...document.querySelector('{other}').chart.bins?.high ?? [NaN]].slice(-200)"
    ramp = await muscles.until(f"(v => v.every(Number.isFinite) && v)({newest})")
    assert max(ramp) <= 50e-6 * 1.001
    assert sum(a <= b for a, b in itertools.pairwise(ramp)) >= len(ramp) - 2
    await muscles.place(CHART)
    await _gap(muscles, chart)
    assert not muscles.problems


async def _gap(muscles: Page, chart: str) -> None:
    """What never came is a gap in the chart, and not a line."""
    await muscles.until(f"{chart}.bins.high.slice(-300).every(v => v === v)")
    await muscles.eval("bentod.link.handlers.frame = () => {}")
    await muscles.eval(
        f"(() => {{ const from = {HEAR}.ring.next + 500, ones = new Float32Array(300).fill(1e-5);"
        "bentod.feed(bentod.frame, [[from, 0, 0, 3, new Uint8Array(ones.buffer)]]); })()"
    )
    await muscles.until(f"Math.abs({chart}.bins.high.at(-1) - 2e-5) < 1e-9")
    known = await muscles.eval(f"[...{chart}.bins.high].slice(-300).map(v => v === v)")
    width = await muscles.eval(f"{chart}.bins.width")
    assert known[-1]
    assert known[0]
    assert 500 / width - 2 <= known.count(False) <= 500 / width
    assert "".join(map(str, map(int, known))).strip("1").strip("0") == ""  # one gap, and only one
    assert await muscles.eval(f"{HEAR}.missing >= 500")


async def test_a_line_that_is_dragged_changes_the_daemons_threshold(muscles: Page, played: Lab) -> None:
    with played.arm() as arm:
        arm.call("emg_set", site="flexor", threshold_v=20e-6, max_v=100e-6)
    chart = f"document.querySelector('{CHART}').chart"
    await muscles.until(f"Math.abs(Number(document.querySelector('{LINE}').ariaValueNow) - 20e-6) < 1e-9")
    wanted = await muscles.eval(f"{chart}.toVolts({chart}.toPixel(20e-6) - 24)")
    await muscles.drag(LINE, 0, -24)
    eventually(lambda: flexor(played)["threshold_v"] != 20e-6)
    set_to = number(flexor(played), "threshold_v")
    assert set_to == pytest.approx(wanted, rel=0.03)
    await muscles.until(f"!document.querySelector('{LINE}').classList.contains('pending')")
    field = "document.querySelector('[data-site=flexor] [data-key=threshold_v]').value"
    assert float(await muscles.eval(field)) == pytest.approx(set_to * 1e6)
    step = await muscles.eval(f"{chart}.range.high / 100")
    await muscles.eval(f"document.querySelector('{LINE}').focus()")
    await muscles.key("ArrowDown")
    eventually(lambda: flexor(played)["threshold_v"] == pytest.approx(set_to - step, rel=0.01))
    await muscles.drag(LINE, 0, -300)  # beyond the maximum
    eventually(lambda: flexor(played)["threshold_v"] == pytest.approx(100e-6, rel=0.01))
    assert number(flexor(played), "threshold_v") < 100e-6
    assert not muscles.problems


async def test_numbers_that_are_typed_count_and_what_is_refused_falls_back(
    muscles: Page, played: Lab
) -> None:
    await muscles.fill("[data-site=flexor] [data-key=max_v]", "150")
    eventually(lambda: flexor(played)["max_v"] == pytest.approx(150e-6))
    await muscles.fill("[data-site=flexor] [data-key=max_v]", "100")
    await muscles.fill("[data-site=flexor] [data-key=gain]", "-1")
    eventually(lambda: flexor(played)["max_v"] == pytest.approx(100e-6))
    assert flexor(played)["gain"] == GAIN
    settings = f"{HEAR}.settings"
    await muscles.eval(f"{settings}.set('flexor', {{threshold_v: 1}})")
    await muscles.until("document.querySelector('.notice.error')?.textContent.includes('must be above')")
    assert await muscles.eval(f"{settings}.values('flexor').threshold_v") < 100e-6


async def test_one_big_button_says_whether_muscles_drive_and_a_frozen_chart_stands_still(
    muscles: Page, played: Lab
) -> None:
    def paused() -> object:
        with played.arm() as arm:
            return table(arm.call("emg_get"))["paused"]

    await muscles.until("document.querySelector('.muscles-state').textContent.includes('Paused')")
    await muscles.click("#muscles-drive")
    eventually(lambda: paused() is False)
    await muscles.until("document.querySelector('.muscles-state').textContent.includes('drive the arm')")
    await muscles.key("m")
    eventually(lambda: paused() is True)
    await muscles.click("#muscles-freeze")
    await muscles.until("document.querySelector('#muscles-freeze').ariaPressed === 'true'")
    still = f"[...document.querySelector('{CHART}').chart.bins.high].join()"
    seen, at = await muscles.eval(still), await muscles.eval(f"{HEAR}.ring.next")
    await muscles.until(f"{HEAR}.ring.next > {at} + 100")
    assert await muscles.eval(still) == seen
    assert not muscles.problems


async def test_the_wizard_measures_a_wearer_and_sets_what_was_found(browser: Browser, tmp_path: Path) -> None:
    text = (CONFIGS / "patterns.toml").read_text().replace('"sim-dynamixel"', '"sim"')
    text = text.replace(
        "rate_hz = 30", "rate_hz = 60"
    )  # a busy machine leaves out ticks, and looks with them
    (tmp_path / "arm.toml").write_text(text.partition("# What is learned")[0])
    with lab(tmp_path, tmp_path / "arm.toml") as site:
        page = await opened(await browser.page(), site.operator)
        await page.click("#tab-muscles")
        await page.click(".calibration summary")
        await page.until("document.querySelectorAll('#calibration-site option').length === 9")
        await page.eval("document.querySelector('#calibration-site').value = 'electrode_0'")
        for name, seconds in (("ready", "0"), ("rest", "2"), ("hold", "2.5")):
            await page.fill(f"#calibration-{name}", seconds)
        with site.arm() as arm:
            arm.call("emg_prompt", label="rest")
            await page.click("#calibration-start")
            await page.until("document.querySelector('.calibration-asked').textContent.includes('Relax')")
            assert table(arm.call("emg_get"))["paused"] is True
            await page.until("bentod.told.calibration?.site === 'electrode_0'")
            arm.call("emg_prompt", label="wrist_flexion")
            await page.until("bentod.told.calibration.phase === 'found'")
            arm.call("emg_prompt", label="rest")
            before = tables(table(arm.call("emg_get")), "sites")[0]
            assert (before["threshold_v"], before["max_v"]) == (20e-6, 300e-6)
            await page.until("!document.querySelector('#calibration-use').disabled")
            await page.click("#calibration-use")
            await page.until(
                "document.querySelector('.calibration-done').textContent.includes('electrode 0')"
            )
            after = tables(table(arm.call("emg_get")), "sites")[0]
            assert number(after, "max_v") > 2 * number(after, "threshold_v")
            assert after["threshold_v"] != before["threshold_v"]
            lines = await page.eval("document.querySelector('.calibration-lines').textContent")
            assert f"threshold_v = {number(after, 'threshold_v'):g}" in lines
            assert table(arm.call("emg_get"))["paused"] is False
            await page.click("#calibration-undo")
            eventually(lambda: tables(table(arm.call("emg_get")), "sites")[0] == before)
        assert await page.eval("document.querySelector('.recognition-reason').textContent") != ""
        assert "Train first" in await page.eval("document.querySelector('.recognition-decision').textContent")
        assert await page.eval("document.querySelector('#recognition-train').checkVisibility()")
        assert not page.problems
