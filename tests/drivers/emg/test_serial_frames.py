"""Frames of a board: their bytes, and that they are found whatever else is on the line."""

import struct
from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivers.emg.serial_frames import MOST_VALUES, Frame, Frames, crc16
from tests.drivers.emg.serial_board import checksum

# Sample 0x01020304 of two channels, -2 and 300, and the one after it, 5 and -32768.
LITERAL = bytes.fromhex("a55a 01 02 02 04030201 feff2c01 05000080 2613")


def frame(first: int, samples: Sequence[Sequence[int]], version: int = 1) -> bytes:
    """As a board builds it, without the parser's own code."""
    flat = [count for sample in samples for count in sample]
    body = struct.pack(f"<BBBI{len(flat)}h", version, len(samples[0]), len(samples), first, *flat)
    return b"\xa5\x5a" + body + struct.pack("<H", checksum(body))


def told(frames: Sequence[Frame]) -> list[tuple[int, list[list[int]]]]:
    return [(one.first, one.counts.tolist()) for one in frames]


tables = st.integers(1, 8).flatmap(
    lambda channels: st.lists(
        st.lists(st.integers(-(2**15), 2**15 - 1), min_size=channels, max_size=channels),
        min_size=1,
        max_size=10,
    )
)
sent = st.lists(st.tuples(st.integers(0, 2**32 - 1), tables), max_size=5)


def test_a_frame_is_read_from_its_bytes() -> None:
    found = Frames().take(LITERAL)
    assert told(found) == [(0x01020304, [[-2, 300], [5, -32768]])]
    assert found[0].counts.dtype == np.int16


def test_the_checksum_is_the_one_of_the_catalogues() -> None:
    assert crc16(b"123456789") == checksum(b"123456789") == 0x29B1


def test_the_bytes_of_a_frame_are_those_of_the_docs() -> None:
    assert frame(0x01020304, [[-2, 300], [5, -32768]]) == LITERAL


@given(sent, st.lists(st.integers(1, 30), max_size=40))
def test_frames_are_found_however_their_bytes_are_cut(
    frames: list[tuple[int, list[list[int]]]], cuts: list[int]
) -> None:
    data = b"".join(frame(first, table) for first, table in frames)
    parser, found = Frames(), []
    for size in [*cuts, len(data)]:
        found += parser.take(data[:size])
        data = data[size:]
    assert told(found) == frames
    assert parser.skipped == 0


@given(sent, st.lists(st.binary(max_size=30), max_size=6))
def test_frames_among_garbage_are_found_once_the_line_is_clean_again(
    frames: list[tuple[int, list[list[int]]]], garbage: list[bytes]
) -> None:
    parser = Frames()
    for junk, (first, table) in zip(garbage, frames, strict=False):
        parser.take(junk)
        parser.take(frame(first, table))
    # What looked like a header may hold up what follows, for as long as the longest frame is.
    parser.take(bytes(9 + 2 * MOST_VALUES + 2))
    assert told(parser.take(LITERAL)) == [(0x01020304, [[-2, 300], [5, -32768]])]


@given(st.integers(0, len(LITERAL) * 8 - 1))
def test_a_frame_with_a_wrong_bit_is_no_frame_and_the_next_is_found(bit: int) -> None:
    wrong = bytearray(LITERAL)
    wrong[bit // 8] ^= 1 << bit % 8
    parser = Frames()
    # A wrong number of samples may make it wait for more than there is in one frame.
    found = parser.take(bytes(wrong) + frame(9, [[1, 2]]) + bytes(2 * MOST_VALUES + 11))
    assert told(found)[-1:] == [(9, [[1, 2]])]
    assert len(found) == 1


@given(st.integers(0, len(LITERAL) - 1))
def test_a_frame_that_is_cut_off_is_no_frame_and_the_next_is_found(length: int) -> None:
    parser = Frames()
    found = parser.take(LITERAL[:length] + LITERAL + LITERAL)
    assert 1 <= len(found) <= 2
    assert {one.first for one in found} == {0x01020304}


@given(st.lists(st.binary(max_size=64), max_size=50))
def test_garbage_is_never_held_for_longer_than_the_longest_frame(garbage: list[bytes]) -> None:
    parser = Frames()
    for junk in garbage:
        parser.take(b"\xa5\x5a\x01" + junk)
        assert len(parser._waiting) < 9 + 2 * MOST_VALUES + 2


@pytest.mark.parametrize(("channels", "samples"), [(0, 1), (1, 0), (33, 1), (1, 65), (32, 9)])
def test_a_header_beyond_its_bounds_begins_no_frame(channels: int, samples: int) -> None:
    body = struct.pack("<BBBI", 1, channels, samples, 0) + bytes(2 * channels * samples)
    parser = Frames()
    assert parser.take(b"\xa5\x5a" + body + struct.pack("<H", checksum(body))) == []
    assert told(parser.take(bytes(600) + LITERAL)) != []


def test_a_frame_of_a_later_version_is_not_read_but_known() -> None:
    parser = Frames()
    assert parser.take(frame(0, [[1, 2]], version=2)) == []
    assert parser.version == 2
