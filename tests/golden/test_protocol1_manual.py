"""The examples of the manual, https://emanual.robotis.com/docs/en/dxl/protocol1/, byte for byte."""

import pytest

from drivers.dynamixel import protocol1
from drivers.dynamixel.packets import Status

INSTRUCTIONS = {
    "ping id 1": (protocol1.ping(1), "FF FF 01 02 01 FB"),
    "read the temperature of id 1": (protocol1.read(1, 43, 1), "FF FF 01 04 02 2B 01 CC"),
    "write id 1 to all": (protocol1.write(0xFE, 3, b"\x01"), "FF FF FE 04 03 03 01 F6"),
    "checksum example": (protocol1.write(1, 12, b"\x64\xaa"), "FF FF 01 05 03 0C 64 AA DC"),
    "register the goal 500": (protocol1.reg_write(1, 30, b"\xf4\x01"), "FF FF 01 05 04 1E F4 01 E2"),
    "action": (protocol1.action(), "FF FF FE 02 05 FA"),
    "sync write ids 0 and 1": (
        protocol1.sync_write(30, {0: b"\x10\x00\x50\x01", 1: b"\x20\x02\x60\x03"}),
        "FF FF FE 0E 83 1E 04 00 10 00 50 01 01 20 02 60 03 67",
    ),
}

STATUSES = {
    "ping": ("FF FF 01 02 00 FC", Status(1, 0, b"")),
    "temperature 32": ("FF FF 01 03 00 20 DB", Status(1, 0, b"\x20")),
    "overload and overheating": ("FF FF 01 02 24 D8", Status(1, 0x24, b"")),
    "bulk read, id 1": ("FF FF 01 04 00 00 80 7A", Status(1, 0, b"\x00\x80")),
    "bulk read, id 2": ("FF FF 02 04 00 00 80 79", Status(2, 0, b"\x00\x80")),
}

ELSEWHERE = {
    "read 8 bytes from 36": (protocol1.read(1, 36, 8), "FF FF 01 04 02 24 08 CC"),
    "torque on": (protocol1.write(1, 24, b"\x01"), "FF FF 01 04 03 18 01 DE"),
    "bulk read 34 to 43": (
        protocol1.bulk_read([1, 2], 34, 10),
        "FF FF FE 09 92 00 0A 01 22 0A 02 22 0B",
    ),
    "sync write 2048/67 and 1784/45": (
        protocol1.sync_write(30, {1: b"\x00\x08\x43\x00", 2: b"\xf8\x06\x2d\x00"}),
        "FF FF FE 0E 83 1E 04 01 00 08 43 00 02 F8 06 2D 00 D5",
    ),
}
"""Taken from a prototype that talks to `dynamixel-sdk`."""


@pytest.mark.parametrize("example", INSTRUCTIONS)
def test_an_instruction_is_encoded_as_in_the_manual(example: str) -> None:
    packet, expected = INSTRUCTIONS[example]
    assert packet == bytes.fromhex(expected)


@pytest.mark.parametrize("example", STATUSES)
def test_a_status_packet_of_the_manual_is_understood(example: str) -> None:
    packet, expected = STATUSES[example]
    assert protocol1.Parser().feed(bytes.fromhex(packet)) == [expected]


@pytest.mark.parametrize("example", ELSEWHERE)
def test_what_a_tick_sends_is_encoded_as_by_the_prototype(example: str) -> None:
    packet, expected = ELSEWHERE[example]
    assert packet == bytes.fromhex(expected)
