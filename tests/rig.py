"""A whole daemon on a simulated arm, in virtual time, with a client on its real socket."""

import asyncio
from collections.abc import AsyncIterator, Callable, Iterator
from contextlib import asynccontextmanager, contextmanager, suppress
from pathlib import Path
from typing import cast
from unittest import mock

from bentod import registry
from bentod.client import Client
from bentod.config import Config
from bentod.config_file import parse
from bentod.config_tables import Record
from bentod.contracts import Clock, EmgConfig
from bentod.daemon import Daemon
from bentod.frames import Value
from bentod.supervise import Supervisor
from sim import emg
from sim.clock import VirtualClock
from sim.emg import Synthetic

CONFIGS = Path(__file__).parents[1] / "config"

Table = dict[str, Value]


def sim_config(*changes: tuple[str, str]) -> Config:
    """The shipped simulation with pieces of its text replaced."""
    text = (CONFIGS / "sim.toml").read_text()
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new)
    return parse(text, "sim.toml", registry).model_copy(update={"record": Record(enabled=False)})


PLAIN = ('"sim-dynamixel"', '"sim"')
"""Without bytes, for tests that do not care about the bus."""


def quiet_config(*changes: tuple[str, str]) -> Config:
    """The same without a wearer: only clients move the arm."""
    return sim_config(*changes).model_copy(update={"emg": None})


@asynccontextmanager
async def running(config: Config, socket: Path, mode: str = "active") -> AsyncIterator[Client]:
    """The daemon under way and in `mode`, and a client of it; both are gone afterwards."""
    daemon = Daemon(config, VirtualClock(), Supervisor(), socket)
    task = asyncio.create_task(daemon.run())
    while not socket.exists() and not task.done():  # noqa: ASYNC110 -- there is no event for a file
        await asyncio.sleep(0.01)
    if task.done():
        await task
    try:
        async with Client.connect(socket) as arm:
            await wait_for(arm, lambda frame: frame["mode"] == mode)
            yield arm
    finally:
        task.cancel()
        with suppress(asyncio.CancelledError):
            await task


@contextmanager
def opened_sources() -> Iterator[list[Synthetic]]:
    """The simulated wearers that a daemon opens, to be broken by hand."""
    opened: list[Synthetic] = []
    open_emg = emg.open_emg

    @asynccontextmanager
    async def keep(config: EmgConfig, clock: Clock) -> AsyncIterator[Synthetic]:
        async with open_emg(config, clock) as source:
            opened.append(source)
            yield source

    with mock.patch.object(emg, "open_emg", keep):
        yield opened


async def wait_for(arm: Client, condition: Callable[[Table], bool], seconds: float = 20.0) -> Table:
    """The first frame that meets `condition`; fails after `seconds` of virtual time."""
    async with asyncio.timeout(seconds):
        async for frame in arm.subscribe_state(rate_hz=500):
            if condition(frame):
                return frame
    raise AssertionError("the daemon sends no more frames")


async def state(arm: Client) -> Table:
    """The newest frame."""
    return cast("Table", await arm.call("get_state"))


def tables(frame: Table, key: str) -> list[Table]:
    """A list of tables in a frame: its joints, its groups."""
    return cast("list[Table]", frame[key])


def table(value: Value) -> Table:
    """A value that is a table."""
    assert isinstance(value, dict)
    return value


def joint(frame: Table, name: str) -> Table:
    """One joint of a frame."""
    return next(found for found in tables(frame, "joints") if found["name"] == name)


def number(table: Table, key: str) -> float:
    """A number in a table."""
    value = table[key]
    assert isinstance(value, int | float)
    return float(value)
