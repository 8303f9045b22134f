import asyncio
import os
import pty
import tty
from collections.abc import Iterator
from dataclasses import replace

import pytest

from bentod.clock import SystemClock
from bentod.frames import Freshness, Stop
from drivers.dynamixel.joints import open_joints
from tests.drivers.dynamixel.arm import BULK, CONFIG, elbow, expect_audit, window, wrist
from tests.drivers.dynamixel.wire import Wire

pytestmark = pytest.mark.real_time


class Servos:
    """Servos behind a pseudo-terminal: each request that the script holds has its reply, at any time."""

    def __init__(self, script: Wire) -> None:
        self.replies = {exchange.sent: b"".join(exchange.replies) for exchange in script.script}
        self.unknown: list[bytes] = []
        self.surprised = asyncio.Event()
        self.fd, self._near = pty.openpty()
        tty.setraw(self._near)
        self.port = os.ttyname(self._near)

    def serve(self) -> None:
        asyncio.get_running_loop().add_reader(self.fd, self._reply)

    def close(self) -> None:
        os.close(self.fd)
        os.close(self._near)

    def _reply(self) -> None:
        request = os.read(self.fd, 4096)
        if request in self.replies:
            os.write(self.fd, self.replies[request])
        else:
            self.unknown.append(request)
            self.surprised.set()


@pytest.fixture
def servos(wire: Wire) -> Iterator[Servos]:
    for found in (replace(elbow(), torque=1), replace(wrist(), torque=1)):
        expect_audit(wire, found)
    wire.expect(BULK, window(2, 2050), window(3, 2052))
    servos = Servos(wire)
    yield servos
    servos.close()


async def test_an_arm_is_opened_read_and_written_over_a_serial_port(servos: Servos) -> None:
    servos.serve()
    # A wide margin: the machine that runs this test may be busy.
    config = replace(CONFIG, options={"port": servos.port, "reply_margin_s": 0.1, "dead_man_s": 0})
    async with asyncio.timeout(10), open_joints(config, SystemClock()) as joints:
        assert joints.torque() == (True, True)
        state = await joints.read()
        assert [joint.freshness for joint in state.joints] == [Freshness.FRESH, Freshness.FRESH]
        assert all(0 <= joint.age < 1 for joint in state.joints)
        await joints.write([Stop(), Stop()])
        await servos.surprised.wait()
    assert servos.unknown == [bytes.fromhex("FF FF FE 0E 83 1E 04 02 02 08 05 00 03 04 08 05 00 29")]
