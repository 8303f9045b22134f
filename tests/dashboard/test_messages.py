"""What browsers say, to the byte, and what they must not say."""

import msgpack
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bentod.dashboard.messages import Call, Hold, Release, Seen, Token, pack, parse
from bentod.errors import BadRequest


def test_a_hold_is_five_words() -> None:
    data = b"\x95\xa4hold\xa1a\xa4move\x81\xa5joint\xa5elbow\x2a"
    assert parse(data) == Hold("a", "move", {"joint": "elbow"}, 42)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["token", "abc"], Token("abc")),
        (["call", 7, "pause", {"on": True}, 42], Call(7, "pause", {"on": True}, 42)),
        (["release", "key"], Release("key")),
        (["seen", 300], Seen(300)),
    ],
)
def test_every_message_is_understood(words: list[object], message: object) -> None:
    assert parse(msgpack.packb(words)) == message


@pytest.mark.parametrize(
    "words",
    [
        [],
        "hold",
        5,
        ["shout"],
        ["hold", "key"],
        ["call", "1", "pause", {}],
        ["seen", None],
        ["token", b"x"],
        [[1]],
    ],
)
def test_anything_else_is_refused(words: object) -> None:
    with pytest.raises(BadRequest):
        parse(msgpack.packb(words))


@given(st.binary(max_size=200))
def test_no_bytes_do_more_than_be_refused(data: bytes) -> None:
    try:
        parse(data)
    except BadRequest:
        return


def test_messages_to_browsers_are_lists() -> None:
    assert pack("link", False, "gone") == b"\x93\xa4link\xc2\xa4gone"


@pytest.mark.parametrize(
    "params",
    [{"meta": msgpack.Timestamp(1)}, {"meta": msgpack.ExtType(5, b"x")}, {"meta": list(range(400))}],
    ids=["time stamp", "extension", "very many values"],
)
def test_what_the_daemon_would_not_take_is_refused_before_it_gets_there(params: dict[str, object]) -> None:
    with pytest.raises(BadRequest, match="the daemon would not take"):
        parse(msgpack.packb(["call", 1, "set_meta", params, 1]))


def test_one_message_is_one_value() -> None:
    with pytest.raises(BadRequest, match="one MessagePack value"):
        parse(msgpack.packb(["seen", 1]) * 2)
