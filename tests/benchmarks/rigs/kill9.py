"""A real daemon, killed by SIGKILL; its servo behind the port of `bentod sim-bus` is read from outside."""

import asyncio
import os
import signal
import subprocess
import sys
import tempfile
import termios
import time
import tty
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from select import select

from bentod.client import Client

CONFIG = Path(__file__).parents[3] / "config" / "bento.toml"

JOINT, SERVO, SPEED = "shoulder_rotation", 1, 0.7
"""The worst damped joint of the arm; rad/s."""

READ = bytes((0xFF, 0xFF, SERVO, 4, 2, 36, 4, 0xFF - (SERVO + 4 + 2 + 36 + 4) % 256))
"""Protocol 1.0: read Present Position and Present Speed (36 to 39)."""

MOVED = 0.6
"""s of motion before the kill."""

WATCHED = 1.5
"""s after it."""

LIMP = bytes((0xFF, 0xFF, SERVO, 4, 3, 24, 0, 0xFF - (SERVO + 4 + 3 + 24) % 256))
"""Protocol 1.0: switch torque off (24)."""


@dataclass(frozen=True, slots=True)
class Kill:
    """What the joint did after SIGKILL."""

    seconds: float  # until its last reading in motion
    ticks: int  # how far it came, 4096 a turn
    speed: int  # greatest Present Speed that was read: 0 means that the kill met no motion


def kills(count: int) -> Iterator[Kill]:
    """One after the other, on one bus; each daemon takes over a limp arm."""
    with tempfile.TemporaryDirectory() as folder, _bus() as port:
        for number in range(count):
            socket = Path(folder) / f"{number}.sock"
            yield _kill(port, socket, SPEED if number % 2 else -SPEED)


@contextmanager
def _bus() -> Iterator[str]:
    command = [sys.executable, "-m", "sim.bus_process", "--exit-on-eof"]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as child:
        assert child.stdout
        try:
            yield child.stdout.readline().strip()
        finally:
            child.kill()


def _kill(port: str, socket: Path, velocity: float) -> Kill:
    command = [sys.executable, "-m", "bentod", "run", "--config", str(CONFIG), "--port", port]
    command += ["--socket", str(socket), "--no-view", "--log-level", "ERROR"]
    daemon = subprocess.Popen(command)
    try:
        asyncio.run(_set_in_motion(socket, velocity))
        daemon.send_signal(signal.SIGKILL)
        killed = time.monotonic()
        daemon.wait()
    finally:
        daemon.kill()
    return _watch(port, killed)


async def _set_in_motion(socket: Path, velocity: float) -> None:
    async with asyncio.timeout(20):
        while not socket.exists():  # noqa: ASYNC110 -- there is no event for a file
            await asyncio.sleep(0.05)
        await asyncio.sleep(0.5)
        async with Client.connect(socket) as arm:
            await arm.call("torque", on=True)
            await arm.call("pause", on=False)
            await arm.call("move", joint=JOINT, velocity=velocity, lease_s=2.0)
            await asyncio.sleep(MOVED)


def _watch(port: str, killed: float) -> Kill:
    """Read the servo until it has long been at rest, then let it go."""
    handle = os.open(port, os.O_RDWR | os.O_NOCTTY)
    try:
        tty.setraw(handle)
        settings = termios.tcgetattr(handle)
        settings[4] = settings[5] = termios.B1000000
        termios.tcsetattr(handle, termios.TCSANOW, settings)
        seen = list(_readings(handle, killed + WATCHED))
        os.write(handle, LIMP)
    finally:
        os.close(handle)
    moving = [at for at, _, speed in seen if speed > 1]
    positions = [position for _, position, _ in seen]
    last = max(moving, default=killed)
    return Kill(last - killed, abs(positions[-1] - positions[0]), max(speed for _, _, speed in seen))


def _readings(handle: int, until: float) -> Iterator[tuple[float, int, int]]:
    """Time (monotonic s), position and unsigned speed, every few ms."""
    waiting = b""
    while time.monotonic() < until:
        os.write(handle, READ)
        while select([handle], [], [], 0.02)[0]:
            waiting += os.read(handle, 256)
            if len(waiting) >= 10:
                break
        start = waiting.find(bytes((0xFF, 0xFF, SERVO, 6)))
        if start >= 0 and len(waiting) >= start + 10:
            position, speed = waiting[start + 5 : start + 7], waiting[start + 7 : start + 9]
            yield time.monotonic(), int.from_bytes(position, "little"), int.from_bytes(speed, "little") % 1024
            waiting = b""
        time.sleep(0.004)
