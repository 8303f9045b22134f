"""Faults that only a real process can have."""

import asyncio
import resource
import signal
import socket
import sys
from collections.abc import Callable, Coroutine
from contextlib import ExitStack
from pathlib import Path
from typing import TypeAlias

from tests.system.campaign.bus_faults import DEAF, LET_GO
from tests.system.campaign.host_faults import GONE, STOPPED
from tests.system.campaign.outcome import Bound, Moved, Outcome
from tests.system.campaign.processes import CLIENT, CONFIG, Real, daemon, ended, real_arm, spawn
from tests.system.campaign.rig import BY_ITSELF, RELEASED, RESTARTED

FULL = Path("/dev/full")
"""A file on a disk that is full."""

SPARE = 8
"""File descriptors that the daemon may still open."""

CROWD = 24
"""Connections that want one each."""

GARBAGE = b"\x00\xff arm = = ["

SEEN = 1.0
"""s that are watched, longer than any bound."""

RealCase: TypeAlias = Callable[[], Coroutine[object, object, Outcome]]


def _outcome(
    fault: str,
    bound: Bound,
    moved: Moved,
    told: str,
    recovery: str,
    went_on: bool = True,
    says: str = "",
    again: str = BY_ITSELF,
) -> Outcome:
    return Outcome(fault, "client", bound, moved, 0.0, went_on, told, recovery, says, (again,))


async def _recovery(real: Real, remedy: str = BY_ITSELF) -> str:
    """`remedy` if the arm obeys, else that it does not."""
    return remedy if await real.obeys() else "not"


async def client_killed() -> Outcome:
    """SIGKILL to a client in mid-motion."""
    async with real_arm() as real:
        client = await spawn(real.folder, sys.executable, "-c", CLIENT, str(real.socket))
        real.stack.push_async_callback(ended, client)
        await real.until_it_moves()
        client.kill()
        moved = await real.moved(real.now, SEEN)
        return _outcome("client killed (kill -9)", GONE, moved, "", await _recovery(real))


async def daemon_killed() -> Outcome:
    """SIGKILL to the daemon in mid-motion; another one takes over."""
    async with real_arm() as real:
        operator = await real.operate()
        real.process.kill()
        moved = await real.moved(real.now, SEEN)
        await operator.vanish()
        await real.process.wait()
        await real.restart()
        return _outcome(
            "daemon killed (kill -9)", DEAF, moved, "", await _recovery(real, RESTARTED), again=RESTARTED
        )


async def daemon_stopped() -> Outcome:
    """SIGSTOP for 2 s; what the client asked meanwhile waits in the socket, and it is not there any more."""
    async with real_arm() as real:
        operator = await real.operate()
        real.process.send_signal(signal.SIGSTOP)
        since = real.now
        await asyncio.sleep(0.25)
        operator.let_go()
        await asyncio.sleep(STOPPED - 0.25)
        real.process.send_signal(signal.SIGCONT)
        moved = await real.moved(since, SEEN)
        recovery, said = await _recovery(real), real.log().splitlines()
        if recovery != BY_ITSELF:  # it was stopped in the middle of a round on the bus
            await real.call("clear_fault")
            await real.released()
            recovery = await _recovery(real, RELEASED)
        told = next((line for line in reversed(said) if "WARNING" in line), "")
        return _outcome("daemon stopped for 2 s (SIGSTOP)", DEAF, moved, told, recovery, again=recovery)


async def log_on_a_full_disk() -> Outcome:
    """Nothing that the daemon says can be written."""
    async with real_arm(FULL) as real:
        operator = await real.operate()
        since = operator.let_go()
        moved = await real.moved(since, SEEN)
        return _outcome("log on a full disk", LET_GO, moved, "", await _recovery(real))


async def out_of_file_descriptors() -> Outcome:
    """More connect than the daemon has file descriptors for."""
    async with real_arm() as real:
        operator = await real.operate()
        open_now = len(list(Path(f"/proc/{real.process.pid}/fd").iterdir()))
        limit = open_now + SPARE
        resource.prlimit(real.process.pid, resource.RLIMIT_NOFILE, (limit, limit))
        with ExitStack() as crowd:
            for _ in range(CROWD):
                crowd.enter_context(socket.socket(socket.AF_UNIX)).connect(str(real.socket))
            went_on = (await real.moved(real.now, 0.5)).degrees > 2
            since = operator.let_go()
            moved = await real.moved(since, SEEN)
        told = next((line for line in real.log().splitlines() if "out of" in line or "many" in line), "")
        await real.released()
        recovery = await _recovery(real)
        return _outcome("out of file descriptors", LET_GO, moved, told, recovery, went_on, "out of|many")


async def config_becomes_garbage() -> Outcome:
    """The file is replaced while the daemon runs; the next start refuses it."""
    async with real_arm() as real:
        operator = await real.operate()
        config = real.folder / CONFIG
        good = config.read_bytes()
        config.write_bytes(GARBAGE)
        went_on = (await real.moved(real.now, 0.5)).degrees > 2
        moved = await real.moved(operator.let_go(), SEEN)
        await operator.vanish()
        real.process.send_signal(signal.SIGHUP)
        await real.process.wait()
        refused = await spawn(real.folder, *daemon(real.folder))
        went_on = went_on and await refused.wait() == 1
        told = real.log().splitlines()[-1].replace(f"{real.folder}/", "")
        config.write_bytes(good)
        await real.restart()
        recovery = await _recovery(real, RESTARTED)
        return _outcome("config becomes garbage", LET_GO, moved, told, recovery, went_on, CONFIG, RESTARTED)


CASES: tuple[RealCase, ...] = (
    client_killed,
    daemon_killed,
    daemon_stopped,
    log_on_a_full_disk,
    out_of_file_descriptors,
    config_becomes_garbage,
)
