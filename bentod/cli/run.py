"""`bentod run`: the daemon, with a live view when it stands on a terminal."""

import asyncio
import os
import select
import socket as sockets
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

import click

from bentod import logs
from bentod.activation import passed_socket, path_of
from bentod.cli.configs import DEFAULT, read
from bentod.cli.screen import settings_kept
from bentod.clock import SystemClock
from bentod.config import Config
from bentod.daemon import Daemon, environment_supervisor, socket_path
from bentod.errors import BentodError, ConfigError
from bentod.realtime import upkeep


@click.command()
@click.option("--config", type=click.Path(path_type=Path), help="Config file; default: the simulated arm.")
@click.option("--emg", default="", help="Replace the EMG source, e.g. replay:FILE or replay:FILE#ARRAY.")
@click.option("--port", default="", help="Replace the driver's port, e.g. by that of `bentod sim-bus`.")
@click.option("--socket", type=click.Path(path_type=Path), help="Socket path; default: see the README.")
@click.option("--record/--no-record", default=None, help="Record the session; default: as the config says.")
@click.option("--ticks", type=click.IntRange(min=0), default=0, help="End by itself after so many ticks.")
@click.option("--view/--no-view", default=None, help="Live view; default: on a terminal.")
@click.option("--dashboard/--no-dashboard", default=False, help="Show the arm in a browser, too.")
@click.option("--log-level", default="INFO", type=click.Choice(["DEBUG", "INFO", "WARNING", "ERROR"]))
def run(
    config: Path | None,
    emg: str,
    port: str,
    socket: Path | None,
    record: bool | None,
    ticks: int,
    view: bool | None,
    dashboard: bool,
    log_level: str,
) -> None:
    """Run the daemon until Ctrl-C or SIGTERM; the arm is then left as the config says."""
    shown = sys.stdout.isatty() if view is None else view
    try:
        checked = read(config, emg, port, record)
        passed = passed_socket(os.environ)  # and taken out of the view's environment
        where = path_of(passed) if passed else socket_path(checked, socket)
        with ExitStack() as stack:
            file = _log_file() if shown else None
            stream = stack.enter_context(open(os.devnull, "w", encoding="utf-8")) if shown else None
            stack.enter_context(logs.setup(log_level, stream=stream, file=file))
            if dashboard:
                stack.enter_context(_beside(where, file, "dashboard", *(["--quiet"] if shown else [])))
            if shown:
                stack.enter_context(settings_kept())
                stack.enter_context(_beside(where, None, "watch"))
            left = asyncio.run(_serve(checked, str(config or DEFAULT), where, ticks, passed))
    except BentodError as error:
        for line in str(error).splitlines():
            click.echo(f"bentod: {line}", err=True)
        raise SystemExit(1) from error
    if shown and select.select([], [sys.stdout], [], 1.0)[1]:  # a terminal that nobody reads would block
        click.echo(f"{left} The log is in {file}")


async def _serve(config: Config, name: str, socket: Path, ticks: int, passed: sockets.socket | None) -> str:
    async with SystemClock() as clock:
        with environment_supervisor() as supervisor, upkeep(config.realtime, clock) as around:
            return await Daemon(config, clock, supervisor, socket, passed, around, name).run(ticks)


@contextmanager
def _beside(socket: Path, log: Path | None, *words: str) -> Iterator[None]:
    """A process and a client of its own: a terminal or a page that is stuck cannot delay a tick.

    `log`: where its complaints go; None: to the terminal.
    """
    command = [sys.executable, "-m", "bentod", *words, "--socket", os.fspath(socket)]
    with ExitStack() as stack:
        complaints = stack.enter_context(open(log, "ab")) if log else None
        client = stack.enter_context(subprocess.Popen(command, stderr=complaints))  # noqa: S603 -- our own
        try:
            yield
        finally:
            client.terminate()
            with suppress(subprocess.TimeoutExpired):
                client.wait(timeout=1.0)
            client.kill()  # a terminal that nobody reads must not keep the daemon


def _log_file() -> Path:
    """Where the log goes while the terminal shows the view.

    Raises:
        ConfigError: there can be no such file.
    """
    state = Path(os.environ.get("XDG_STATE_HOME") or Path.home() / ".local" / "state")
    folder = state / "bentod"
    file = folder / "bentod.log"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        file.touch()
    except OSError as error:
        raise ConfigError(f"the log cannot be kept in {file}: {error}; try --no-view") from error
    return file
