"""A typed function becomes a method: its parameters are checked, its mistakes explained, itself described."""

import math
from typing import Annotated

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bentod.errors import BadRequest
from bentod.frames import Value
from bentod.serve.params import MOST_ITEMS, Flag, Free, Number, Text
from bentod.serve.spec import Handler, find, method, table


async def move(
    session: object,
    joint: Annotated[str, Text("joint name", 16)],
    velocity: Annotated[float | None, Number("rad/s", -10, 10, "wished velocity")] = None,
    lease_s: Annotated[float, Number("s", 0.05, 2, "how long the wish lives")] = 0.2,
) -> Value:
    """Move one joint.

    The wish ends with its lease.
    """
    return [joint, velocity, lease_s]


async def pause(
    session: object,
    joints: Annotated[str | list[str] | None, Text("one, several or all")] = None,
    on: Annotated[bool, Flag("false releases")] = True,
) -> Value:
    """Pause joints."""
    return None


async def set_meta(session: object, meta: Annotated[Value, Free("anything", 32)]) -> Value:
    """Put a note into every frame."""
    return meta


async def weigh(
    session: object,
    weights: Annotated[list[float], Number("kg", 0, 5, "some")],
    count: Annotated[int, Number("", 0, 9, "how many")] = 0,
    mode: Annotated[str, Text("which", choices=("off", "dpcc"))] = "off",
) -> Value:
    """Weigh."""
    return None


def test_parameters_come_by_position() -> None:
    assert method(move).bind(["wrist", -3, 0.5]) == ["wrist", -3.0, 0.5]


def test_parameters_come_by_name() -> None:
    assert method(move).bind({"lease_s": 1, "joint": "wrist"}) == ["wrist", None, 1.0]


def test_parameters_come_by_name_in_an_array() -> None:
    assert method(move).bind([{"joint": "wrist", "velocity": 1}]) == ["wrist", 1.0, 0.2]


def test_a_map_is_itself_the_parameter_where_anything_goes() -> None:
    assert method(set_meta).bind([{"trial": 3}]) == [{"trial": 3}]
    assert method(set_meta).bind({"meta": {"trial": 3}}) == [{"trial": 3}]


def test_what_is_left_out_has_its_default() -> None:
    assert method(move).bind(["wrist"]) == ["wrist", None, 0.2]
    assert method(pause).bind(None) == [None, True]


def test_nil_stands_for_a_default() -> None:
    assert method(move).bind(["wrist", None, None]) == ["wrist", None, 0.2]


def test_one_name_several_or_all() -> None:
    bind = method(pause).bind
    assert bind(["wrist"]) == ["wrist", True]
    assert bind([["wrist", "hand"], False]) == [["wrist", "hand"], False]
    assert bind([None, False]) == [None, False]


@pytest.mark.parametrize(
    ("handler", "params", "field", "words"),
    [
        (move, [], "joint", "move needs the parameter joint."),
        (move, ["wrist", 12], "velocity", "velocity = 12 rad/s is above its maximum, 10 rad/s."),
        (move, ["wrist", -10.5], "velocity", "velocity = -10.5 rad/s is below its minimum, -10 rad/s."),
        (move, ["wrist", True], "velocity", "velocity must be a number in rad/s, not True."),
        (move, ["wrist", "fast"], "velocity", "velocity must be a number in rad/s, not 'fast'."),
        (move, ["wrist", math.nan], "velocity", "velocity must be a finite number in rad/s, not nan."),
        (move, ["wrist", math.inf], "velocity", "velocity must be a finite number in rad/s, not inf."),
        (move, [7], "joint", "joint must be a text, not 7."),
        (move, [None], "joint", "joint must be a text, not nil."),
        (move, ["x" * 17], "joint", "joint has 17 characters, more than 16."),
        (move, ["a", 1, 1, 1], "params", "move takes at most 3 parameters, not 4."),
        (move, {"joint": "a", "velcity": 1}, "velcity", "has no parameter velcity; did you mean 'velocity'?"),
        (move, 5, "params", "The parameters of move are an array or a map of names, not 5."),
        (pause, [["a", 1]], "joints", "joints must be a text, not 1."),
        (pause, [["a"] * (MOST_ITEMS + 1)], "joints", "joints has 65 entries, more than 64."),
        (pause, [None, 1], "on", "on must be true or false, not 1."),
        (set_meta, ["x" * 40], "meta", "meta takes 42 bytes, more than 32."),
        (weigh, [3], "weights", "weights must be a list of numbers, not 3."),
        (weigh, [[6]], "weights", "weights = 6 kg is above its maximum, 5 kg."),
        (weigh, [[1], 1.0], "count", "count must be a whole number, not 1.0."),
        (weigh, [[1], True], "count", "count must be a whole number, not True."),
        (weigh, [[1], 1, "on"], "mode", "mode must be one of off, dpcc, not 'on'."),
    ],
)
def test_a_bad_request_is_explained(handler: Handler, params: Value, field: str, words: str) -> None:
    with pytest.raises(BadRequest) as caught:
        method(handler).bind(params)
    assert caught.value.field == field
    assert words in str(caught.value)


@given(st.recursive(st.none() | st.floats() | st.text(max_size=3), lambda inner: st.lists(inner, max_size=4)))
def test_any_array_is_bound_or_a_bad_request(params: Value) -> None:
    try:
        joint, velocity, lease = method(move).bind(params)
    except BadRequest:
        return
    assert isinstance(joint, str)
    assert velocity is None or (isinstance(velocity, float) and abs(velocity) <= 10)
    assert isinstance(lease, float)


async def test_a_method_calls_its_handler() -> None:
    assert await method(move)(object(), ["wrist"]) == ["wrist", None, 0.2]


def test_a_bound_method_is_a_handler_too() -> None:
    class Api:
        async def stop(self, session: object) -> Value:
            """Stop."""
            return None

    assert method(Api().stop).name == "stop"


def test_a_method_describes_itself() -> None:
    described = method(move).describe()
    assert described["doc"] == "Move one joint."
    assert described["details"] == "The wish ends with its lease."
    assert described["parameters"] == [
        {"name": "joint", "type": "text", "required": True, "doc": "joint name", "max_length": 16},
        {
            "name": "velocity",
            "type": "number or nil",
            "required": False,
            "default": None,
            "doc": "wished velocity",
            "unit": "rad/s",
            "minimum": -10,
            "maximum": 10,
        },
        {
            "name": "lease_s",
            "type": "number",
            "required": False,
            "default": 0.2,
            "doc": "how long the wish lives",
            "unit": "s",
            "minimum": 0.05,
            "maximum": 2,
        },
    ]


def test_types_are_told_in_words() -> None:
    assert method(pause).params[0].type == "text, list of text or nil"
    assert method(weigh).params[0].type == "list of number"
    assert method(set_meta).params[0].type == "any"
    assert method(set_meta).doc == "Put a note into every frame."


def test_an_unknown_method_names_the_nearest() -> None:
    methods = table(observer=(move, pause))
    assert find(methods, "move").name == "move"
    with pytest.raises(BadRequest, match=r"There is no method 'puase'; did you mean 'pause'\?"):
        find(methods, "puase")


def test_functions_that_cannot_be_methods_are_refused_at_once() -> None:
    async def sessionless(joint: str) -> None:
        """Doc."""

    async def silent(session: object) -> None: ...

    async def strange(session: object, joint: set[str]) -> None:
        """Doc."""

    async def many(session: object, *joints: str) -> None:
        """Doc."""

    async def mislabelled(session: object, joint: Annotated[str, Number("rad")]) -> None:
        """Doc."""

    async def mixed(session: object, joint: str | float) -> None:
        """Doc."""

    for handler in (sessionless, silent, strange, many, mislabelled, mixed):
        with pytest.raises(TypeError):
            method(handler)
    with pytest.raises(TypeError, match="same name"):
        table(observer=(move,), operator=(move,))
