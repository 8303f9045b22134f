"""The page: what its server costs with many browsers, how soon it shows the arm, how soon STOP stops it.

Everything on this machine: a daemon at 30 Hz with a simulated arm and eight channels of 1 kHz, the page's
server, browsers without a picture in a process of their own, and one real Chromium. Crowds take turns.
SECONDS: of each turn; ROUNDS: of turns; CLICKS: on STOP.
"""

import asyncio
import os
import statistics
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from bentod.dashboard.assets import read_assets
from bentod.frames import Value
from bentod.lateness.histogram import percentile
from tests.benchmarks.harness import Row, at_most, main
from tests.dashboard.chromium import Browser, chromium
from tests.dashboard.page import Page
from tests.dashboard.rig import Lab, lab, opened
from tests.rig import CONFIGS, number

BROWSERS = (0, 1, 3, 20)
SECONDS = float(os.environ.get("SECONDS", "5"))
ROUNDS = int(os.environ.get("ROUNDS", "5"))
CLICKS = int(os.environ.get("CLICKS", "100"))
LOADS = 7
CHANNELS, EMG_HZ = 8, 1000
TICK = 1 / 30

PUSH = "bentod.hold('bench', 'move', {joint: 'wrist_flexion', velocity: 0.05})"


def config(folder: Path) -> Path:
    """The shipped simulation, with eight channels of muscles at rest, at 1 kHz."""
    noise = np.random.default_rng(1).normal(0, 1e-6, (60 * EMG_HZ, CHANNELS)).astype(np.float32)
    np.savez(folder / "rest.npz", emg=noise, rate_hz=EMG_HZ)
    text = (CONFIGS / "sim.toml").read_text()
    text = text.replace("rate_hz = 200", f"rate_hz = {EMG_HZ}").replace(
        "channel = 2", f"channel = {CHANNELS - 1}"
    )
    text = text.replace('name = "synthetic"', f'name = "replay"\nfile = "{folder}/rest.npz"\nloop = true\n#')
    text = text.replace("seed = 1\n\n[[emg.sites]]", "\n[[emg.sites]]", 1)
    (folder / "bench.toml").write_text(text)
    return folder / "bench.toml"


@contextmanager
def looking(url: str, browsers: int) -> Iterator[None]:
    """So many browsers look while this is entered."""
    command = [sys.executable, "-m", "tests.benchmarks.rigs.browsers", url, str(browsers)]
    with subprocess.Popen(command, stdin=subprocess.PIPE) as process:
        try:
            time.sleep(1.0)
            yield
        finally:
            if process.stdin:
                process.stdin.close()
            process.wait(10)


def used(process: int) -> float:
    """Processor time of a process so far (s)."""
    fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def resident(process: int) -> float:
    """Memory of a process (MB)."""
    pages = int(Path(f"/proc/{process}/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


def turn(site: Lab, browsers: int) -> tuple[float, list[float]]:
    """Share of a core that the server takes, and how late ticks began (s)."""
    (server,) = site.workers()
    with looking(site.operator, browsers), site.arm() as arm:
        arm.call("subscribe", topic="state", rate_hz=30.0)
        began, before, late = time.monotonic(), used(server), []
        for notification in arm.notifications():
            late += [number(frame, "lateness") for frame in _frames(notification.params)]
            if time.monotonic() - began > SECONDS:
                break
        return (used(server) - before) / (time.monotonic() - began), late


def _frames(params: Value) -> list[dict[str, Value]]:
    return [frame for frame in params if isinstance(frame, dict)] if isinstance(params, list) else []


def crowds(site: Lab) -> list[Row]:
    """With more and more browsers."""
    shares: dict[int, list[float]] = {count: [] for count in BROWSERS}
    late: dict[int, list[float]] = {count: [] for count in BROWSERS}
    for round_ in range(ROUNDS):
        for count in (*BROWSERS[round_ % 4 :], *BROWSERS[: round_ % 4]):
            share, ticks = turn(site, count)
            shares[count].append(share)
            late[count] += ticks
    rows = [
        Row(f"server, {n} browsers", 100 * statistics.median(shares[n]), "% of a core") for n in BROWSERS[:-1]
    ]
    most = BROWSERS[-1]
    rows.append(at_most(f"server, {most} browsers", 100 * statistics.median(shares[most]), "% of a core", 3))
    rows.append(Row("server, memory after that", resident(site.workers()[0]), "MB"))
    slow = {count: percentile(ticks, 99) for count, ticks in late.items()}
    rows += [Row(f"lateness of ticks p99, {count} browsers", 1e3 * slow[count], "ms") for count in (0, most)]
    return [*rows, at_most(f"lateness p99, {most} browsers / none", slow[most] / slow[0], "ratio", 1.1)]


async def loads(browser: Browser, site: Lab) -> list[Row]:
    """What a browser loads, and how soon something is seen."""
    paints, shown, foreign = [], [], 0
    for _ in range(LOADS):
        page = await opened(await browser.page(), site.operator)
        paints.append(
            await page.until("performance.getEntriesByName('first-contentful-paint')[0]?.startTime")
        )
        shown.append(await page.until("performance.getEntriesByName('shown')[0]?.startTime"))
        foreign += sum(
            site.place not in url and not url.startswith(("data:", "blob:")) for url in page.requests
        )
        await page.goto("about:blank")
    files = [asset for url, asset in read_assets().items() if url not in ("/", "/licences.txt")]
    return [
        at_most("first paint", statistics.median(paints), "ms", 1000),
        Row("the arm is shown", statistics.median(shown), "ms"),
        at_most("page", sum(len(asset.body) for asset in files) / 1e3, "kB", 800),
        Row("page, as it is sent", sum(len(asset.zipped) for asset in files) / 1e3, "kB"),
        at_most("requests to others", foreign, "", 0),
    ]


async def stops(page: Page, site: Lab) -> list[Row]:
    """From a click on STOP to the order that the servos get."""
    took: list[float] = []
    x, y = await page.place("#stop")
    with site.arm() as arm:
        for _ in range(CLICKS):
            arm.call("pause", on=False)
            await page.until("bentod.frame.mode === 'active'")
            await asyncio.sleep(float(np.random.default_rng(len(took)).uniform(0, TICK)))
            clicked = time.monotonic()
            await page.mouse("mousePressed", x, y)
            await page.mouse("mouseReleased", x, y)
            took.append(await _written(page) - clicked)
    return [
        Row("click on STOP to the servos' order, median", statistics.median(took) / TICK, "ticks"),
        at_most("click on STOP to the servos' order, p99", percentile(took, 99) / TICK, "ticks", 2),
    ]


async def _written(page: Page) -> float:
    """When the first frame of a paused arm had been written to the servos (monotonic s)."""
    await page.until("bentod.firstPaused !== undefined")
    frame = await page.eval(
        "(() => { const f = bentod.firstPaused; bentod.firstPaused = undefined; return f })()"
    )
    costs = frame["costs"]
    return float(frame["time"] + frame["lateness"] + costs["read"] + costs["think"] + costs["write"])


WATCH = """
bentod.onTick((frame) => {
  if (frame.mode === 'paused' && bentod.before === 'active') bentod.firstPaused = frame;
  bentod.before = frame.mode;
  const held = frame.joints.some((joint) => joint.holder.startsWith('client:page'));
  if (!held && bentod.held) bentod.letGo = frame;
  bentod.held = held;
})
"""


async def ends(page: Page, site: Lab, how: str, times: int = 20) -> list[float]:
    """How long (s) after what ends a held motion the first tick without it came."""
    took = []
    for _ in range(times):
        await page.hide(False)
        while not await page.eval("bentod.held"):
            await page.eval(f"bentod.motion.keys.length || {PUSH}")
            await asyncio.sleep(0.02)
        await asyncio.sleep(0.2)
        await page.eval("bentod.letGo = undefined")
        began = time.monotonic()
        if how == "hidden":
            await page.hide()
        else:
            await page.eval("(() => { const t = Date.now(); while (Date.now() - t < 600); })()")
        await page.until("bentod.letGo !== undefined || !bentod.held")
        took.append(float(await page.eval("bentod.letGo?.time ?? 0")) - began)
    return [max(0.0, value) for value in took]


async def motions(page: Page, site: Lab) -> list[Row]:
    """How long a held motion goes on after the page is hidden, or hangs."""
    rows = []
    site.calm()
    for how in ("hidden", "hanging"):
        took = await ends(page, site, how)
        rows.append(
            at_most(f"motion ends after a {how} page, worst of {len(took)}", 1e3 * max(took), "ms", 200)
        )
    return rows


async def pages(site: Lab, folder: Path) -> list[Row]:
    """Everything that a real browser is needed for."""
    with chromium(folder) as address:
        async with Browser.at(address) as browser:
            rows = await loads(browser, site)
            site.calm()
            page = await opened(await browser.page(), site.operator)
            await page.eval(WATCH)
            return [*rows, *await stops(page, site), *await motions(page, site)]


def run() -> list[Row]:
    """All rows."""
    with TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "chromium").mkdir()
        with lab(folder, config(folder)) as site:
            site.calm()
            return [*crowds(site), *asyncio.run(pages(site, folder / "chromium"))]


if __name__ == "__main__":
    main("dashboard", run())
