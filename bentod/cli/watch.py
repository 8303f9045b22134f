"""`bentod watch`: the live view in a terminal, a client of the socket like any other."""

import asyncio
import signal
import time
from collections import deque
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import click

from bentod.cli.link import ADDRESS, CA_FILE, TOKEN_FILE, Way
from bentod.cli.view import Range, lines
from bentod.client import Client
from bentod.endpoint import Disconnected, default_socket_path
from bentod.errors import BentodError
from bentod.frames import Value

RATE_HZ = 10
"""Frames drawn a second: more only flickers."""

PATIENCE_S = 10.0
"""How long to wait for a daemon that is still starting."""

_ENTER = "\x1b[?1049h\x1b[?25l"  # alternate screen, no cursor
_LEAVE = "\x1b[?25h\x1b[?1049l"
_HELP = "  Ctrl-C ends.   From another terminal: bentod ctl pause | torque off | go-home | --help"


@click.command()
@ADDRESS
@TOKEN_FILE
@CA_FILE
def watch(socket: str | None, token_file: Path | None, ca_file: Path | None) -> None:
    """Show the running daemon until Ctrl-C or its end."""
    with _screen():
        complaint = asyncio.run(_watch(Way(socket or default_socket_path(), token_file, ca_file)))
    if complaint:
        click.echo(complaint, err=True)
        raise SystemExit(3)


async def _watch(way: Way) -> str:
    """Draw until the daemon or the user ends; returns why nothing could be drawn, if so."""
    drawn: list[bool] = []
    task = asyncio.ensure_future(_draw(way, drawn))
    loop = asyncio.get_running_loop()
    for number in (signal.SIGINT, signal.SIGTERM):
        loop.add_signal_handler(number, task.cancel)
    complaint = ""
    try:
        await task
    except* asyncio.CancelledError:
        pass
    except* BentodError as lost:
        complaint = "" if drawn else str(lost.exceptions[0])
    return complaint


async def _draw(way: Way, drawn: list[bool]) -> None:
    """Draw frame after frame; `drawn` is not empty after the first."""
    await _await_daemon(way)
    events: deque[str] = deque(maxlen=8)
    async with way.client() as arm, asyncio.TaskGroup() as tasks:
        ranges = _ranges(await arm.call("get_info"))
        listener = tasks.create_task(_listen(arm, events))
        try:
            async for frame in arm.subscribe_state(RATE_HZ):
                drawn[:] = [True]
                screen = [*lines(frame, ranges, list(events)), "", _HELP]
                click.echo("\x1b[H" + "".join(f"{line}\x1b[K\r\n" for line in screen) + "\x1b[J", nl=False)
        finally:
            listener.cancel()


async def _listen(arm: Client, events: deque[str]) -> None:
    async for event in arm.subscribe_events():
        events.append(f"{time.strftime('%H:%M:%S')}  {event['text']!s}")


async def _await_daemon(way: Way) -> None:
    """Return once the daemon can be reached. Raises Disconnected: it did not come."""
    deadline = time.monotonic() + PATIENCE_S
    while True:
        try:
            async with way.client():
                return
        except Disconnected:
            if time.monotonic() > deadline:
                raise
        await asyncio.sleep(0.1)


def _ranges(info: Value) -> dict[str, Range]:
    joints = info.get("joints") if isinstance(info, dict) else None
    found: dict[str, Range] = {}
    for joint in joints if isinstance(joints, list) else []:
        match joint:
            case {"name": str(name), "min_rad": float(low), "max_rad": float(high)}:
                found[name] = Range(low, high)
    return found


@contextmanager
def _screen() -> Iterator[None]:
    click.echo(_ENTER, nl=False)
    try:
        yield
    finally:
        click.echo(_LEAVE, nl=False)
