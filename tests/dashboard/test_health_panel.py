"""Health on the page: lateness is counted, faults say what to do, and the way back is three buttons."""

import pytest

from tests.dashboard.frames import NAMES, Table, frame, script
from tests.dashboard.page import Page
from tests.dashboard.rig import Lab

pytestmark = pytest.mark.real_time

COSTS = ("read", "think", "write", "publish")

STILL = "bentod.link.handlers.frame = () => {}"
"""No frame arrives any more but those that a test feeds."""

SENTENCES = {
    "no answer for more than 0.5 s from any joint (0.53 s): The simulated cable is pulled.": "Cable",
    "no answer for more than 0.5 s from any joint (0.50 s): Serial port /dev/ttyUSB0: there is no device "
    "behind it; is the adapter plugged in? Reconnecting.": "Cable",
    "no answer for more than 0.5 s from any joint (0.50 s): No servo answers any more; check the power of "
    "the arm. Reconnecting.": "Power",
    "no answer for more than 0.5 s from elbow_flexion (0.50 s): check the cable and the servo's power": (
        "Servo silent"
    ),
    "wrist_rotation lost torque unasked: power or servo was reset": "Servo was reset",
    "shut down by itself: gripper (Overload Error, Torque Limit 0 after Alarm Shutdown)": "Overload",
    "shut down by itself: gripper (Overheating Error, Torque Limit 0 after Alarm Shutdown)": "Too hot",
    "too hot: gripper is at 70 °C (limp from 68 °C on); let it cool": "Too hot",
    "Input Voltage Error": "Supply voltage",
    "BUS Watchdog Error": "Watchdog",
    "Checksum Error": "Garbled messages",
    "torque could not be switched: Servo 2 (elbow_flexion) confirmed to switch its torque on and did not.": (
        "Torque was not confirmed"
    ),
    "internal error in the tick: MemoryError: ": "Error in the daemon",
    "The EMG source ended after sample 1189.": "Muscle signals ended",
    "No EMG sample for 0.07 s; the bound is 0.06 s.": "Muscle signals lost",
    "EMG channel 0 is stuck: of its newest 10 samples most are 1e-05 V.": "Electrode",
    "EMG is back; it moves nothing until every muscle has been at rest for 0.25 s.": "Muscles must rest",
    "5 ticks were missed: a tick began late, by 157.6 ms": "Late ticks",
    "a sentence that nobody has foreseen": "Fault",
}
"""What is said, and by which name the advice goes."""


async def test_latenesses_are_counted_in_bins_and_complaints_have_advice(looking: Page) -> None:
    counts = await looking.eval(
        "(() => { const found = new bentod.health.histogram.constructor(60);"
        "for (const late of [-1e-3, 5e-6, 1e-5, 1.7e-5, 1.9e-5, 1e-3, 0.0999, 0.1, 2]) found.add(late, 100);"
        "found.add(1e-3, 161); found.add(NaN, 161);"
        "return {all: found.all, recent: found.recent(), worst: found.worst,"
        " half: found.quantile(0.5), most: found.quantileOfAll(0.5)} })()"
    )
    expected = [0] * 18
    for place, count in {0: 2, 1: 2, 2: 1, 9: 2, 16: 1, 17: 2}.items():
        expected[place] = count
    assert counts["all"] == expected
    assert counts["recent"] == [0] * 9 + [1] + [0] * 8  # the others are older than a minute
    assert counts["worst"] == 2
    assert counts["half"] == 1e-3
    assert counts["most"] == pytest.approx(1e-5 * 10**0.5)  # the upper edge of the bin with the fifth
    names = await looking.eval(f"{script(list(SENTENCES))}.map((text) => bentod.health.adviceFor(text).name)")
    assert dict(zip(SENTENCES, names, strict=True)) == SENTENCES


async def test_faults_can_be_practised_and_three_buttons_lead_back(page: Page, site: Lab) -> None:
    await page.click("#tab-health")
    await page.eval("document.querySelector('.practice').open = true")
    await _explained(page, site)
    await page.fill(".practice-fault", "cable")
    await page.click(".practice-break")
    await page.until("bentod.frame.mode === 'fault'")
    await page.until("document.querySelector('.health-fault')?.innerText.includes('USB cable')")
    assert await page.eval("document.querySelectorAll('.health-fault.grave').length") == 1
    await page.click(".practice-mend")
    await page.until("bentod.frame.joints.every((joint) => joint.freshness === 'fresh')")
    await page.click(".health-clear")
    await page.until("bentod.frame.fault === '' && !document.querySelector('.health-release').disabled")
    assert site.state()["mode"] == "holding"
    await page.click(".health-release")
    await page.until("bentod.frame.mode === 'active'")
    await page.until("!document.querySelector('.health-fault.grave')")
    assert not page.problems


async def _explained(page: Page, site: Lab) -> None:
    """Every fault of the simulator says what it is like."""
    with site.arm() as arm:
        info = arm.call("get_info")
    assert isinstance(info, dict)
    told = await page.eval(
        "(() => { const select = document.querySelector('.practice-fault');"
        "return [...select.options].map(({value}) => { select.value = value;"
        "select.dispatchEvent(new Event('change'));"
        "return [value, document.querySelector('.practice-like').textContent] }) })()"
    )
    assert [fault for fault, _ in told] == info["faults"]
    assert not [fault for fault, text in told if "simulator's own" in text]
    assert all(text.startswith("“Break it” does this: ") and "What then helps: " in text for _, text in told)


async def test_servos_and_faults_are_told_with_units_and_words(looking: Page) -> None:
    await looking.click("#tab-health")
    await looking.until("document.querySelectorAll('.clients-table td').length > 0")
    assert "dashboard" in await looking.eval("document.querySelector('.clients-table').innerText")
    await looking.eval(STILL)
    joints: dict[str, Table] = {name: {"voltage": 12.0, "age": 0.0021} for name in NAMES}
    joints["elbow_flexion"] |= {"temperature": 65.0, "freshness": "lost", "age": 0.7}
    joints["gripper"] |= {"errors": ["Overload Error"], "voltage": 10.9}
    costs = {"read": 0.004, "think": 0.003, "write": 0.002, "publish": 0.001}
    told = frame(
        joints,
        time=5.0,
        tick=1,
        lateness=2e-4,
        missed=0,
        shed=0,
        costs=costs,
        emg={"problem": "", "effort": {}},
    )
    text = await looking.eval(
        f"new Promise((resolve) => setTimeout(() => {{ const told = {script(told)};"
        "for (let n = 0; n < 31; n++) bentod.feed({...told, time: 5 + n / 30});"
        "requestAnimationFrame(() => resolve(document.querySelector('.health').innerText)) }, 550))"
    )
    for words in (
        "Something is wrong",
        "Elbow flexion: servo silent for 0:01",
        "Gripper: overload",
        "✕ lost, 700.0 ms",
        "65 °C, warm",
        "10.9 V",
        "✓ fresh, 2.1 ms",
        "10 ms of 33 ms: 30%",
    ):
        assert words in text, f"{words}\n{text}"
    buttons = "[...document.querySelectorAll('.health-way button, .practice-break')]"
    assert await looking.eval(f"{buttons}.every((button) => button.disabled)")


async def test_missed_ticks_are_worth_a_look_and_without_a_daemon_nothing_is_known(looking: Page) -> None:
    await looking.click("#tab-health")
    await looking.eval(STILL)
    quiet = {"lateness": 0.0, "shed": 0, "tick": 1, "costs": dict.fromkeys(COSTS, 0.001)}
    told = frame({name: {"voltage": 12.0} for name in NAMES}, **quiet, missed=0)
    told["emg"]["effort"] = {}
    state = "document.querySelector('.health-state').textContent"
    feed = "bentod.feed({...%s, time: %f, missed: %d})"
    await looking.eval(feed % (script(told), 1e6, 3))
    await looking.until(f"{state}.includes('Nothing is wrong')")
    await looking.eval(feed % (script(told), 1e6 + 1, 112))
    await looking.until(f"{state}.startsWith('△')")
    listed = "document.querySelector('.health-fault:not(.grave) .health-text').textContent"
    assert await looking.eval(listed) == "Ticks missed in the last 60 s: 109."
    await looking.eval(feed % (script(told), 1e6 + 2, 113))
    await looking.until(f"{listed}.endsWith(' 110.')")
    await looking.eval("bentod._linked({page: true, daemon: false, why: 'silent'})")
    assert (await looking.eval(state)).startswith("? Nothing is known")
    assert await looking.eval("document.querySelector('.health-faults').hidden")
    await looking.eval(feed % (script(told), 1e6 + 70, 113))
    await looking.until(f"{state}.includes('Nothing is wrong')")
