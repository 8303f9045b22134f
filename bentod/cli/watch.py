"""`bentod watch`: the live view in a terminal, and its keys; a client of the socket like any other."""

import asyncio
import os
import signal
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import partial
from pathlib import Path

import click

from bentod.cli.keys import Keys
from bentod.cli.keys_verbs import Hands
from bentod.cli.link import ADDRESS, CA_FILE, TOKEN_FILE, Way
from bentod.cli.screen import Screen
from bentod.cli.watching import Watching
from bentod.dashboard.page_file import told
from bentod.endpoint import Disconnected, default_socket_path
from bentod.errors import BentodError

PATIENCE_S = 10.0
"""How long to wait for a daemon that is still starting."""

LOOKS_AGAIN = 0.5
"""s between two looks for a daemon that has gone."""

ESCAPE = 0.05
"""s in which the rest of a key comes that begins as Escape does."""

_ENDING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT)


@click.command()
@ADDRESS
@TOKEN_FILE
@CA_FILE
def watch(socket: str | None, token_file: Path | None, ca_file: Path | None) -> None:
    """Show the running daemon, and move it by keys (? lists them); ends with q or Ctrl-C."""
    complaint = asyncio.run(_watch(Way(socket or default_socket_path(), token_file, ca_file)))
    if complaint:
        click.echo(complaint, err=True)
        raise SystemExit(3)


async def _watch(way: Way) -> str:
    """Draw until the user ends it; returns why nothing could be drawn, if so."""
    screen, hands = Screen(), Hands()
    watching = Watching(screen, hands, partial(told, way.address))
    task = asyncio.create_task(again_and_again(way, watching))
    with _signals(task, screen), _taken(screen), _typed(watching):
        try:
            await task
        except asyncio.CancelledError:
            return ""
        except (BentodError, OSError) as lost:
            return "" if watching.drawn else str(lost)
    return ""


async def again_and_again(way: Way, watching: Watching) -> None:
    """One daemon after the other, while somebody is there to say when to end.

    Raises:
        BentodError: there is none, or not any more and nobody can say.
    """
    deadline = time.monotonic() + PATIENCE_S
    while not watching.hands.quits:
        try:
            await _once(way, watching)
        except Disconnected as lost:
            waits = watching.screen.keys if watching.drawn else time.monotonic() < deadline
            if not waits:
                raise
            watching.lost(str(lost))
            await watching.quits_within(LOOKS_AGAIN if watching.drawn else 0.1)


async def _once(way: Way, watching: Watching) -> None:
    """One connection to the daemon. Raises BentodError, OSError: it is lost, or the terminal is."""
    async with way.client() as arm:
        try:
            await watching.follow(arm)
        except ExceptionGroup as several:
            if several.split((BentodError, OSError))[1]:
                raise
            raise _first(several) from None


def _first(several: ExceptionGroup[Exception]) -> Exception:
    """The error in a group, however deep."""
    inner = several.exceptions[0]
    return _first(inner) if isinstance(inner, ExceptionGroup) else inner


@contextmanager
def _signals(task: "asyncio.Task[None]", screen: Screen) -> Iterator[None]:
    """While entered, signals end `task`, and Ctrl-Z gives the terminal back for as long as it lasts."""
    loop = asyncio.get_running_loop()

    def suspend() -> None:
        screen.leave()
        os.kill(os.getpid(), signal.SIGSTOP)
        screen.enter()

    for number in _ENDING:
        loop.add_signal_handler(number, task.cancel)
    loop.add_signal_handler(signal.SIGTSTP, suspend)
    try:
        yield
    finally:
        for number in (*_ENDING, signal.SIGTSTP):
            loop.remove_signal_handler(number)


@contextmanager
def _taken(screen: Screen) -> Iterator[None]:
    try:
        screen.enter()
        yield
    finally:
        screen.leave()


@contextmanager
def _typed(watching: Watching) -> Iterator[None]:
    """While entered, keys are passed on."""
    if not watching.screen.keys:
        yield
        return
    loop, keys = asyncio.get_running_loop(), Keys()

    def flush() -> None:
        watching.press(keys.flush())

    def read() -> None:
        with suppress(OSError):
            watching.press(keys.feed(os.read(sys.stdin.fileno(), 1024)))
        if keys.waiting:
            loop.call_later(ESCAPE, flush)

    loop.add_reader(sys.stdin, read)
    try:
        yield
    finally:
        loop.remove_reader(sys.stdin)
