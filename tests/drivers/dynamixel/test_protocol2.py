import pytest
from dynamixel_sdk import GroupSyncWrite, Protocol2PacketHandler
from hypothesis import given
from hypothesis import strategies as st

from drivers.dynamixel import protocol2
from drivers.dynamixel.packets import Status
from drivers.dynamixel.protocol2 import Parser
from tests.drivers.dynamixel.sdk import SdkPort
from tests.drivers.dynamixel.wire2 import crc, framed2, status2

IDS = st.integers(0, 0xFC)
ADDRESSES = st.integers(0, 0xFFFF)
TEMPERATURE = status2(1, 0x20)

HEADERISH = st.lists(st.sampled_from([0xFF, 0xFF, 0xFD, 0x00, 0x55]), max_size=24).map(bytes)
"""Bytes among which headers, and what must be stuffed, are frequent."""

DATA = st.one_of(st.binary(max_size=60), HEADERISH)


def needs_stuffing(packet: bytes) -> bool:
    return b"\xff\xff\xfd" in packet[7:]


@given(st.binary(max_size=200))
def test_the_crc_is_the_manuals(data: bytes) -> None:
    assert protocol2.crc16(data) == crc(data)


@given(id_=IDS, address=ADDRESSES, size=ADDRESSES)
def test_a_read_is_what_the_official_sdk_sends(id_: int, address: int, size: int) -> None:
    port = SdkPort()
    Protocol2PacketHandler().readTx(port, id_, address, size)
    assert protocol2.read(id_, address, size) == port.sent or needs_stuffing(port.sent)


@given(id_=IDS, address=ADDRESSES, data=DATA.filter(len))
def test_a_write_is_what_the_official_sdk_sends_unless_it_forgets_the_stuffing(
    id_: int, address: int, data: bytes
) -> None:
    port = SdkPort()
    Protocol2PacketHandler().writeTxOnly(port, id_, address, len(data), data)
    ours = protocol2.write(id_, address, data)
    assert ours == framed2(id_, 3, address % 256, address // 256, *data)
    assert (ours == port.sent) is not needs_stuffing(port.sent)


@given(id_=IDS)
def test_ping_and_reboot_are_what_the_official_sdk_sends(id_: int) -> None:
    port = SdkPort()
    Protocol2PacketHandler().ping(port, id_)
    assert protocol2.ping(id_) == port.sent
    port = SdkPort()
    Protocol2PacketHandler().reboot(port, id_)
    assert protocol2.reboot(id_) == port.sent


@given(st.dictionaries(IDS, st.integers(0, 0x7FFFFFFF).map(lambda v: v.to_bytes(4, "little")), min_size=1))
def test_a_sync_write_is_what_the_official_sdk_sends(data: dict[int, bytes]) -> None:
    port = SdkPort()
    group = GroupSyncWrite(port, Protocol2PacketHandler(), 116, 4)
    for id_, part in data.items():
        group.addParam(id_, list(part))
    group.txPacket()
    assert protocol2.sync_write(116, data) == port.sent or needs_stuffing(port.sent)


@given(st.lists(IDS, min_size=1, max_size=20, unique=True))
def test_a_sync_read_is_what_the_official_sdk_sends(ids: list[int]) -> None:
    port = SdkPort()
    Protocol2PacketHandler().syncReadTx(port, 126, 21, ids, len(ids), False)
    assert protocol2.sync_read(ids, 126, 21) == port.sent


@given(st.dictionaries(IDS, st.tuples(st.integers(0, 700), st.integers(1, 60)), min_size=1, max_size=10))
def test_a_bulk_read_is_what_the_official_sdk_sends(windows: dict[int, tuple[int, int]]) -> None:
    port = SdkPort()
    parts = [byte for i, (a, n) in windows.items() for byte in (i, a % 256, a // 256, n, 0)]
    Protocol2PacketHandler().bulkReadTx(port, parts, len(parts), False)
    assert protocol2.bulk_read(windows) == port.sent


@given(id_=IDS, error=st.integers(0, 0xFF), parameters=st.binary(min_size=1, max_size=100))
def test_a_status_packet_means_what_the_official_sdk_reads(id_: int, error: int, parameters: bytes) -> None:
    packet = status2(id_, *parameters, error=error)
    received, result = Protocol2PacketHandler().rxPacket(SdkPort(packet), False)
    assert result == 0
    length = received[5] | received[6] << 8
    theirs = Status(received[4], received[8], bytes(received[9 : 7 + length - 2]))
    assert Parser().feed(packet) == [Status(id_, error, parameters)]
    assert theirs == Status(id_, error, parameters) or needs_stuffing(packet)


def test_the_official_sdk_reads_two_stuffed_places_in_a_row_wrongly() -> None:
    parameters = bytes.fromhex("FF FF FD FF FD FD")
    received, _ = Protocol2PacketHandler().rxPacket(SdkPort(status2(1, *parameters)), False)
    assert bytes(received[9 : 7 + received[5] - 2]) == bytes.fromhex("FF FF FD FF FD")
    assert Parser().feed(status2(1, *parameters)) == [Status(1, 0, parameters)]


@given(id_=IDS, error=st.integers(0, 0xFF), parameters=DATA)
def test_whatever_a_servo_says_is_understood_stuffed_or_not(id_: int, error: int, parameters: bytes) -> None:
    assert Parser().feed(status2(id_, *parameters, error=error)) == [Status(id_, error, parameters)]


@given(st.lists(st.one_of(st.binary(max_size=60), HEADERISH), max_size=20))
def test_whatever_arrives_the_parser_neither_raises_nor_hangs(chunks: list[bytes]) -> None:
    parser = Parser()
    for chunk in chunks:
        parser.feed(chunk)


NOISE = st.lists(st.one_of(HEADERISH, st.just(TEMPERATURE), st.just(TEMPERATURE[:7])), max_size=8).map(
    b"".join
)


@given(NOISE)
def test_it_does_not_matter_in_what_pieces_bytes_arrive(noise: bytes) -> None:
    parser = Parser(20)
    by_byte = [found for byte in noise for found in parser.feed(bytes((byte,)))]
    assert by_byte == Parser(20).feed(noise)


@given(garbage=st.one_of(st.binary(max_size=40), HEADERISH), parameters=st.binary(max_size=10))
def test_garbage_hides_only_the_packets_right_behind_it(garbage: bytes, parameters: bytes) -> None:
    parser = Parser(most_parameters=12)
    parser.feed(garbage)
    for _ in range(4):  # of at least 11 bytes: more than the longest packet that the garbage may have begun
        found = parser.feed(status2(7, *parameters))
    assert Status(7, 0, parameters) in found


@pytest.mark.parametrize("cut", range(1, len(TEMPERATURE)))
def test_a_packet_that_was_cut_short_costs_at_most_the_next(cut: int) -> None:
    parser = Parser(most_parameters=10)
    assert parser.feed(TEMPERATURE[:cut]) == []
    found = parser.feed(TEMPERATURE) + parser.feed(TEMPERATURE)
    assert found[-1] == Status(1, 0, b"\x20")


@given(place=st.integers(0, len(TEMPERATURE) - 1), flips=st.integers(1, 255))
def test_a_damaged_byte_makes_no_packet(place: int, flips: int) -> None:
    damaged = bytearray(TEMPERATURE)
    damaged[place] ^= flips
    assert Parser().feed(bytes(damaged)) == []


def test_a_forgotten_beginning_does_not_disturb_the_next_packet() -> None:
    parser = Parser()
    parser.feed(TEMPERATURE[:9])
    parser.clear()
    assert parser.feed(TEMPERATURE) == [Status(1, 0, b"\x20")]


def test_what_an_adapter_returns_is_not_taken_for_a_reply() -> None:
    sent = protocol2.sync_read([1, 2], 126, 21) + protocol2.write(1, 64, b"\x01") + protocol2.ping(1)
    assert Parser().feed(sent + TEMPERATURE) == [Status(1, 0, b"\x20")]


def test_a_packet_that_does_not_fit_is_refused() -> None:
    with pytest.raises(ValueError, match="a packet carries 1000"):
        protocol2.write(1, 0, bytes(1000))
    with pytest.raises(ValueError, match="An id is 0 to 254"):
        protocol2.ping(255)
    with pytest.raises(ValueError, match="same number of bytes"):
        protocol2.sync_write(116, {1: b"1", 2: b"22"})
