import asyncio

import pytest

from bentod.errors import BusError
from drivers.stream import ByteStream
from sim.arm import Arm
from sim.dynamixel import tables1
from sim.dynamixel.bus import Bus
from sim.dynamixel.models import build_device
from sim.line import Line
from sim.servo import Servo
from sim.servo_models import MX_28
from sim.shaft import Link

PING = bytes.fromhex("FF FF 01 02 01 FB")
PONG = bytes.fromhex("FF FF 01 02 00 FC")
PROVISIONED = {tables1.BAUD: 1, tables1.RETURN_DELAY: 0}


class Host:
    """Who listens at the other end."""

    def __init__(self, seed: str = "") -> None:
        self.arm = Arm([Servo(MX_28, Link())])
        bus = Bus([build_device(self.arm.servos[0], PROVISIONED)])
        self.line = Line(bus, self.arm, seed)
        self.heard: list[tuple[float, bytes]] = []
        self.lost: list[str] = []
        self.line.listen(self.hear, self.lost.append)

    def hear(self, data: bytes) -> None:
        self.heard.append((asyncio.get_running_loop().time(), data))

    async def ping(self, times: int = 1) -> list[bytes]:
        """What came back in all."""
        self.heard.clear()
        for _ in range(times):
            self.line.write(PING)
            await asyncio.sleep(0.02)
        return [data for _, data in self.heard]


async def test_a_line_is_a_byte_stream() -> None:
    stream: ByteStream = Host().line
    stream.close()
    stream.close()


async def test_a_reply_comes_after_its_time_on_the_wire() -> None:
    host = Host()
    assert await host.ping() == [PONG]
    assert host.heard[0][0] == pytest.approx(60e-6 + 50e-6 + 60e-6 + 0.001)


async def test_what_is_written_at_once_waits_for_the_wire() -> None:
    host = Host()
    host.line.write(PING)
    host.line.write(PING)
    await asyncio.sleep(0.01)
    first, second = (time for time, _ in host.heard)
    assert second - first == pytest.approx(170e-6)


async def test_a_flood_does_not_book_the_wire_for_long() -> None:
    host = Host()
    for _ in range(100):
        host.line.write(bytes(4096))
    host.line.write(PING)
    await asyncio.sleep(0.2)
    assert [data for _, data in host.heard] == [PONG]


async def test_using_the_line_lets_the_arm_live() -> None:
    host = Host()
    await asyncio.sleep(0.5)
    host.line.write(PING)
    assert host.arm.time == pytest.approx(0.5)


async def test_a_lossy_line_loses_some_packets_always_the_same() -> None:
    async def answered(seed: str) -> int:
        host = Host(seed)
        host.line.drop = 0.3
        return len(await host.ping(50))

    once, again = await answered("a"), await answered("a")
    assert 5 < once < 45
    assert once == again


async def test_a_corrupting_line_never_delivers_a_right_answer() -> None:
    host = Host()
    host.line.corrupt = 1.0
    heard = await host.ping(20)
    assert heard
    assert PONG not in heard


async def test_a_truncated_line_never_delivers_a_whole_packet() -> None:
    host = Host()
    host.line.truncate = 1.0
    assert PONG not in await host.ping(5)


async def test_a_duplicated_request_is_answered_twice_and_each_answer_doubled() -> None:
    host = Host()
    host.line.duplicate = 1.0
    assert await host.ping() == [PONG] * 4


async def test_a_late_reply_is_late() -> None:
    host = Host()
    host.line.delay = 0.015
    await host.ping()
    assert host.heard[0][0] > 0.016


async def test_a_slow_adapter_is_slow_for_every_line_of_the_arm() -> None:
    host = Host()
    host.arm.latency = 0.015
    await host.ping()
    assert host.heard[0][0] > 0.016


async def test_an_echo_comes_before_the_reply() -> None:
    host = Host()
    host.line.echo = True
    assert await host.ping() == [PING, PONG]


async def test_half_a_packet_is_forgotten_after_a_while() -> None:
    host = Host()
    host.line.write(PING[:4] + b"\x05")
    await asyncio.sleep(0.2)
    assert await host.ping() == [PONG]


async def test_a_pulled_cable_is_told_once_and_swallows_what_is_underway() -> None:
    host = Host()
    host.line.write(PING)
    host.arm.inject("cable", None, True)
    await asyncio.sleep(0.1)
    assert (host.heard, host.lost) == ([], ["The simulated cable is pulled."])
    with pytest.raises(BusError, match="cable"):
        host.line.write(PING)


async def test_a_cable_that_is_back_carries_bytes_for_whoever_listens_anew() -> None:
    host = Host()
    host.arm.inject("cable", None, True)
    host.arm.inject("cable", None, False)
    host.line.listen(host.hear, host.lost.append)
    assert await host.ping() == [PONG]


async def test_listening_to_a_pulled_cable_tells_so() -> None:
    host = Host()
    host.arm.inject("cable", None, True)
    await asyncio.sleep(0)
    host.line.listen(host.hear, host.lost.append)
    await asyncio.sleep(0.01)
    assert len(host.lost) == 2


async def test_a_closed_line_delivers_nothing_and_takes_nothing() -> None:
    host = Host()
    host.line.write(PING)
    host.line.close()
    await asyncio.sleep(0.1)
    assert host.heard == []
    with pytest.raises(BusError):
        host.line.write(PING)
