"""A scripted arm of two servos: what opening it looks like on the wire."""

from contextlib import AbstractAsyncContextManager
from dataclasses import dataclass

from bentod.contracts import ArmConfig
from bentod.frames import JointSpec
from drivers.dynamixel.joints import DynamixelJoints, open_over
from sim.clock import VirtualClock
from tests.drivers.dynamixel.wire import Wire, framed, status, word

ELBOW = JointSpec("elbow_flexion", -0.405, 0.801, 0.55, 0.0, {"id": 2, "model": "MX-106"})
WRIST = JointSpec("wrist_rotation", -1.564, 1.572, 1.08, 0.0, {"id": 3, "model": "MX-28"})
CONFIG = ArmConfig((ELBOW, WRIST), 1 / 30, {"port": "scripted", "attempts": 2, "dead_man_s": 0})

BULK = "FF FF FE 09 92 00 0A 02 22 0A 03 22 09"  # 10 bytes from 34, ids 2 and 3


@dataclass(slots=True)
class Found:
    """What a servo shows when it is looked at."""

    id: int
    number: int
    special: bool  # has Torque Ctrl Mode Enable
    cw: int = 1024
    ccw: int = 3073
    delay: int = 0
    level: int = 2
    shutdown: int = 36
    drive_mode: int = 0
    torque_mode: int = 0
    torque: int = 0
    position: int = 2048

    def settings(self) -> bytes:
        """Registers 0 to 18."""
        limits = (*word(self.cw), *word(self.ccw))
        head = (*word(self.number), 41, self.id, 1, self.delay, *limits)
        tail = (self.drive_mode, 80, 60, 160, *word(1023), self.level, 36, self.shutdown)
        return status(self.id, *head, *tail)


def elbow() -> Found:
    return Found(2, 320, special=True, cw=1784, ccw=2570)


def wrist() -> Found:
    return Found(3, 29, special=False)


def window(
    id_: int, position: int = 2048, speed: int = 0, load: int = 0, limit: int = 1023, error: int = 0
) -> bytes:
    """A reply with registers 34 to 43."""
    values = (*word(limit), *word(position), *word(speed), *word(load), 120, 31)
    return status(id_, *values, error=error)


def longer(reply: bytes, *more: int) -> bytes:
    """`reply` to a question for a window that goes on after the usual one."""
    return status(reply[2], *reply[5:-1], *more, error=reply[4])


def bulk(size: int, *ids: int) -> bytes:
    """A bulk read of `size` bytes from 34."""
    return framed(0xFE, 3 * len(ids) + 3, 0x92, 0, *(byte for id_ in ids for byte in (size, id_, 34)))


def read(id_: int, address: int, size: int) -> bytes:
    return framed(id_, 4, 2, address, size)


def write(id_: int, address: int, *data: int) -> bytes:
    return framed(id_, 3 + len(data), 3, address, *data)


def expect_audit(wire: Wire, found: Found) -> None:
    """A servo that is looked at and found good."""
    wire.expect(framed(found.id, 2, 1), status(found.id))
    wire.expect(read(found.id, 0, 2), status(found.id, *word(found.number)))
    wire.expect(read(found.id, 0, 19), found.settings())
    if found.special:
        wire.expect(read(found.id, 70, 1), status(found.id, found.torque_mode))
    wire.expect(read(found.id, 24, 1), status(found.id, found.torque))
    wire.expect(read(found.id, 34, 10), window(found.id, found.position))


def expect_torque_on(wire: Wire, id_: int, position: int = 2048) -> None:
    """Read, set the gains, pin at raw speed 5, switch on, read back."""
    wire.expect(read(id_, 34, 10), window(id_, position))
    wire.expect(write(id_, 28, 32), status(id_))
    wire.expect(write(id_, 73, 0), status(id_))
    wire.expect(write(id_, 30, *word(position), 5, 0), status(id_))
    wire.expect(write(id_, 24, 1), status(id_))
    wire.expect(read(id_, 24, 1), status(id_, 1))


def expect_torque_off(wire: Wire, id_: int) -> None:
    """Switch off, read back."""
    wire.expect(write(id_, 24, 0), status(id_))
    wire.expect(read(id_, 24, 1), status(id_, 0))


def opened(
    wire: Wire, clock: VirtualClock, *found: Found, config: ArmConfig = CONFIG
) -> AbstractAsyncContextManager[DynamixelJoints]:
    """The arm, opened over servos as `found` (both good and limp, if none are given)."""
    servos = found or (elbow(), wrist())
    for servo in servos:
        expect_audit(wire, servo)
    if len(servos) > 1:
        wire.expect(BULK, *(window(servo.id, servo.position) for servo in servos))
    return open_over(lambda: wire, config, clock)
