"""`sim-bus` with servos of both protocols: the servo maker's own SDK must find them behind the port."""

import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from dynamixel_sdk import (
    COMM_RX_CORRUPT,
    COMM_RX_TIMEOUT,
    COMM_SUCCESS,
    GroupBulkRead,
    GroupBulkWrite,
    GroupSyncRead,
    GroupSyncWrite,
    PacketHandler,
    PortHandler,
)

from tests.system.bus_processes import Process, eventually, running

pytestmark = pytest.mark.real_time

MODELS = {4: 311, 7: 30, 11: 321}
HANDLER = PacketHandler(2.0)
GOAL, PROFILE, POSITION, TORQUE, MOVING = 116, 112, 132, 64, 122

JOINT = """
[[joints]]
name = "joint_{id}"
min_rad = -1.5
max_rad = 1.5
hardware = {{ id = {id}, model = "{model}" }}
"""


@pytest.fixture(scope="module")
def bus(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Process]:
    names = {4: "MX-64(2.0)", 7: "MX-28(2.0)", 11: "MX-106(2.0)", 2: "MX-28", 3: "AX-12A"}
    config: Path = tmp_path_factory.mktemp("bus") / "arm.toml"
    config.write_text("".join(JOINT.format(id=id_, model=model) for id_, model in names.items()))
    with running("--config", str(config)) as process:
        yield process


@contextmanager
def opened(path: str, baud: int = 1_000_000) -> Iterator[PortHandler]:
    port = PortHandler(path)
    assert port.setBaudRate(baud)
    try:
        yield port
    finally:
        port.closePort()


@pytest.fixture
def port(bus: Process) -> Iterator[PortHandler]:
    with opened(bus.port) as found:
        yield found
        for servo in MODELS:
            HANDLER.write1ByteTxRx(found, servo, TORQUE, 0)


def read(port: PortHandler, servo: int, address: int, size: int) -> int | None:
    data, result, _ = HANDLER.readTxRx(port, servo, address, size)
    return int.from_bytes(bytes(data), "little", signed=True) if result == COMM_SUCCESS else None


def write(port: PortHandler, servo: int, address: int, size: int, value: int) -> tuple[int, int]:
    data = list(value.to_bytes(size, "little", signed=value < 0))
    result, error = HANDLER.writeTxRx(port, servo, address, size, data)
    return result, error


def ping(port: PortHandler, servo: int) -> int | None:
    model, result, _ = HANDLER.ping(port, servo)
    return int(model) if result == COMM_SUCCESS else None


def test_the_sdk_finds_every_servo(port: PortHandler) -> None:
    assert {servo: ping(port, servo) for servo in MODELS} == MODELS


def test_a_broadcast_ping_finds_all_of_protocol_2_at_once(port: PortHandler) -> None:
    found, result = HANDLER.broadcastPing(port)
    assert result == COMM_SUCCESS
    assert {servo: model for servo, (model, _) in found.items()} == MODELS


def test_servos_of_both_protocols_are_found_on_one_line(port: PortHandler) -> None:
    old = PacketHandler(1.0)
    assert {servo: old.ping(port, servo)[0] for servo in (2, 3)} == {2: 29, 3: 12}
    assert old.ping(port, 4)[1] == COMM_RX_TIMEOUT
    assert ping(port, 2) is None


def test_the_sdk_reads_back_what_it_writes(port: PortHandler) -> None:
    assert write(port, 7, 84, 2, 700) == (COMM_SUCCESS, 0)
    assert read(port, 7, 84, 2) == 700
    assert write(port, 7, 84, 2, 850) == (COMM_SUCCESS, 0)


@pytest.mark.parametrize(
    ("address", "size", "value", "number"), [(GOAL, 4, 4000, 6), (65, 1, 2, 4), (POSITION, 4, 0, 7)]
)
def test_the_sdk_is_told_by_number_what_is_wrong(
    port: PortHandler, address: int, size: int, value: int, number: int
) -> None:
    assert write(port, 4, address, size, value) == (COMM_SUCCESS, number)


def test_the_sdk_moves_servos_by_sync_write_and_watches_them_by_sync_read(port: PortHandler) -> None:
    reader = GroupSyncRead(port, HANDLER, POSITION, 4)
    group = GroupSyncWrite(port, HANDLER, PROFILE, 8)
    for servo, goal in ((4, 2148), (11, 1998)):
        write(port, servo, TORQUE, 1, 1)
        assert group.addParam(servo, [200, 0, 0, 0, *goal.to_bytes(4, "little")])
        assert reader.addParam(servo)
    assert group.txPacket() == COMM_SUCCESS

    def there() -> bool:
        if reader.txRxPacket() != COMM_SUCCESS:
            return False
        found = [reader.getData(servo, POSITION, 4) for servo in (4, 11)]
        return found == pytest.approx([2148, 1998], abs=8)

    assert eventually(there)


def test_a_bulk_read_and_a_bulk_write_address_each_servo_differently(port: PortHandler) -> None:
    writer = GroupBulkWrite(port, HANDLER)
    assert writer.addParam(4, 65, 1, [1])
    assert writer.addParam(7, PROFILE, 4, [9, 0, 0, 0])
    assert writer.txPacket() == COMM_SUCCESS
    reader = GroupBulkRead(port, HANDLER)
    for servo, address, size in ((4, 65, 1), (7, PROFILE, 4), (11, 144, 3)):
        assert reader.addParam(servo, address, size)
    assert reader.txRxPacket() == COMM_SUCCESS
    assert (reader.getData(4, 65, 1), reader.getData(7, PROFILE, 4)) == (1, 9)
    assert reader.getData(11, 144, 2) == 120


def test_fast_reads_are_not_answered(port: PortHandler) -> None:
    reader = GroupSyncRead(port, HANDLER, POSITION, 4)
    assert reader.addParam(4)
    assert reader.fastSyncRead() in (COMM_RX_TIMEOUT, COMM_RX_CORRUPT)


def test_a_reboot_forgets_what_is_not_eeprom(port: PortHandler) -> None:
    write(port, 7, PROFILE, 4, 99)
    assert HANDLER.reboot(port, 7) == (COMM_SUCCESS, 0)
    assert ping(port, 7) is None
    assert eventually(lambda: ping(port, 7) == 30)
    assert read(port, 7, PROFILE, 4) == 0


def test_a_hardware_error_alerts_until_a_reboot(bus: Process, port: PortHandler) -> None:
    bus.tell("overload 11")
    assert eventually(lambda: HANDLER.ping(port, 11)[2] == 0x80)
    assert read(port, 11, 70, 1) == 32
    bus.tell("overload 11 off")
    HANDLER.reboot(port, 11)
    assert eventually(lambda: HANDLER.ping(port, 11)[1:] == (COMM_SUCCESS, 0))


def test_the_watchdog_trips_when_the_host_falls_silent(port: PortHandler) -> None:
    assert write(port, 4, 98, 1, 5) == (COMM_SUCCESS, 0)
    assert eventually(lambda: tripped_after_silence(port))
    assert write(port, 4, GOAL, 4, 2048) == (COMM_SUCCESS, 4)
    assert write(port, 4, 98, 1, 0) == (COMM_SUCCESS, 0)


def tripped_after_silence(port: PortHandler) -> bool:
    """Talk to another servo for longer than the 0.1 s that this one waits."""
    enough = time.monotonic() + 0.2
    while time.monotonic() < enough:
        read(port, 7, 146, 1)
    return read(port, 4, 98, 1) == -1
