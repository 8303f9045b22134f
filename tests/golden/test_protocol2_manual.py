"""The examples of the manual, https://emanual.robotis.com/docs/en/dxl/protocol2/, byte for byte."""

import pytest

from drivers.dynamixel import protocol2
from drivers.dynamixel.packets import Status

INSTRUCTIONS = {
    "ping id 1": (protocol2.ping(1), "FF FF FD 00 01 03 00 01 19 4E"),
    "ping everybody": (protocol2.ping(0xFE), "FF FF FD 00 FE 03 00 01 31 42"),
    "read the position of id 1": (protocol2.read(1, 132, 4), "FF FF FD 00 01 07 00 02 84 00 04 00 1D 15"),
    "write the goal 512": (
        protocol2.write(1, 116, b"\x00\x02\x00\x00"),
        "FF FF FD 00 01 09 00 03 74 00 00 02 00 00 CA 89",
    ),
    "register the velocity 200": (
        protocol2.reg_write(1, 104, b"\xc8\x00\x00\x00"),
        "FF FF FD 00 01 09 00 04 68 00 C8 00 00 00 AE 8E",
    ),
    "action": (protocol2.action(1), "FF FF FD 00 01 03 00 05 02 CE"),
    "reboot": (protocol2.reboot(1), "FF FF FD 00 01 03 00 08 2F 4E"),
    "sync read two positions": (
        protocol2.sync_read([1, 2], 132, 4),
        "FF FF FD 00 FE 09 00 82 84 00 04 00 01 02 CE FA",
    ),
    "sync write the goals 150 and 170": (
        protocol2.sync_write(116, {1: b"\x96\x00\x00\x00", 2: b"\xaa\x00\x00\x00"}),
        "FF FF FD 00 FE 11 00 83 74 00 04 00 01 96 00 00 00 02 AA 00 00 00 82 87",
    ),
    "bulk read a voltage and a temperature": (
        protocol2.bulk_read({1: (144, 2), 2: (146, 1)}),
        "FF FF FD 00 FE 0D 00 92 01 90 00 02 00 02 92 00 01 00 1A 05",
    ),
}

STATUSES = {
    "ping, id 1": ("FF FF FD 00 01 07 00 55 00 06 04 26 65 5D", Status(1, 0, b"\x06\x04\x26")),
    "ping, id 2": ("FF FF FD 00 02 07 00 55 00 06 04 26 6F 6D", Status(2, 0, b"\x06\x04\x26")),
    "position 166": ("FF FF FD 00 01 08 00 55 00 A6 00 00 00 8C C0", Status(1, 0, b"\xa6\x00\x00\x00")),
    "position 2079": ("FF FF FD 00 02 08 00 55 00 1F 08 00 00 BA BE", Status(2, 0, b"\x1f\x08\x00\x00")),
    "confirmed": ("FF FF FD 00 01 04 00 55 00 A1 0C", Status(1, 0, b"")),
    "voltage 11.9": ("FF FF FD 00 01 06 00 55 00 77 00 C3 69", Status(1, 0, b"\x77\x00")),
    "temperature 36": ("FF FF FD 00 02 05 00 55 00 24 8B A9", Status(2, 0, b"\x24")),
}

ELSEWHERE = {
    "sync read 126 to 146": (
        protocol2.sync_read([1, 2], 126, 21),
        "FF FF FD 00 FE 09 00 82 7E 00 15 00 01 02 3E 1E",
    ),
    "write with stuffing": (
        protocol2.write(1, 116, (-131073).to_bytes(4, "little", signed=True)),
        "FF FF FD 00 01 0A 00 03 74 00 FF FF FD FD FF 23 E5",
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
    assert protocol2.Parser().feed(bytes.fromhex(packet)) == [expected]


@pytest.mark.parametrize("example", ELSEWHERE)
def test_what_a_tick_sends_is_encoded_as_by_the_prototype(example: str) -> None:
    packet, expected = ELSEWHERE[example]
    assert packet == bytes.fromhex(expected)
