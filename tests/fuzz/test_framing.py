"""Any bytes, cut anywhere, give the same messages or the same refusal, and nothing is kept beyond a bound."""

from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bentod.framing import BadFraming, Limits
from bentod.messages import Decoder
from tests.fuzz import grammar, targets

ARM = grammar.Grammar(
    [
        {"name": "stop", "parameters": []},
        {
            "name": "move",
            "parameters": [
                {"name": "joint", "type": "text", "required": True},
                {
                    "name": "velocity",
                    "type": "number or nil",
                    "required": False,
                    "minimum": -10,
                    "maximum": 10,
                },
            ],
        },
        {"name": "set_meta", "parameters": [{"name": "meta", "type": "any", "required": True}]},
    ],
    ["elbow", "wrist"],
)


@given(st.integers(0, 2**32))
@settings(max_examples=300)
def test_a_stream_is_read_alike_however_it_is_cut(seed: int) -> None:
    targets.framing(ARM.stream(Random(seed)))


@given(st.lists(st.binary(max_size=20) | st.sampled_from(grammar.TORN), max_size=8))
@settings(max_examples=300)
def test_torn_pieces_are_read_alike_however_they_are_cut(parts: list[bytes]) -> None:
    targets.framing(b"".join(parts))


@pytest.mark.parametrize("torn", grammar.TORN)
def test_no_promise_makes_the_decoder_keep_more_than_one_message(torn: bytes) -> None:
    limits = Limits(size=1000, items=50, depth=4)
    decoder = Decoder(limits)
    with pytest.raises(BadFraming):
        read(decoder, [torn] * 2000)


def read(decoder: Decoder, chunks: list[bytes]) -> None:
    for chunk in chunks:
        decoder.feed(chunk)
        list(decoder)
