"""A scripted servo with firmware for protocol 2.0: what opening it looks like on the wire."""

from dataclasses import dataclass, field, replace

from bentod.contracts import ArmConfig
from bentod.frames import JointSpec
from tests.drivers.dynamixel.arm import CONFIG, ELBOW, WRIST
from tests.drivers.dynamixel.wire import Wire, word
from tests.drivers.dynamixel.wire2 import framed2, long, status2

ELBOW_2 = replace(ELBOW, hardware={"id": 2, "model": "MX-106(2.0)"})
WRIST_2 = replace(WRIST, hardware={"id": 3, "model": "MX-28(2.0)"})
ONE_2 = replace(CONFIG, joints=(WRIST_2,))


@dataclass(slots=True)
class Found2:
    """What a servo shows when it is looked at; `changed`: bytes by address."""

    id: int
    number: int
    changed: dict[int, bytes] = field(default_factory=dict)
    position: int = 2048

    def memory(self) -> bytearray:
        table = bytearray(200)
        usual = {
            0: bytes(word(self.number)),
            6: bytes((45, self.id, 3, 0, 0, 3, 255, 2)),
            44: long(435) + long(4095) + long(0),
            63: b"\x34",
            68: b"\x02",
            126: window2(self.position),
        }
        for address, data in (*usual.items(), *self.changed.items()):
            table[address : address + len(data)] = data
        return table


def window2(position: int = 2048, load: int = 0, velocity: int = 0) -> bytes:
    """Registers 126 to 146, the trajectory where the joint is."""
    low = load.to_bytes(2, "little", signed=True)
    return low + long(velocity) + long(position) + long(velocity) + long(position) + b"\x78\x00\x1f"


def read2(id_: int, address: int, size: int) -> bytes:
    return framed2(id_, 2, *word(address), *word(size))


def write2(id_: int, address: int, data: bytes) -> bytes:
    return framed2(id_, 3, *word(address), *data)


def sync_read2(window: tuple[int, int], *ids: int) -> bytes:
    return framed2(0xFE, 0x82, *word(window[0]), *word(window[1]), *ids)


def expect_read2(wire: Wire, found: Found2, address: int, size: int, error: int = 0) -> None:
    data = found.memory()[address : address + size]
    wire.expect(read2(found.id, address, size), status2(found.id, *data, error=error))


def expect_write2(wire: Wire, id_: int, address: int, data: bytes) -> None:
    wire.expect(write2(id_, address, data), status2(id_))


RUNS = ((0, 2), (0, 14), (20, 4), (44, 12), (63, 2), (68, 3), (98, 1), (64, 1), (126, 21))
"""What an audit reads; no run has an undefined address in it."""


def expect_audit2(wire: Wire, found: Found2) -> None:
    """A servo that is looked at and found good."""
    wire.expect(framed2(found.id, 1), status2(found.id, *word(found.number), 45))
    for address, size in RUNS:
        expect_read2(wire, found, address, size)


def elbow2() -> Found2:
    return Found2(2, 321)


def wrist2() -> Found2:
    return Found2(3, 30)


def config2(*joints: JointSpec) -> ArmConfig:
    return replace(CONFIG, joints=joints)
