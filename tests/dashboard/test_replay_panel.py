"""The page on a recording: it says that no arm moves, and has the keys of a player."""

import asyncio
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from bentod.blocking import BlockingClient
from bentod.config_tables import Record
from sim.clock import run
from tests.dashboard.chromium import Browser
from tests.rig import PLAIN, Table, number, quiet_config, running, table
from tests.system.processes import BENTOD, environment, eventually, started

pytestmark = pytest.mark.real_time

PLAY, PLACE = ".replay-play", ".replay-place"


async def _record(folder: Path) -> None:
    """12 s of an arm that nobody moves."""
    config = quiet_config(PLAIN).model_copy(update={"record": Record(folder=folder / "recordings")})
    async with running(config, folder / "live.sock"):
        await asyncio.sleep(12)


@pytest.fixture
def replay(tmp_path: Path) -> Iterator[tuple[Path, str]]:
    """The socket of a recording that stands still, and the address of its page."""
    run(_record(tmp_path))
    socket, said = tmp_path / "replay.sock", tmp_path / "said"
    own = environment(tmp_path, XDG_CONFIG_HOME=str(tmp_path))
    play = [*BENTOD, "replay", str(tmp_path / "recordings"), "--socket", str(socket), "--stay", "--paused"]
    with started(play, own, subprocess.DEVNULL), said.open("wb") as output:
        eventually(socket.exists)
        with started([*BENTOD, "dashboard", "--socket", str(socket)], own, output) as server:
            eventually(lambda: "To look only" in said.read_text())
            yield socket, said.read_text().partition("The page is at")[2].split()[0]
            server.terminate()
            server.wait()


def player(socket: Path) -> Table:
    with BlockingClient(socket) as arm:
        return table(arm.call("replay_get"))


async def test_a_replay_is_played_sought_and_told_apart_from_an_arm(
    browser: Browser, replay: tuple[Path, str]
) -> None:
    socket, address = replay
    page = await browser.page()
    await page.goto(address)
    await page.until("!!document.querySelector('#stop')")
    with BlockingClient(socket) as arm:
        arm.call("replay_seek", 1.0)
    await page.until("!!bentod.frame")
    await page.click("#tab-session")
    await page.until("document.body.innerText.includes('This is a replay. No arm moves')")
    await page.until("document.querySelector('.replay-time').textContent.includes('stands still')")
    await page.fill(PLACE, "6")
    await page.until("document.querySelector('.replay-time').textContent.startsWith('0:06 of ')")
    assert number(player(socket), "position_s") == pytest.approx(6.0, abs=0.9)  # a busy machine misses ticks
    await page.fill(".replay-speed", "10")
    await page.click(PLAY)
    await page.until("!document.querySelector('.replay-time').textContent.includes('stands still')")
    eventually(lambda: number(player(socket), "position_s") > 7)
    assert player(socket)["speed"] == 10
    assert "nothing is recorded here" in await page.text()
