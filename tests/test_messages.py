"""Framing: any bytes give messages or BadFraming, never anything else, and never without bound."""

from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from types import MappingProxyType

import msgpack
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bentod.errors import BadRequest
from bentod.frames import Mode, Position, Value
from bentod.framing import BadFraming, Limits
from bentod.messages import (
    GREATEST_ID,
    Decoder,
    Memo,
    Message,
    Notification,
    Request,
    Response,
    encode_error,
    encode_notification,
    encode_request,
    encode_result,
    pack,
)

ids = st.integers(0, GREATEST_ID)
values: st.SearchStrategy[Value] = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-(2**63), 2**64 - 1)
    | st.floats(allow_nan=False)
    | st.text()
    | st.binary(),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(), inner, max_size=4),
    max_leaves=12,
)


def decode(chunks: Iterable[bytes], limits: Limits | None = None) -> list[Message]:
    decoder = Decoder(limits)
    messages = []
    for chunk in chunks:
        decoder.feed(chunk)
        messages += list(decoder)
    return messages


@given(ids, st.text(), values)
def test_a_request_comes_back_as_it_was_sent(id_: int, method: str, params: Value) -> None:
    assert decode([encode_request(id_, method, params)]) == [Request(id_, method, params)]


@given(ids, values)
def test_a_result_comes_back_as_it_was_sent(id_: int, result: Value) -> None:
    assert decode([encode_result(id_, result)]) == [Response(id_, None, result)]


@given(st.text(), st.lists(values, max_size=3), st.data())
def test_messages_survive_being_cut_anywhere(method: str, params: list[Value], data: st.DataObject) -> None:
    stream = encode_notification(method, params) + encode_request(7, method, params)
    cut = data.draw(st.integers(0, len(stream)))
    assert decode([stream[:cut], stream[cut:]]) == [
        Notification(method, params),
        Request(7, method, params),
    ]


@given(st.text(), values, st.data())
def test_a_truncated_message_is_waited_for(method: str, params: Value, data: st.DataObject) -> None:
    stream = encode_request(7, method, params)
    assert decode([stream[: data.draw(st.integers(0, len(stream) - 1))]]) == []


@given(st.lists(st.binary(max_size=200), max_size=5))
def test_random_bytes_give_messages_or_bad_framing(chunks: list[bytes]) -> None:
    assert_messages_or_bad_framing(chunks)


def assert_messages_or_bad_framing(chunks: list[bytes]) -> None:
    try:
        messages = decode(chunks)
    except BadFraming:
        return
    assert all(isinstance(message, Request | Response | Notification) for message in messages)


@given(st.binary(min_size=1, max_size=40), st.data())
def test_a_damaged_message_gives_messages_or_bad_framing(damage: bytes, data: st.DataObject) -> None:
    stream = bytearray(encode_request(300, "move", {"joint": "elbow_flexion", "velocity": 0.5}))
    at = data.draw(st.integers(0, len(stream) - 1))
    stream[at : at + len(damage)] = damage
    assert_messages_or_bad_framing([bytes(stream)])


@pytest.mark.parametrize(
    "raw",
    [
        5,
        [],
        {},
        [0, 1, "stop"],
        [3, 1, "stop", []],
        [True, 1, "stop", []],
        [0.0, 1, "stop", []],
        [0, -1, "stop", []],
        [0, 2**32, "stop", []],
        [0, True, "stop", []],
        [0, "1", "stop", []],
        [0, 1, b"stop", []],
        [0, 1, "stop", [{b"joint": 1}]],
        [1, None, None, None],
        [2, "stop"],
        [0, 1, "stop", [msgpack.Timestamp(1)]],
        [0, 1, "stop", [msgpack.ExtType(1, b"")]],
    ],
)
def test_what_is_not_a_message_is_bad_framing(raw: object) -> None:
    with pytest.raises(BadFraming):
        decode([msgpack.packb(raw)])


@pytest.mark.parametrize(
    "stream", [b"\xc1", b"\xdd\xff\xff\xff\xff", b"\xdf\xff\xff\xff\xff", b"\x91" * 2000]
)
def test_a_header_that_promises_too_much_is_refused_at_once(stream: bytes) -> None:
    with pytest.raises(BadFraming):
        decode([stream])


def test_a_message_one_byte_too_long_is_refused_however_it_arrives() -> None:
    stream = encode_request(1, "set_meta", ["x" * 80])
    fits, short = Limits(size=len(stream)), Limits(size=len(stream) - 1)
    assert len(decode([stream], fits)) == 1
    for chunks in ([stream], [stream[i : i + 1] for i in range(len(stream))]):
        with pytest.raises(BadFraming, match="longer"):
            decode(chunks, short)


def test_a_message_that_never_ends_is_refused_when_it_is_too_long() -> None:
    limits = Limits(size=1000, items=10_000, depth=100)
    with pytest.raises(BadFraming, match="longer"):
        decode([b"\x93\x02\xa1x"] + [b"\xdc\x00\x64" + b"\xc0" * 99] * 20, limits)


def test_the_daemon_too_is_believed_only_up_to_a_size() -> None:
    stream = encode_notification("state", ["x" * 80])
    assert len(decode([stream], Limits(size=len(stream), trusted=True))) == 1
    for chunks in ([stream], [stream[:50], stream[50:]]):
        with pytest.raises(BadFraming, match="longer"):
            decode(chunks, Limits(size=len(stream) - 1, trusted=True))


def test_what_the_daemon_sends_may_hold_many_values() -> None:
    table: list[Value] = [{"joint": str(n), "values": [0.0] * 10} for n in range(1000)]
    (message,) = decode([encode_notification("state", table)], Limits(size=2**20, items=4096, trusted=True))
    assert message == Notification("state", table)


def test_bytes_after_a_message_that_has_begun_are_counted() -> None:
    decoder = Decoder()
    stream = encode_notification("stop", [])
    decoder.feed(stream + stream[:3])
    assert (len(list(decoder)), decoder.pending, decoder.rest) == (1, 3, stream[:3])


def test_a_text_that_promises_too_much_is_refused_when_it_is_too_long() -> None:
    with pytest.raises(BadFraming, match="longer"):
        decode([b"\xdb\xff\xff\xff\xff"] + [b"x" * 100] * 11, Limits(size=1000))


def test_many_short_messages_in_one_chunk_are_not_one_long_one() -> None:
    stream = encode_notification("stop", [])
    assert len(decode([stream * 1000], Limits(size=len(stream)))) == 1000


def test_nesting_is_bounded() -> None:
    deep: Value = 1
    for _ in range(14):
        deep = [deep]
    assert decode([encode_notification("x", [deep])])
    with pytest.raises(BadFraming, match="nested"):
        decode([encode_notification("x", [[deep]])])


@dataclass(frozen=True, slots=True)
class Box:
    """One of each kind."""

    mode: Mode
    parts: tuple[Position, ...]
    named: Mapping[str, Position]


@dataclass(frozen=True, slots=True)
class Single:
    """A value of one field."""

    only: int


def test_values_become_maps_of_their_fields() -> None:
    part = Position(1.5, 0.5)
    box = Box(Mode.LIMP, (part,), MappingProxyType({"a": part}))
    plain = {"mode": "limp", "parts": [asdict(part)], "named": {"a": asdict(part)}}
    assert msgpack.unpackb(pack(box)) == plain
    assert msgpack.unpackb(pack(Single(3))) == {"only": 3}


def test_numpy_scalars_are_numbers() -> None:
    assert msgpack.unpackb(pack([np.float64(0.5), np.float32(0.5), np.int64(3), np.bool_(True)])) == [
        0.5,
        0.5,
        3,
        True,
    ]


def test_other_objects_are_refused_by_name() -> None:
    with pytest.raises(TypeError, match="set"):
        pack({1, 2})


def test_an_error_is_a_map_of_code_message_and_field() -> None:
    error: Value = {"code": "bad_request", "message": "Too fast.", "field": "velocity"}
    assert decode([encode_error(3, BadRequest("Too fast.", "velocity"))]) == [Response(3, error, None)]


def test_a_value_that_many_ask_for_is_packed_once_and_answered_as_ever() -> None:
    memo, value = Memo(), {"joints": [1, 2.5, None]}
    assert memo.of(value) is memo.of(value)
    assert encode_result(7, memo.of(value)) == encode_result(7, value)
    assert memo.of({"joints": []}) == pack({"joints": []})
