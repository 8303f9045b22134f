import math
from collections.abc import Mapping
from contextlib import suppress

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from bentod.errors import ConfigError
from bentod.learn.expression import LENGTH, Expression, Vocabulary
from bentod.learn.expression_nodes import Node, Number, Prediction, Signal, SquaredError, call
from bentod.learn.program import Program
from bentod.learn.signals import Declared, Range

RANGES: Mapping[str, Range] = {
    "elbow.position": (-1.0, 3.0),
    "elbow.load": (-1.0, 1.0),
    "emg.biceps": (0.0, 1.0),
    "in.voltage": None,
}
SIGNALS = Declared(RANGES)
WORDS = Vocabulary(SIGNALS, {"bent": "norm(elbow.position)", "twice": "bent * 2"})
NAN = math.nan


def value(text: str, signals: tuple[float, ...] = (2.0, -0.5, 0.25, 12.0)) -> float:
    (found,) = Program([Expression.parse(text, WORDS)]).evaluate(np.array(signals))
    return float(found)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("elbow.position", 2.0),
        ("'in.voltage'", 12.0),
        ("bent", 0.75),
        ("twice", 1.5),
        ("1 + 2 * 3 - 8 / 4", 5.0),
        ("-elbow.load", 0.5),
        ("+1e-3", 0.001),
        ("elbow.position / (elbow.load + 0.5)", NAN),
        ("elbow.position / elbow.load", -4.0),
        ("abs(elbow.load)", 0.5),
        ("square(elbow.load)", 0.25),
        ("min(elbow.load, emg.biceps, 1)", -0.5),
        ("max(elbow.load, emg.biceps)", 0.25),
        ("clip(elbow.position, 0, 1)", 1.0),
        ("norm(elbow.position, 0, 8)", 0.25),
        ("norm(elbow.load)", 0.25),
        ("norm(elbow.position, 0, 1)", 1.0),
        ("above(elbow.load, -0.6)", 1.0),
        ("above(elbow.load, -0.5)", 0.0),
        ("below(elbow.load, 0)", 1.0),
        ("near(elbow.load, -0.4, 0.2)", 1.0),
        ("near(elbow.load, 0.4, 0.2)", 0.0),
    ],
)
def test_an_expression_has_the_value_that_mathematics_gives_it(text: str, expected: float) -> None:
    assert value(text) == pytest.approx(expected, nan_ok=True)


@pytest.mark.parametrize(
    "text",
    [
        "elbow.load + 1", "1 - elbow.load", "0 * elbow.load", "elbow.load / 2", "1 / elbow.load",
        "-elbow.load",
        "min(elbow.load, 1)", "min(1, elbow.load)", "max(1, elbow.load)", "clip(elbow.load, 0, 1)",
        "clip(0, elbow.load, 1)", "clip(0, 0, elbow.load)", "norm(elbow.load)", "above(elbow.load, 0)",
        "above(0, elbow.load)", "below(elbow.load, 0)", "near(0, elbow.load, 1)", "near(0, 0, elbow.load)",
        "abs(elbow.load)", "square(elbow.load)", "diff(elbow.load)", "trace(elbow.load, 0.9)",
        "delay(elbow.load, 2)", "prediction('wrist')", "delta2('wrist')",
    ],
)  # fmt: skip
def test_what_is_made_of_something_unknown_is_unknown(text: str) -> None:
    assert math.isnan(value(text, (2.0, NAN, 0.25, 12.0)))


def test_numbers_too_big_are_infinite_rather_than_an_error() -> None:
    assert value("'in.voltage' * 1e308") == math.inf
    assert math.isnan(value("'in.voltage' * 1e308 - 'in.voltage' * 1e308"))


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("elbow.positon", r"column 1 .*unknown name 'elbow\.positon'; did you mean 'elbow\.position'"),
        ("1 + bend", r"column 5 .*unknown name 'bend'; did you mean 'bent'"),
        ("nrm(bent)", r"column 1 .*unknown function 'nrm'; did you mean 'norm'"),
        ("  1 + abs", r"column 7 .*'abs' is a function"),
        ("1 +", r"column \d+ .*invalid syntax"),
        ("", r"column 1 .*invalid syntax"),
        ("elbow.load > 0.2", r"comparison is written above"),
        ("bent and twice", r"'and' is written min"),
        ("not bent", r"'not x' is written 1 - x"),
        ("bent ** 2", r"column 1 .*written square"),
        ("elbow.position@20", r'in quotes: prediction\("elbow\.position@20"\)'),
        ("prediction(elbow.position@20)", r"column 12 .*in quotes"),
        ("norm('in.voltage')", r"range of 'in\.voltage' is not known: write norm\(x, low, high\)"),
        ("norm(bent, 1, 0)", r"the lower one first"),
        ("norm(bent, 1)", r"two numbers"),
        ("norm(bent, 0, bent)", r"two numbers"),
        ("clip(bent, 1, 0)", r"lower bound first"),
        ("abs(bent, bent)", r"abs takes 1 arguments"),
        ("min(bent)", r"min takes 2 to 64 arguments"),
        ("abs(x=bent)", r"without names"),
        ("trace(bent, 1)", r"at least 0 and below 1"),
        ("trace(bent, bent)", r"must be a number"),
        ("delay(bent, 1.5)", r"whole number of ticks, 1 to 1000"),
        ("delay(bent, 1001)", r"whole number of ticks, 1 to 1000"),
        ("1 / 0", r"\(1\.0 / 0\.0\) is not a finite number"),
        ("1e999", r"the number is too big"),
        ("9" * 400, r"the number is too big"),
        ("True", r"'True' is not a number"),
        ("1j", r"is not a number"),
        ("(1)(2)", r"a dot stands within a name"),
        ("[1]", r"only numbers, names"),
        ("bent[0]", r"not with brackets"),
        ("(lambda: 1)()", r"a dot stands within a name"),
        ("bent if bent else 1", r"only numbers, names"),
        ("1if bent else 2", r"column 1"),
        ("'é' + élan", r"column 1 .*unknown name 'é'"),
        ("1 + 'é' * 2", r"column 5 "),
        ("bent + 'α.β'", r"column 8 .*unknown name 'α\.β'"),
        ("above(1, 2) + 1 + q.α + 1", r"column 19 .*unknown name 'q\.α'"),
        ("1 +" * 200 + "1", rf"at most {LENGTH} characters, not 601"),
        ("-" * 80 + "bent", r"deeper than 64"),
        ("abs(" * 70 + "bent" + ")" * 70, r"deeper than 64"),
        ("+bent" * 90, r"deeper than 64"),
    ],
)
def test_what_cannot_be_read_is_refused_with_the_place_and_the_reason(text: str, why: str) -> None:
    with pytest.raises(ConfigError, match=why):
        Expression.parse(text, WORDS)


def test_a_column_counts_letters_and_blanks_of_the_text_itself() -> None:
    with pytest.raises(ConfigError, match=r"^column 18 of .* unknown name 'é\.é'"):
        Expression.parse("\n  above(bent +\n 'é.é', 0)", Vocabulary(SIGNALS, {"bent": "1"}))


@given(st.text(max_size=60) | st.text("()+-*/.,'\"@[] 0123456789abelowtrcdif\n#{}=:", max_size=80))
def test_garbage_is_refused_and_nothing_else_happens(text: str) -> None:
    with suppress(ConfigError):
        Expression.parse(text, WORDS)


def _calls(inner: st.SearchStrategy[Node]) -> st.SearchStrategy[Node]:
    twice = st.sampled_from(["+", "-", "*", "/", "min", "max", "above", "below"])
    once = st.sampled_from(["negative", "abs", "square", "diff"])
    return st.one_of(
        st.builds(lambda name, a: call(name, [a]), once, inner),
        st.builds(lambda name, a, b: call(name, [a, b]), twice, inner, inner),
        st.builds(
            lambda a, b, c: call("clip", [a, Number(b), Number(b + c)]),
            inner,
            st.floats(-9, 9),
            st.floats(0, 9),
        ),
        st.builds(lambda a: call("norm", [a, Number(-1.5), Number(1e-7)]), inner),
        st.builds(lambda a, xi: call("trace", [a, Number(xi)]), inner, st.floats(0, 0.99)),
        st.builds(lambda a, n: call("delay", [a, Number(float(n))]), inner, st.integers(1, 9)),
    )


leaves: st.SearchStrategy[Node] = st.one_of(
    st.floats(-1e6, 1e6).map(Number),
    st.sampled_from([Signal(i, name, bounds) for i, (name, bounds) in enumerate(RANGES.items())]),
    st.sampled_from(["elbow.position@20", "it's", "a/b"]).flatmap(
        lambda name: st.sampled_from([Prediction(name), SquaredError(name)])
    ),
)
trees = st.recursive(leaves, _calls, max_leaves=8)


@settings(max_examples=60)
@given(trees)
def test_what_is_written_out_reads_as_the_same_expression(node: Node) -> None:
    text = str(node)
    assume(len(text) <= LENGTH)
    try:
        again = Expression.parse(text, WORDS)
    except ConfigError as error:
        if "is not a finite number" in str(error):
            return
        raise
    assert again == Expression(node)
    assert str(again) == text


@settings(max_examples=60)
@given(trees, st.lists(st.floats(0, 1), min_size=4, max_size=4))
def test_a_value_lies_in_the_range_that_is_known_of_it(node: Node, shares: list[float]) -> None:
    known = [bounds or (0.0, 24.0) for bounds in RANGES.values()]
    signals = np.array([low + share * (high - low) for (low, high), share in zip(known, shares, strict=True)])
    (found,) = Program([Expression(node)]).evaluate(signals)
    bounds = Expression(node).range()
    if bounds and math.isfinite(found):
        slack = 1e-9 * max(1.0, abs(bounds[0]), abs(bounds[1]))
        assert bounds[0] - slack <= found <= bounds[1] + slack


@pytest.mark.parametrize(
    ("text", "bounds"),
    [
        ("elbow.position", (-1.0, 3.0)),
        ("bent", (0.0, 1.0)),
        ("2 - elbow.position", (-1.0, 3.0)),
        ("square(elbow.position)", (0.0, 9.0)),
        ("abs(elbow.position) * emg.biceps", (0.0, 3.0)),
        ("1 / (emg.biceps + 1)", (0.5, 1.0)),
        ("1 / emg.biceps", None),
        ("'in.voltage' + 1", None),
        ("clip('in.voltage', 0, 9)", (0.0, 9.0)),
        ("diff(emg.biceps)", (-1.0, 1.0)),
        ("trace(elbow.position, 0.9)", (-1.0, 3.0)),
        ("prediction('a')", None),
        ("7", (7.0, 7.0)),
    ],
)
def test_ranges_follow_from_those_of_the_parts(text: str, bounds: Range) -> None:
    assert Expression.parse(text, WORDS).range() == bounds


def test_a_plain_signal_says_which() -> None:
    assert Expression.parse(" emg.biceps ", WORDS).signal == 2
    assert Expression.parse("'in.voltage'", WORDS).signal == 3
    assert Expression.parse("emg.biceps + 0", WORDS).signal is None


def test_the_questions_that_must_be_answered_first_are_known() -> None:
    text = "prediction('a') + trace(delta2(b.c), 0.5) - max(prediction('a'), bent)"
    assert Expression.parse(text, WORDS).predictions == {"a", "b.c"}


def test_questions_can_be_checked_as_soon_as_all_are_known() -> None:
    asking = WORDS.asking(["elbow@20"])
    assert Expression.parse("prediction('elbow@20')", asking).predictions == {"elbow@20"}
    with pytest.raises(ConfigError, match=r"column 17 .*no question 'elbw@20'; did you mean 'elbow@20'"):
        Expression.parse("abs(prediction( 'elbw@20'))", asking)


@pytest.mark.parametrize(
    ("define", "why"),
    [
        ({"a": "b", "b": "c + 1", "c": "a"}, r"made from itself: a -> b -> c -> a"),
        ({"a": "a"}, r"learn\.define\.a: is made from itself: a -> a"),
        ({"a": "1", "b": "a +"}, r"^learn\.define\.b: column \d+ of 'a \+': invalid syntax"),
        ({"a": "b", "b": "nobody"}, r"^learn\.define\.b: column 1 "),
        ({"elbow.load": "1"}, r"learn\.define\.elbow\.load: is the name of a signal"),
        ({"norm": "1"}, r"learn\.define\.norm: is the name of a function"),
        ({f"a{i}": f"a{i + 1}" for i in range(900)} | {"a900": "1"}, "deeper than 64"),
        ({"a0": "emg.biceps"} | {f"a{i + 1}": f"a{i} + a{i}" for i in range(40)}, "more than 1000 parts"),
    ],
)
def test_a_definition_that_cannot_be_read_is_refused(define: dict[str, str], why: str) -> None:
    with pytest.raises(ConfigError, match=why):
        Vocabulary(SIGNALS, define)


def test_what_is_made_of_numbers_alone_is_one_number() -> None:
    assert Expression.parse("1 - 1 / 4", WORDS) == Expression(Number(0.75))
