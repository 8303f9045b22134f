"""A real daemon with a simulated arm, a real page's server, and a browser that looks at it."""

import asyncio
import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import urlsplit

from bentod.blocking import BlockingClient
from tests.dashboard.page import Page
from tests.system.processes import BENTOD, PATIENCE, environment, eventually

CONFIG = Path(__file__).parents[2] / "config" / "sim.toml"


@dataclass(frozen=True, slots=True)
class Lab:
    """A daemon and its page."""

    folder: Path
    socket: Path
    server: "subprocess.Popen[bytes]"

    @property
    def operator(self) -> str:
        """The page's address for those who may move the arm."""
        return self._printed("The page is at")

    @property
    def observer(self) -> str:
        """The same for those who only look."""
        return self._printed("To look only:")

    def _printed(self, before: str) -> str:
        return (self.folder / "server.out").read_text().partition(before)[2].split()[0]

    @property
    def place(self) -> str:
        """Host and port of the page's server."""
        return urlsplit(self.operator).netloc

    def workers(self) -> list[int]:
        """Processes of the page's server, which its keeper has started."""
        children = Path(f"/proc/{self.server.pid}/task/{self.server.pid}/children")
        return [int(word) for word in children.read_text().split()]

    def arm(self) -> BlockingClient:
        """A client of the daemon, beside the page's."""
        return BlockingClient(self.socket)

    def state(self) -> dict[str, object]:
        """The newest frame."""
        with self.arm() as arm:
            frame = arm.call("get_state")
            assert isinstance(frame, dict)
            return dict(frame)

    def angle(self, name: str) -> float:
        """Where a joint is, rad."""
        joints = self.state()["joints"]
        assert isinstance(joints, list)
        return next(float(joint["position"]) for joint in joints if joint["name"] == name)

    def goal(self) -> str:
        """How the newest goal stands."""
        goal = self.state()["goal"]
        return str(goal["status"]) if isinstance(goal, dict) else ""

    def calm(self) -> None:
        """An arm that is active, at rest, and moved by nobody: muscles rest, and the assist is off."""
        with self.arm() as arm:
            if self.state()["fault"]:
                arm.call("clear_fault")
            arm.call("emg_pause", on=True)
            arm.call("assist_set", mode="off")
            if self.state()["mode"] == "limp":
                arm.call("torque", on=True)
            arm.call("pause", on=False)


@contextmanager
def lab(folder: Path, config: Path = CONFIG, *options: str, arm: bool = True) -> Iterator[Lab]:
    """Both processes, until left. `options`: of `bentod dashboard`."""
    socket = folder / "bentod.sock"
    with _running(folder, "daemon", "run", "--config", str(config), "--socket", str(socket), "--no-view"):
        eventually(socket.exists)
        with _running(folder, "server", "dashboard", "--socket", str(socket), *options) as server:
            found = Lab(folder, socket, server)
            eventually(lambda: "To look only" in (folder / "server.out").read_text())
            yield found


@contextmanager
def _running(folder: Path, name: str, *words: str) -> Iterator["subprocess.Popen[bytes]"]:
    own = environment(folder, XDG_CONFIG_HOME=str(folder))
    with (
        open(folder / f"{name}.out", "wb") as out,
        open(folder / f"{name}.err", "wb") as err,
        subprocess.Popen([*BENTOD, *words], stdout=out, stderr=err, env=own) as process,
    ):
        try:
            yield process
        finally:
            process.terminate()


async def soon(find: Callable[[], object]) -> None:
    """Return once `find` finds something, while pages live on."""
    deadline = time.monotonic() + PATIENCE
    while not find():
        assert time.monotonic() < deadline, "it did not happen"
        await asyncio.sleep(0.02)


async def opened(page: Page, url: str) -> Page:
    """The page once it shows a living arm."""
    await page.goto(url)
    await page.until("!!(window.bentod?.frame && document.querySelector('#stop'))")
    return page
