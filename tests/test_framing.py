"""Bytes that promise more than they hold cost no more than themselves."""

import tracemalloc

import msgpack
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bentod.framing import BadFraming, Limits, Scanner

NIL = b"\xc0"


def taken(stream: bytes, limits: Limits | None = None, step: int = 0) -> list[bytes]:
    """The values in `stream`, fed whole or `step` bytes at a time."""
    scanner = Scanner(limits or Limits())
    found = []
    step = step or len(stream) or 1
    for at in range(0, len(stream), step):
        scanner.feed(stream[at : at + step])
        while (value := scanner.take()) is not None:
            found.append(value)
    return found


EVERY_FORMAT = [
    b"\x00",
    b"\x7f",
    b"\x80",
    b"\x81\xa1a\x01",
    b"\x90",
    b"\x92\x01\x02",
    b"\xa0",
    b"\xbf" + b"x" * 31,
    NIL,
    b"\xc2",
    b"\xc3",
    b"\xc4\x02ab",
    b"\xc5\x00\x02ab",
    b"\xc6\x00\x00\x00\x02ab",
    b"\xca" + bytes(4),
    b"\xcb" + bytes(8),
    b"\xcc\x01",
    b"\xcd\x01\x02",
    b"\xce" + bytes(4),
    b"\xcf" + bytes(8),
    b"\xd0\x01",
    b"\xd1\x01\x02",
    b"\xd2" + bytes(4),
    b"\xd3" + bytes(8),
    b"\xd9\x02ab",
    b"\xda\x00\x02ab",
    b"\xdb\x00\x00\x00\x02ab",
    b"\xdc\x00\x02" + NIL * 2,
    b"\xdd\x00\x00\x00\x02" + NIL * 2,
    b"\xde\x00\x01\xa1a" + NIL,
    b"\xdf\x00\x00\x00\x01\xa1a" + NIL,
    b"\xe0",
    b"\xff",
]
"""One value of each format of the specification, extensions apart."""


@pytest.mark.parametrize("step", [0, 1, 2, 3])
def test_the_end_of_every_format_is_found_however_it_is_cut(step: int) -> None:
    assert taken(b"".join(EVERY_FORMAT), step=step) == EVERY_FORMAT


plain = st.none() | st.integers(-(2**63), 2**64 - 1) | st.floats() | st.text() | st.binary()
values = st.recursive(
    plain,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(), inner, max_size=4),
    max_leaves=8,
)


@given(st.lists(values, max_size=4), st.integers(0, 7))
def test_what_another_encoder_wrote_is_cut_where_it_ends(written: list[object], step: int) -> None:
    packed = [msgpack.packb(value) for value in written]
    assert taken(b"".join(packed), Limits(depth=100), step) == packed


@pytest.mark.parametrize(
    "head", [0xC1, 0xC7, 0xC8, 0xC9, 0xD4, 0xD5, 0xD6, 0xD7, 0xD8], ids=lambda head: f"{head:#x}"
)
def test_extensions_and_what_is_never_used_are_refused_at_their_first_byte(head: int) -> None:
    with pytest.raises(BadFraming, match=f"{head:#04x}"):
        taken(bytes([0x91, head]))


@pytest.mark.parametrize("head", [b"\xdd", b"\xdf"])
def test_a_promise_of_four_thousand_million_values_is_refused_before_one_is_there(head: bytes) -> None:
    with pytest.raises(BadFraming, match="more than 256 values"):
        taken(head + b"\xff\xff\xff\xff")


@pytest.mark.parametrize("head", [b"\xc6", b"\xdb"])
def test_a_promise_of_four_gigabytes_is_refused_before_one_byte_is_there(head: bytes) -> None:
    with pytest.raises(BadFraming, match="longer than 16384 bytes"):
        taken(head + b"\xff\xff\xff\xff")


def test_values_are_counted_in_all_and_not_in_each_array() -> None:
    small = b"\x9a" + b"\x99" * 10
    with pytest.raises(BadFraming, match="more than 99 values"):
        taken(small, Limits(items=99))
    assert taken(small + NIL * 90, Limits(items=100)) == [small + NIL * 90]


def test_nesting_is_refused_at_the_first_level_too_many() -> None:
    assert taken(b"\x91" * 3 + NIL, Limits(depth=3)) == [b"\x91\x91\x91\xc0"]
    with pytest.raises(BadFraming, match="more than 3 deep"):
        taken(b"\x91" * 4, Limits(depth=3))


def test_a_thousand_arrays_inside_one_another_reserve_no_memory() -> None:
    # A decoder that builds while it reads reserves 32 KiB for each of these three bytes.
    bomb = b"\xdc\x10\x00" * 1000
    tracemalloc.start()
    try:
        with pytest.raises(BadFraming):
            taken(bomb)
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert peak < 64 * 1024


def test_what_follows_a_value_is_kept_for_whoever_comes_next() -> None:
    scanner = Scanner(Limits())
    scanner.feed(b"\x91\xc0\x92\xc0")
    assert (scanner.take(), scanner.take(), scanner.rest, scanner.pending) == (
        b"\x91\xc0",
        None,
        b"\x92\xc0",
        2,
    )


def test_bytes_that_were_taken_are_let_go() -> None:
    scanner = Scanner(Limits())
    for _ in range(100):
        scanner.feed(b"\x93" + NIL * 3)
        assert scanner.take() == b"\x93" + NIL * 3
    assert scanner.pending == 0
