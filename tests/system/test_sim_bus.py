"""`sim-bus` as a process: the servo maker's own SDK, and our driver, must find an arm behind the port.

Protocol 1.0; `test_sim_bus2` has protocol 2.0.
"""

import asyncio
import signal
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from dynamixel_sdk import COMM_SUCCESS, GroupBulkRead, GroupSyncWrite, PacketHandler, PortHandler

from bentod.contracts import ArmConfig
from bentod.frames import Freshness, Velocity
from drivers.dynamixel.joints import open_joints
from sim.bento import bento_joints
from sim.clock import VirtualClock
from tests.system.bus_processes import Process, ends, eventually, refused, running

pytestmark = pytest.mark.real_time

MODELS = {1: 310, 2: 320, 3: 29, 4: 29, 5: 29}
HANDLER = PacketHandler(1.0)


class Sdk:
    """The servo maker's SDK on one port."""

    def __init__(self, path: str, baud: int = 1_000_000) -> None:
        self.port = PortHandler(path)
        assert self.port.setBaudRate(baud)

    def read(self, servo: int, address: int, size: int) -> int | None:
        """A register's value; None when it did not answer."""
        data, result, _ = HANDLER.readTxRx(self.port, servo, address, size)
        return int.from_bytes(bytes(data), "little") if result == COMM_SUCCESS else None

    def write(self, servo: int, address: int, size: int, value: int) -> tuple[int, int]:
        """The SDK's result and the servo's error bits."""
        data = list(value.to_bytes(size, "little"))
        result, error = HANDLER.writeTxRx(self.port, servo, address, size, data)
        return result, error

    def ping(self, servo: int) -> int | None:
        """The model number; None when it did not answer."""
        model, result, _ = HANDLER.ping(self.port, servo)
        return int(model) if result == COMM_SUCCESS else None

    def bulk_read(self, servos: list[int], address: int, size: int) -> list[int]:
        """First two bytes of each servo's window."""
        group = GroupBulkRead(self.port, HANDLER)
        for servo in servos:
            group.addParam(servo, address, size)
        group.makeParam()
        # GroupBulkRead.txPacket calls bulkReadTx with an argument too many from 3.8.2 to 4.1.0.
        assert HANDLER.bulkReadTx(self.port, group.param, 3 * len(servos)) == COMM_SUCCESS
        assert group.rxPacket() == COMM_SUCCESS
        return [int(group.getData(servo, address, 2)) for servo in servos]


@contextmanager
def sdk(path: str, baud: int = 1_000_000) -> Iterator[Sdk]:
    client = Sdk(path, baud)
    try:
        yield client
    finally:
        client.port.closePort()


@pytest.fixture(scope="module")
def bus() -> Iterator[Process]:
    with running() as process:
        yield process


@pytest.fixture
def client(bus: Process) -> Iterator[Sdk]:
    with sdk(bus.port) as found:
        yield found
        for servo in MODELS:
            found.write(servo, 24, 1, 0)


def test_the_sdk_finds_every_servo(client: Sdk) -> None:
    assert {servo: client.ping(servo) for servo in MODELS} == MODELS


def test_the_sdk_gets_no_answer_from_a_servo_that_is_not_there(client: Sdk) -> None:
    assert client.ping(6) is None


def test_the_sdk_reads_back_what_it_writes(client: Sdk) -> None:
    assert client.write(3, 34, 2, 700) == (COMM_SUCCESS, 0)
    assert client.read(3, 34, 2) == 700
    assert client.write(3, 34, 2, 1023) == (COMM_SUCCESS, 0)


def test_the_sdk_is_told_that_a_goal_is_out_of_range(client: Sdk) -> None:
    assert client.write(5, 30, 2, 2801) == (COMM_SUCCESS, 2)


def test_the_sdk_moves_servos_by_sync_write_and_sees_them_move_by_themselves(client: Sdk) -> None:
    group = GroupSyncWrite(client.port, HANDLER, 30, 4)
    for servo, goal in ((3, 2148), (5, 1998)):
        assert group.addParam(servo, [goal % 256, goal // 256, 200, 0])
    assert group.txPacket() == COMM_SUCCESS
    assert eventually(lambda: client.read(3, 46, 1) == 0 and client.read(5, 46, 1) == 0)
    time.sleep(0.3)
    assert client.read(3, 36, 2) == pytest.approx(2148, abs=6)
    assert client.read(5, 36, 2) == pytest.approx(1998, abs=6)


def test_the_sdk_reads_all_servos_at_once(client: Sdk) -> None:
    voltages = client.bulk_read(list(MODELS), 42, 2)
    assert [voltage % 256 for voltage in voltages] == [120] * 5


def test_the_sdk_registers_a_write_for_later(client: Sdk) -> None:
    result, error = HANDLER.regWriteTxRx(client.port, 3, 25, 1, [1])
    assert (result, error) == (COMM_SUCCESS, 0)
    assert client.read(3, 25, 1) == 0
    HANDLER.action(client.port, 254)
    assert client.read(3, 25, 1) == 1
    client.write(3, 25, 1, 0)


def test_nobody_answers_at_another_baud_rate(bus: Process) -> None:
    with sdk(bus.port, baud=57_600) as stranger:
        assert stranger.ping(1) is None


def test_clients_come_and_go(bus: Process) -> None:
    for _ in range(3):
        with sdk(bus.port) as visitor:
            assert visitor.ping(1) == 310


def test_a_servo_falls_silent_on_command_and_answers_again(bus: Process, client: Sdk) -> None:
    bus.tell("silent 3")
    assert eventually(lambda: client.ping(3) is None)
    bus.tell("answer 3")
    assert eventually(lambda: client.ping(3) == 29)


async def test_our_driver_runs_an_arm_over_the_port(bus: Process) -> None:
    clock = VirtualClock()
    config = ArmConfig(bento_joints(), 1 / 30, {"port": bus.port})
    async with open_joints(config, clock) as joints:
        await joints.set_torque([False, False, False, False, True])
        before = (await joints.read()).joints[4].position
        fresh = 0
        for _ in range(30):
            fresh += (await joints.read()).joints[4].freshness is Freshness.FRESH
            await joints.write([None] * 4 + [Velocity(0.4)])
            await asyncio.sleep(1 / 30)
        assert fresh > 20
        assert 0.2 < (await joints.read()).joints[4].position - before < 0.8
        await joints.set_torque([False] * 5)


def test_a_pulled_port_vanishes_and_comes_back_under_its_link(tmp_path: Path) -> None:
    link = tmp_path / "port"
    with running("--link", str(link)) as process:
        assert str(link.resolve()) == process.port
        process.tell("pull")
        assert eventually(lambda: not link.is_symlink())
        process.tell("plug")
        assert process.line() == str(link.resolve())
        with sdk(str(link)) as found:
            assert found.ping(2) == 320


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_ends_it_cleanly(tmp_path: Path, number: signal.Signals) -> None:
    link = tmp_path / "port"
    with running("--link", str(link)) as process:
        process.child.send_signal(number)
        assert ends(process) == 0
    assert not link.is_symlink()


def test_a_link_that_leads_elsewhere_is_not_touched(tmp_path: Path) -> None:
    link = tmp_path / "port"
    link.symlink_to(tmp_path / "elsewhere")
    done = refused("--link", str(link))
    assert "--link" in done
    assert link.is_symlink()


def test_the_link_of_a_bus_that_was_killed_is_taken_over(tmp_path: Path) -> None:
    link = tmp_path / "port"
    with running("--link", str(link)) as killed:
        killed.child.kill()
        ends(killed)
        assert link.is_symlink()
        with running("--link", str(link)) as process:
            assert str(link.resolve()) == process.port


def test_the_word_quit_ends_it() -> None:
    with running() as process:
        process.tell("quit")
        assert ends(process) == 0


def test_it_outlives_its_input_unless_asked() -> None:
    with running() as staying, running("--exit-on-eof") as leaving:
        staying.end_input()
        leaving.end_input()
        assert ends(leaving) == 0
        with sdk(staying.port) as found:
            assert found.ping(1) == 310


def test_the_word_help_lists_commands_and_faults() -> None:
    with running() as process:
        process.tell("help")
        lines = process.lines(5)
        assert lines[0].startswith("pull")
        assert {"silent", "reboot", "wrong_model", "id_clash"} <= set(lines[4].split(": ")[1].split(", "))


def test_an_adapter_with_a_slow_latency_timer_delays_every_reply(tmp_path: Path) -> None:
    config = tmp_path / "arm.toml"
    config.write_text(CONFIG.replace("seed = 3", "usb_latency_s = 0.016"))
    with running("--config", str(config)) as process, sdk(process.port) as found:
        times = []
        for _ in range(5):
            began = time.monotonic()
            assert found.read(17, 36, 2) is not None
            times.append(time.monotonic() - began)
        assert min(times) > 0.014


def test_a_servo_is_blocked_or_reset_or_another_one_on_command(bus: Process, client: Sdk) -> None:
    bus.tell("wrong_model 4")
    assert eventually(lambda: client.ping(4) == 12)
    bus.tell("wrong_model 4 off")
    assert eventually(lambda: client.ping(4) == 29)
    client.write(4, 25, 1, 1)
    bus.tell("reboot 4")
    assert eventually(lambda: client.read(4, 25, 1) == 0)


def test_a_command_that_is_not_understood_is_answered_with_a_sentence() -> None:
    with running() as process:
        process.tell("sulk 3")
        process.tell("quit")
        assert ends(process) == 0
        assert process.child.stderr
        assert "there is no fault 'sulk'" in process.child.stderr.read()


CONFIG = """
[driver]
name = "sim"
seed = 3

[[joints]]
name = "elbow_flexion"
min_rad = -0.4
max_rad = 0.8
max_velocity_rad_s = 0.5
hardware = { id = 17, model = "MX-64" }
"""


def test_the_servos_are_those_of_the_config(tmp_path: Path) -> None:
    config = tmp_path / "arm.toml"
    config.write_text(CONFIG)
    with running("--config", str(config), "--no-timing") as process, sdk(process.port) as found:
        assert found.ping(17) == 310
        assert found.ping(1) is None
        assert found.read(17, 6, 2) == 2048 - 261


@pytest.mark.parametrize(
    ("change", "complaint"),
    [(("MX-64", "MX-65"), "model"), (("min_rad", "min_deg"), "min_rad"), (("[driver]", "[driver"), "read")],
)
def test_a_config_that_makes_no_sense_is_refused(
    tmp_path: Path, change: tuple[str, str], complaint: str
) -> None:
    config = tmp_path / "arm.toml"
    config.write_text(CONFIG.replace(*change))
    assert complaint in refused("--config", str(config))
