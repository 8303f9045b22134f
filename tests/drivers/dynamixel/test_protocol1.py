import pytest
from dynamixel_sdk import GroupSyncWrite, Protocol1PacketHandler
from hypothesis import given
from hypothesis import strategies as st

from drivers.dynamixel import protocol1
from drivers.dynamixel.packets import BROADCAST, Status
from drivers.dynamixel.protocol1 import Parser
from tests.drivers.dynamixel.sdk import SdkPort
from tests.drivers.dynamixel.wire import status

IDS = st.integers(0, 0xFD)
TEMPERATURE = status(1, 0x20)


@given(id_=IDS, address=st.integers(0, 0xFF), size=st.integers(0, 0xFF))
def test_a_read_is_what_the_official_sdk_sends(id_: int, address: int, size: int) -> None:
    port = SdkPort()
    Protocol1PacketHandler().readTx(port, id_, address, size)
    assert protocol1.read(id_, address, size) == port.sent


@given(id_=IDS, address=st.integers(0, 0xFF), data=st.binary(min_size=1, max_size=100))
def test_writes_are_what_the_official_sdk_sends(id_: int, address: int, data: bytes) -> None:
    port = SdkPort()
    Protocol1PacketHandler().writeTxOnly(port, id_, address, len(data), data)
    assert protocol1.write(id_, address, data) == port.sent
    Protocol1PacketHandler().regWriteTxOnly(port, id_, address, len(data), data)
    assert protocol1.reg_write(id_, address, data) == port.sent


@given(id_=st.integers(0, 0xFE))
def test_ping_and_action_are_what_the_official_sdk_sends(id_: int) -> None:
    port = SdkPort()
    Protocol1PacketHandler().ping(port, id_)
    assert id_ == BROADCAST or protocol1.ping(id_) == port.sent
    Protocol1PacketHandler().action(port, id_)
    assert protocol1.action(id_) == port.sent


@given(st.dictionaries(IDS, st.binary(min_size=4, max_size=4), min_size=1, max_size=20))
def test_a_sync_write_is_what_the_official_sdk_sends(data: dict[int, bytes]) -> None:
    port = SdkPort()
    group = GroupSyncWrite(port, Protocol1PacketHandler(), 30, 4)
    for id_, part in data.items():
        group.addParam(id_, list(part))
    group.txPacket()
    assert protocol1.sync_write(30, data) == port.sent


@given(st.lists(IDS, min_size=1, max_size=20, unique=True))
def test_a_bulk_read_is_what_the_official_sdk_sends(ids: list[int]) -> None:
    port = SdkPort()
    parts = [byte for id_ in ids for byte in (10, id_, 34)]
    Protocol1PacketHandler().bulkReadTx(port, parts, len(parts))
    assert protocol1.bulk_read(ids, 34, 10) == port.sent


@given(id_=IDS, error=st.integers(0, 0x7F), parameters=st.binary(max_size=200))
def test_a_status_packet_means_what_the_official_sdk_reads(id_: int, error: int, parameters: bytes) -> None:
    packet = status(id_, *parameters, error=error)
    received, result = Protocol1PacketHandler().rxPacket(SdkPort(packet))
    assert result == 0
    theirs = Status(received[2], received[4], bytes(received[5:-1]))
    assert Parser().feed(packet) == [theirs] == [Status(id_, error, parameters)]


@given(st.lists(st.binary(max_size=60), max_size=20))
def test_whatever_arrives_the_parser_neither_raises_nor_hangs(chunks: list[bytes]) -> None:
    parser = Parser()
    for chunk in chunks:
        parser.feed(chunk)


NOISE = st.lists(
    st.one_of(
        st.binary(max_size=12), st.just(b"\xff\xff"), st.just(TEMPERATURE), st.just(b"\xff\xff\x01\x04")
    ),
    max_size=8,
).map(b"".join)


@given(NOISE)
def test_it_does_not_matter_in_what_pieces_bytes_arrive(noise: bytes) -> None:
    parser = Parser(20)
    by_byte = [found for byte in noise for found in parser.feed(bytes((byte,)))]
    assert by_byte == Parser(20).feed(noise)


@given(garbage=st.binary(max_size=40), parameters=st.lists(st.integers(0, 0xFE), max_size=10))
def test_garbage_hides_only_the_packets_right_behind_it(garbage: bytes, parameters: list[int]) -> None:
    parser = Parser(most_parameters=12)
    parser.feed(garbage)
    for _ in range(18):  # of at least 6 bytes: more than the longest packet that the garbage may have begun
        found = parser.feed(status(7, *parameters))
    assert Status(7, 0, bytes(parameters)) in found


@pytest.mark.parametrize("cut", range(1, len(TEMPERATURE)))
def test_a_packet_that_was_cut_short_costs_only_itself(cut: int) -> None:
    parser = Parser(most_parameters=10)
    assert parser.feed(TEMPERATURE[:cut]) == []
    found = parser.feed(TEMPERATURE) + parser.feed(TEMPERATURE)
    assert found[-1] == Status(1, 0, b"\x20")


def test_a_forgotten_beginning_does_not_disturb_the_next_packet() -> None:
    parser = Parser()
    parser.feed(TEMPERATURE[:4])
    parser.clear()
    assert parser.feed(TEMPERATURE) == [Status(1, 0, b"\x20")]


@pytest.mark.parametrize("place", range(2, len(TEMPERATURE)))
def test_a_damaged_byte_makes_no_packet(place: int) -> None:
    damaged = bytearray(TEMPERATURE)
    damaged[place] ^= 0x10
    assert Parser().feed(bytes(damaged)) == []


def test_a_third_header_byte_is_skipped() -> None:
    assert Parser().feed(b"\xff" + TEMPERATURE) == [Status(1, 0, b"\x20")]


def test_our_own_broadcasts_are_not_taken_for_replies() -> None:
    assert Parser().feed(protocol1.bulk_read([1, 2], 34, 10)) == []


def test_a_packet_that_does_not_fit_is_refused() -> None:
    with pytest.raises(ValueError, match="a packet carries 253"):
        protocol1.write(1, 0, bytes(253))
    with pytest.raises(ValueError, match="An id is 0 to 254"):
        protocol1.ping(255)
    with pytest.raises(ValueError, match="same number of bytes"):
        protocol1.sync_write(30, {1: b"1", 2: b"22"})
