"""Every config that is shipped means what it says: it is checked, explained, and run."""

import asyncio
import math
import re
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from bentod.cli.check import check
from bentod.cli.configs import read
from bentod.client import Client
from bentod.config import Config
from bentod.contracts import ArmConfig
from bentod.daemon import Daemon
from bentod.supervise import Supervisor
from drivers.dynamixel import joints
from sim.bento import build_arm, build_bus
from sim.clock import VirtualClock
from sim.line import Line
from sim.options import parse_options
from tests.rig import CONFIGS, Table, joint, number, table, tables

SHIPPED = sorted(path.name for path in CONFIGS.glob("*.toml"))
RECORDING = Path(__file__).parents[3] / "shared" / "data" / "libemg_myo_200hz.npz"
TICKS = 60
RATE_HZ = 200


@pytest.fixture
async def plugged(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whoever opens a serial port finds a simulated Bento Arm on it."""
    config = read(CONFIGS / "bento.toml")
    arm = ArmConfig(tuple(joint.spec() for joint in config.joints), 1 / config.rate_hz, {})
    options = parse_options(arm)
    servos = build_arm(arm, options, asyncio.get_running_loop().time())
    line = Line(build_bus(servos, arm, options), servos)
    monkeypatch.setattr(joints, "open_serial", lambda port, baud: line)


async def run(config: Config, socket: Path, ticks: int = TICKS) -> tuple[list[Table], str]:
    """Frames of a run in virtual time, and how it left the arm."""
    daemon = Daemon(config, VirtualClock(), Supervisor(), socket)
    task = asyncio.create_task(daemon.run(ticks))
    await asyncio.sleep(0.05)
    async with Client.connect(socket) as arm, arm.listen("state", 500) as stream:
        frames = [await anext(stream) for _ in range(ticks - 10)]
    return frames, await task


@pytest.mark.parametrize("name", SHIPPED)
def test_a_shipped_config_has_no_mistakes_and_explains_itself(name: str) -> None:
    done = CliRunner().invoke(check, [str(CONFIGS / name)])
    assert (done.exit_code, done.stderr) == (0, "")
    assert re.search(r"5 joints on (the driver|2 drivers)", done.stdout)
    assert re.search(r"Group arm: \w+ → \w+\.", done.stdout)


def test_the_configs_that_readers_are_told_of_are_shipped() -> None:
    assert SHIPPED == [
        "bento.toml",
        "clinic.toml",
        "joystick.toml",
        "myo.toml",
        "nexting.toml",
        "patterns.toml",
        "sim.toml",
        "wrist.toml",
    ]


@pytest.mark.usefixtures("plugged")
@pytest.mark.parametrize("name", SHIPPED)
async def test_a_shipped_config_runs_at_its_rate_without_a_fault(tmp_path: Path, name: str) -> None:
    config = read(CONFIGS / name)
    frames, left = await run(config, tmp_path / "s")
    assert left == "The arm was left limp."
    last = frames[-1]
    assert last["fault"] == ""
    # To switch on five servos takes longer than a tick, and a motor on CAN confirms it every 0.1 s.
    assert number(last, "missed") <= (4 if name == "wrist.toml" else 1)
    assert last["mode"] == ("active" if config.safety.start == "active" else "limp")
    assert all(found["freshness"] == "fresh" for found in tables(last, "joints"))
    assert config.learn is not None
    timescales = {f"{timescale:g}" for timescale in config.learn.timescales}
    assert len(timescales) == 2
    assert all(predictions(found, timescales) for found in tables(last, "joints"))


def predictions(found: Table, timescales: set[str]) -> bool:
    """Whether a joint is predicted at all of them."""
    expected = table(found["predictions"])
    return expected.keys() == timescales and all(math.isfinite(number(expected, key)) for key in expected)


@pytest.mark.usefixtures("plugged")
async def test_the_real_arm_starts_limp_and_does_not_move_by_itself(tmp_path: Path) -> None:
    frames, _ = await run(read(CONFIGS / "bento.toml"), tmp_path / "s")
    assert not any(found["torque"] for frame in frames for found in tables(frame, "joints"))
    assert all(found["sent"] is None for frame in frames for found in tables(frame, "joints"))


def armband(path: Path, channel: int) -> None:
    """Counts of an eight-channel armband, of which one channel contracts from 0.5 s on."""
    counts = np.zeros((2 * RATE_HZ, 8), np.int8)
    random = np.random.default_rng(1)
    muscle = random.integers(30, 51, 2 * RATE_HZ) * random.choice([-1, 1], 2 * RATE_HZ)
    counts[RATE_HZ // 2 :, channel] = muscle[RATE_HZ // 2 :]
    np.savez(path, emg=counts, fs=RATE_HZ)


@pytest.mark.parametrize(("channel", "direction"), [(0, 1), (2, -1)])
async def test_an_armband_moves_the_shoulder_both_ways(tmp_path: Path, channel: int, direction: int) -> None:
    armband(tmp_path / "armband.npz", channel)
    frames, _ = await run(read(CONFIGS / "myo.toml", f"replay:{tmp_path / 'armband.npz'}"), tmp_path / "s")
    assert number(joint(frames[5], "shoulder_rotation"), "position") == pytest.approx(0, abs=0.01)
    assert direction * number(joint(frames[-1], "shoulder_rotation"), "position") > 0.3


async def test_an_armband_toggles_once_a_contraction(tmp_path: Path) -> None:
    armband(tmp_path / "armband.npz", 7)
    frames, _ = await run(read(CONFIGS / "myo.toml", f"replay:{tmp_path / 'armband.npz'}"), tmp_path / "s")
    assert tables(frames[-1], "groups")[0]["active"] == "elbow_flexion"
    assert number(table(frames[-1]["emg"]), "toggles") == 1


@pytest.mark.skipif(not RECORDING.exists(), reason="the recording is not beside the checkout")
async def test_a_real_armband_drives_the_arm_for_ten_seconds(tmp_path: Path) -> None:
    config = read(CONFIGS / "myo.toml", f"replay:{RECORDING}#emg")
    frames, left = await run(config, tmp_path / "s", ticks=300)
    muscles = table(frames[-1]["emg"])
    assert (muscles["problem"], muscles["dropped"]) == ("", 0)
    assert number(muscles, "next_index") == pytest.approx(number(frames[-1], "time") * RATE_HZ, abs=10)
    way = [number(joint(frame, "shoulder_rotation"), "position") for frame in frames]
    assert max(way) - min(way) > 0.2
    assert left == "The arm was left limp."
