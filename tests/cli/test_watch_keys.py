"""The live view with a daemon: keys reach the arm, a daemon may come and go, and the terminal survives."""

import asyncio
import os
import signal
from collections.abc import Callable, Sequence
from pathlib import Path

import pytest

from bentod.blocking import BlockingClient
from bentod.cli.keys_verbs import Hands
from bentod.cli.link import Way
from bentod.cli.screen import Screen
from bentod.cli.watch import again_and_again
from bentod.cli.watching import Watching
from tests.rig import PLAIN, Table, number, quiet_config, running, state, table, tables, wait_for
from tests.system.processes import DaemonProcess, Terminal, daemon, eventually, terminal

LEAVE = "\x1b[?1049l"


class Wall(Screen):
    """A screen that remembers what was drawn last, before which somebody sits."""

    def __init__(self) -> None:
        self.keys = True
        self.last = ""

    def size(self) -> os.terminal_size:
        return os.terminal_size((80, 24))

    def draw(self, lines: Sequence[str]) -> None:
        self.last = "\n".join(lines)


async def until(holds: Callable[[], bool]) -> None:
    async with asyncio.timeout(60):
        while not holds():  # noqa: ASYNC110 -- a screen tells nobody that it has changed
            await asyncio.sleep(0.02)


async def test_the_view_waits_for_another_daemon_and_holds_nothing_of_the_one_before(tmp_path: Path) -> None:
    socket, wall, hands = tmp_path / "bentod.sock", Wall(), Hands()
    watching = Watching(wall, hands)
    async with running(quiet_config(PLAIN), socket):
        task = asyncio.create_task(again_and_again(Way(socket), watching))
        await until(lambda: "Space STOP" in wall.last)
        watching.press(["h"])
    await until(lambda: "NO DAEMON" in wall.last)
    watching.press(["p", "right"])
    async with running(quiet_config(PLAIN), socket) as arm:
        await until(lambda: "Space STOP" in wall.last)
        assert (await state(arm))["goal"] is None
        watching.press(["space"])
        await wait_for(arm, lambda frame: frame["mode"] == "paused")
        watching.press(["q"])
        await task


async def test_of_arrows_that_were_held_up_and_come_all_at_once_one_moves_the_arm(tmp_path: Path) -> None:
    socket, wall = tmp_path / "bentod.sock", Wall()
    watching = Watching(wall, Hands())
    async with running(quiet_config(PLAIN), socket) as arm:
        task = asyncio.create_task(again_and_again(Way(socket), watching))
        await until(lambda: "Space STOP" in wall.last)
        watching.press(["right"] * 200)
        await wait_for(arm, lambda frame: speed(frame) > 0.05)
        await asyncio.sleep(1.0)
        frame = await state(arm)
        assert speed(frame) < 0.01
        assert number(tables(frame, "joints")[0], "position") < 0.15
        watching.press(["q"])
        await task


def speed(frame: Table) -> float:
    return number(tables(frame, "joints")[0], "velocity")


def position(process: DaemonProcess, name: str) -> float:
    joints = tables(process.state(), "joints")
    return next(number(joint, "position") for joint in joints if joint["name"] == name)


def pushed(screen: Terminal, process: DaemonProcess) -> float:
    """Where the wrist is (rad) after one more arrow."""
    screen.type("\x1b[C")
    return position(process, "wrist_flexion")


def goal(process: DaemonProcess) -> object:
    frame = process.state()
    return table(frame["goal"])["status"] if frame["goal"] else None


def shown(screen: Terminal, text: str) -> None:
    """Wait until `text` is drawn anew."""
    before = len(screen.shown)
    eventually(lambda: text in screen.read()[before:])


@pytest.mark.real_time
def test_keys_select_move_stop_release_and_send_home_and_the_terminal_is_as_it_was(tmp_path: Path) -> None:
    socket = tmp_path / "bentod.sock"
    with (
        daemon(tmp_path, "--config", "sim.toml") as process,
        terminal(tmp_path, "watch", "--socket", str(socket)) as screen,
    ):
        shown(screen, "Space STOP")
        with BlockingClient(socket) as arm:
            arm.call("emg_pause")
        screen.type("g\t")
        shown(screen, "terminal switched hand to wrist_flexion")
        start = position(process, "wrist_flexion")
        eventually(lambda: pushed(screen, process) > start + 0.1)
        screen.type("h")
        eventually(lambda: goal(process) == "moving")
        screen.type("x")
        eventually(lambda: goal(process) == "cancelled")
        screen.type(" ")
        shown(screen, "PAUSED")
        screen.type("p")
        shown(screen, "release the arm? press y")
        screen.type("y")
        shown(screen, "ACTIVE")
        screen.type("\x1b")
        shown(screen, "PAUSED")
        process.child.send_signal(signal.SIGTERM)
        shown(screen, "NO DAEMON")
        screen.child.send_signal(signal.SIGTERM)
        eventually(screen.has_ended)
        assert "Traceback" not in screen.shown
        assert screen.shown.rstrip().endswith(LEAVE)
        assert screen.is_as_it_was()
