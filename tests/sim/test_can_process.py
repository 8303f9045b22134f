"""`sim-can` as a process: the driver must find axes on a bus that both have opened."""

import asyncio
import math
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import pytest

from bentod.contracts import ArmConfig
from bentod.frames import Value, Velocity
from drivers.can.bus import open_joints
from drivers.can.joints import CanJoints
from sim.can.process import WRIST, load
from sim.clock import VirtualClock
from tests.drivers.can.multicast import GROUP, free_port, multicast

pytestmark = pytest.mark.real_time

CONFIG = Path(__file__).parents[2] / "config" / "wrist.toml"


@pytest.fixture
def port() -> int:
    if why := multicast():
        pytest.skip(f"no multicast on this machine: {why}")
    return free_port()


@contextmanager
def running(port: int, *options: str) -> Iterator["subprocess.Popen[str]"]:
    command = [sys.executable, "-m", "sim.can.process", "--udp-port", str(port), *options]
    pipe = subprocess.PIPE
    with subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=pipe, text=True, bufsize=1) as child:
        try:
            assert child.stdout
            assert child.stdout.readline() == f"udp_multicast {GROUP} {port}\n"
            yield child
        finally:
            child.kill()


def tell(child: "subprocess.Popen[str]", line: str) -> None:
    assert child.stdin
    child.stdin.write(line + "\n")
    child.stdin.flush()


def arm(port: int) -> ArmConfig:
    table: dict[str, Value] = {
        "interface": "udp_multicast",
        "channel": GROUP,
        "udp_port": port,
        "open_s": 10.0,
    }
    return ArmConfig((WRIST,), 1 / 50, table)


async def test_a_process_is_driven_over_the_bus_and_its_axis_lets_go_when_the_host_is_gone(port: int) -> None:
    with running(port, "--watchdog", "0.2"):
        async with open_joints(arm(port), VirtualClock()) as joints:
            await joints.set_torque([True])
            before = (await joints.read()).joints[0].position
            for _ in range(40):
                await joints.read()
                await joints.write([Velocity(0.5)])
                await asyncio.sleep(1 / 50)
            assert (await joints.read()).joints[0].position - before > 0.1
        await asyncio.sleep(0.5)
        async with open_joints(arm(port), VirtualClock()) as joints:
            await asyncio.sleep(0.2)
            assert joints.torque() == (False,)
            assert (await joints.read()).joints[0].errors == ("WATCHDOG_TIMER_EXPIRED",)


async def test_a_fault_is_typed_and_taken_back(port: int) -> None:
    with running(port) as child:
        async with open_joints(arm(port), VirtualClock()) as joints:
            tell(child, "silent 3")
            assert await becomes(joints, lambda age: age > 0.2)
            tell(child, "silent 3 off")
            assert await becomes(joints, lambda age: age < 0.1)
        tell(child, "quit")
        assert child.wait(timeout=20) == 0


async def becomes(joints: CanJoints, true: Callable[[float], bool], at_most: float = 10.0) -> bool:
    """Whether the joint's age becomes so before `at_most` (s) have passed."""
    for _ in range(round(at_most / 0.02)):
        if true((await joints.read()).joints[0].age):
            return True
        await asyncio.sleep(0.02)
    return False


def test_the_axes_are_those_of_the_config() -> None:
    (wrist,) = load(CONFIG)
    assert wrist == replace(WRIST, hardware={"node": 3, "gear_ratio": 8.0})
    assert math.isclose(wrist.max_velocity, 1.07)


@pytest.mark.parametrize(
    ("text", "complaint"),
    [("joints = 3", "joints"), ("joints = []", "no joint is on"), ("= 3", "cannot be read")],
)
def test_a_config_without_such_joints_is_refused(tmp_path: Path, text: str, complaint: str) -> None:
    file = tmp_path / "arm.toml"
    file.write_text(text)
    command = [sys.executable, "-m", "sim.can.process", "--config", str(file)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=30, stdin=subprocess.DEVNULL)
    assert done.returncode == 1
    assert complaint in done.stderr
    assert "Traceback" not in done.stderr
