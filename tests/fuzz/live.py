"""A real daemon under attack in real time: whether its ticks are late for it, and whether it grows."""

import asyncio
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from random import Random

from bentod.client import Client
from tests.fuzz.grammar import pieces
from tests.fuzz.siege import Siege, besieged
from tests.rig import number, state
from tests.system.processes import DaemonProcess, daemon

ATTACKERS = 4

SLOW = ("inject", "torque", "clear_fault")
"""Methods that may make a tick late on purpose: they break the arm, or wait for its servos."""


@dataclass(frozen=True, slots=True)
class Toll:
    """What an attack cost."""

    seconds: float
    attacks: int
    missed: float  # ticks
    missed_idle: float  # ticks in a tenth of the time without an attack
    ticks: float
    grown: int  # KiB from a third of the time on
    busy: float  # share of a core that the daemon got and used


def besiege(seconds: float, seed: int) -> Toll:
    """Attack a daemon of its own process for `seconds`.

    Raises:
        Broken: it did not hold.
    """
    with tempfile.TemporaryDirectory() as folder, _daemon(Path(folder)) as process:
        return asyncio.run(_attack(process, seconds, seed))


@contextmanager
def _daemon(folder: Path) -> Iterator[DaemonProcess]:
    with daemon(folder, "--config", "sim.toml", "--log-level", "ERROR") as process:
        yield process
        if "Traceback" in process.log():
            raise AssertionError(process.log())


async def _attack(process: DaemonProcess, seconds: float, seed: int) -> Toll:
    async with Client.connect(process.socket) as arm:
        first = await state(arm)
        await asyncio.sleep(seconds / 10)
        calm = await state(arm)
        async with besieged(process.socket, arm) as siege:
            siege.watch.punctual = False
            crowd = [asyncio.create_task(_harry(siege, Random(seed + n), seconds)) for n in range(ATTACKERS)]
            await asyncio.sleep(seconds / 3)
            before, used = _resident(process.child.pid), _used(process.child.pid)
            attacks = sum(await asyncio.gather(*crowd))
            grown = _resident(process.child.pid) - before
            busy = (_used(process.child.pid) - used) / (seconds * 2 / 3)
            last = await state(arm)
            await siege.verify()
    missed = [number(frame, "missed") for frame in (first, calm, last)]
    ticks = number(last, "tick") - number(calm, "tick")
    return Toll(seconds, attacks, missed[2] - missed[1], missed[1] - missed[0], ticks, grown, busy)


async def _harry(siege: Siege, random: Random, seconds: float) -> int:
    """Calls and bytes in turn; how many connections that made."""
    until = asyncio.get_running_loop().time() + seconds
    attacks = 0
    while asyncio.get_running_loop().time() < until:
        await siege.bytes(pieces(siege.grammar.stream(random), random))
        calls = [siege.grammar.call(random) for _ in range(random.choice([1, 5, 50]))]
        await siege.calls([([call for call in calls if call[0] not in SLOW], 0.0)])
        attacks += 2
    return attacks


def _resident(pid: int) -> int:
    """KiB of memory that a process holds."""
    pages = int(Path(f"/proc/{pid}/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") // 1024


def _used(pid: int) -> float:
    """Seconds of processor time that a process has used."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
