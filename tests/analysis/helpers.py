"""A session as the daemon makes it, in virtual time, and recordings of it made by the real recorder."""

import asyncio
import time
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from unittest.mock import patch

import numpy as np

from bentod.client import Client
from bentod.emg.windows import Ring
from bentod.frames import ClientCommand, EmgBlock, Event, Frame, Trial
from bentod.record.disk import Folder
from bentod.record.recorder import Recorder
from bentod.record.session import Entry, Header
from bentod.serve.server import Server
from sim.clock import VirtualLoop
from tests.rig import CONFIGS, PLAIN, running, sim_config

PERIOD = 1 / 30
TRIAL_S, BREAK_S, FIRST_S = 12.0, 3.0, 10.0
CONDITIONS = ("toggling", "toggling", "toggling", "dpcc", "dpcc", "dpcc")
"""Of the trials of `session()`, one after another."""


@cache
def session() -> tuple[Entry, ...]:
    """110 s with a simulated wearer: six trials, a pulled cable, a pause, marks, commands of clients."""
    entries: list[Entry] = []

    async def act() -> None:
        with TemporaryDirectory() as folder, _watched(entries):
            async with running(sim_config(PLAIN), Path(folder) / "s") as arm:
                await _act(arm)

    with asyncio.Runner(loop_factory=VirtualLoop) as runner:
        runner.run(act())
    started = next(entry.time for entry in entries if isinstance(entry, Frame)) - PERIOD
    made = [_in_trial(entry, started) if isinstance(entry, Frame) else entry for entry in entries]
    return (*made, *_by_hand(started))


async def _act(arm: Client) -> None:
    await arm.call("set_meta", meta={"participant": "P7", "session": 2})
    await asyncio.sleep(100)
    await arm.call("pause")
    await arm.call("go_home")
    await asyncio.sleep(4)
    await arm.call("inject", fault="cable")
    await asyncio.sleep(2)
    await arm.call("inject", fault="cable", on=False)
    await asyncio.sleep(1)
    await arm.call("clear_fault")
    await asyncio.sleep(2)


@contextmanager
def _watched(entries: list[Entry]) -> Iterator[None]:
    """Put what the server publishes, and the blocks that reach the ring, into `entries`."""
    state, event, append = Server.publish_state, Server.publish_event, Ring.append

    def publish_state(server: Server, frame: Frame) -> None:
        entries.append(frame)
        state(server, frame)

    def publish_event(server: Server, told: Event) -> None:
        entries.append(told)
        event(server, told)

    def appended(ring: Ring, block: EmgBlock) -> int:
        entries.append(block)
        return append(ring, block)

    with (
        patch.object(Server, "publish_state", publish_state),
        patch.object(Server, "publish_event", publish_event),
        patch.object(Ring, "append", appended),
    ):
        yield


def _in_trial(frame: Frame, started: float) -> Frame:
    number, since = divmod(frame.time - started - FIRST_S, TRIAL_S + BREAK_S)
    if not 0 <= number < len(CONDITIONS) or since >= TRIAL_S - PERIOD / 2:
        return frame
    begun = started + FIRST_S + number * (TRIAL_S + BREAK_S)
    return replace(frame, trial=Trial(int(number) + 1, "rectangle", CONDITIONS[int(number)], begun))


def _by_hand(started: float) -> tuple[Entry, ...]:
    """What a client asked, once carried out and once refused."""
    return (
        ClientCommand(started + 100.5, 3015, "joy <&> \x1b[31m", "pause", {"on": True}, ""),
        ClientCommand(started + 101, 3030, "nobody", "move", ["gripper", 0.5, None, 0.2], "it is paused"),
    )


def header(entries: Iterable[Entry], name: str = "2026-11-22T19-04-05Z-3f2a", config: str = "") -> Header:
    """The header of a recording of `entries`."""
    frame = next((entry for entry in entries if isinstance(entry, Frame)), None)
    sim = sim_config(PLAIN)
    return Header(
        session=name,
        schema=1,
        started=frame.time - PERIOD if frame else 0.0,
        started_wall=1_795_460_645.25,
        arm=sim.arm,
        rate_hz=30.0,
        joints=tuple(joint.spec() for joint in sim.joints),
        config=config or (CONFIGS / "sim.toml").read_text(),
        config_name="sim.toml",
        versions={"bentod": "0.1.0", "python": "3.11.7"},
    )


def record(folder: Path, entries: Sequence[Entry], about: Header | None = None) -> Path:
    """A recording of `entries` by the real recorder; returns its only file."""
    made = about or header(entries)
    with Recorder(made, Folder(folder)) as recorder:
        for number, entry in enumerate(entries):
            recorder.put(entry)
            while number % 1000 == 999 and recorder.status.waiting > 2000:
                time.sleep(0)  # the disk first
    assert recorder.status.dropped.total == 0
    assert recorder.status.problem == ""
    (path,) = folder.glob(f"{made.session}*")
    return path


@cache
def excerpt() -> tuple[Entry, ...]:
    """The last 30 s of `session()`: most of a trial, all that clients did, and the fault."""
    start = frames(session())[-1].time - 30.0
    return tuple(entry for entry in session() if entry.time >= start)


@cache
def recorded(folder: Path) -> Path:
    """One recording of `session()`, below `folder`, for everybody who only reads it."""
    return record(folder / "recorded session", session())


def frames(entries: Iterable[Entry]) -> list[Frame]:
    """The ticks among `entries`."""
    return [entry for entry in entries if isinstance(entry, Frame)]


def blocks(entries: Iterable[Entry]) -> list[EmgBlock]:
    """The EMG among `entries`."""
    return [entry for entry in entries if isinstance(entry, EmgBlock)]


def one_frame() -> Frame:
    """Any tick of the session, to be changed with `replace`."""
    return frames(session())[300]


def ticks(count: int, start: float = 100.0) -> list[Frame]:
    """Ticks in a row from `start` (monotonic s) on, outside any trial, with nothing else that changes."""
    frame = replace(one_frame(), trial=None, meta=None, gap=False)
    return [replace(frame, tick=number, time=start + number * PERIOD) for number in range(count)]


def samples(block: EmgBlock) -> np.ndarray:
    """The samples of a block, as they are."""
    return np.asarray(block.samples)
