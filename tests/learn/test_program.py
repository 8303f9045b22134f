import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bentod.learn.expression import Expression, Vocabulary
from bentod.learn.program import Program
from bentod.learn.signals import Declared

WORDS = Vocabulary(Declared({"a": (0.0, 1.0), "b": None}))
NAN = math.nan


class Others:
    def prediction(self, name: str) -> float:
        return {"x": 4.0, "y": 5.0}[name]

    def squared_error(self, name: str) -> float:
        return {"x": 0.25}.get(name, NAN)


def program(*texts: str) -> Program:
    return Program([Expression.parse(text, WORDS) for text in texts])


def run(text: str, a: list[float], steps: list[int] | None = None) -> list[float]:
    learner = program(text)
    return [
        float(learner.evaluate(np.array([x, 0.0]), steps=n)[0])
        for x, n in zip(a, steps or [1] * len(a), strict=True)
    ]


def approximately(expected: list[float]) -> object:
    return pytest.approx(expected, nan_ok=True)


def test_values_come_in_the_order_of_the_expressions() -> None:
    mixed = program("b", "a + 1", "a", "prediction('x') - delta2('x')", "2", "prediction('y')", "b")
    assert mixed.evaluate(np.array([1.0, 7.0]), Others()).tolist() == [7.0, 2.0, 1.0, 3.75, 2.0, 5.0, 7.0]


def test_without_expressions_there_are_no_values() -> None:
    assert program().evaluate(np.array([1.0, 7.0])).shape == (0,)


def test_a_trace_fades_as_equation_4_7_says_and_starts_at_the_first_value() -> None:
    assert run("trace(a, 0.8)", [1.0, 0.0, 0.5]) == approximately([1.0, 0.8, 0.74])


def test_a_change_is_per_tick_and_begins_with_none() -> None:
    assert run("diff(a)", [1.0, 3.0, 3.0, 0.0]) == approximately([0.0, 2.0, 0.0, -3.0])


def test_a_delay_tells_what_was_and_begins_with_the_first_value() -> None:
    assert run("delay(a, 2)", [1.0, 2.0, 3.0, 4.0, 5.0]) == approximately([1.0, 1.0, 1.0, 2.0, 3.0])


def test_ticks_that_were_missed_count() -> None:
    assert run("trace(a, 0.8)", [1.0, 0.0, 0.0], [1, 3, 1]) == approximately([1.0, 0.8**3, 0.8**4])
    assert run("diff(a)", [1.0, 7.0], [1, 3]) == approximately([0.0, 2.0])
    assert run("delay(a, 2)", [1.0, 2.0, 5.0, 6.0], [1, 1, 2, 1]) == approximately([1.0, 1.0, 2.0, 2.0])
    assert run("delay(a, 2)", [1.0, 2.0, 5.0, 6.0], [1, 1, 9, 1]) == approximately([1.0, 1.0, 2.0, 2.0])


def test_a_value_that_is_not_known_leaves_no_trace_and_its_ticks_count() -> None:
    assert run("trace(a, 0.8)", [1.0, NAN, NAN, 0.0]) == approximately([1.0, NAN, NAN, 0.8**3])
    assert run("diff(a)", [1.0, NAN, 5.0, 6.0]) == approximately([0.0, NAN, 2.0, 1.0])
    assert run("delay(a, 1)", [NAN, 1.0, NAN, 3.0, 4.0]) == approximately([NAN, 1.0, 1.0, NAN, 3.0])
    assert run("trace(a, 0.8)", [math.inf, 1.0, 0.0]) == approximately([NAN, 1.0, 0.8])


@pytest.mark.parametrize("text", ["trace(a, 0.8)", "diff(a)", "delay(a, 2)"])
def test_after_a_hole_that_cannot_be_bridged_all_begins_anew(text: str) -> None:
    later = run(text, [9.0, 4.0, 7.0, 2.0, 1.0], [1, 1, 0, 1, 1])
    assert later[2:] == run(text, [7.0, 2.0, 1.0])
    restarted = program(text)
    restarted.evaluate(np.array([9.0, 0.0]))
    restarted.restart()
    assert restarted.evaluate(np.array([7.0, 0.0])).tolist() == run(text, [7.0])


MEMORABLE = ("trace(a, 0.9)", "diff(a) + trace(diff(a), 0.5)", "delay(trace(a, 0.9), 3)", "diff(b / a)")


@settings(max_examples=40)
@given(st.lists(st.sampled_from([0.0, 0.25, 1.0, NAN]), min_size=2, max_size=12), st.integers(0, 11))
def test_what_was_remembered_goes_on_bit_for_bit_in_a_program_of_another_order(
    past: list[float], at: int
) -> None:
    whole, resumed = program(*MEMORABLE), program(*reversed(MEMORABLE))
    for tick, x in enumerate(past):
        if tick == min(at, len(past) - 1):
            resumed.recall(whole.memory())
        if tick >= min(at, len(past) - 1):
            again = resumed.evaluate(np.array([x, 1.0]))[::-1]
        now = whole.evaluate(np.array([x, 1.0]))
    np.testing.assert_array_equal(now, again)


def test_equal_parts_share_one_memory() -> None:
    assert len(program(*MEMORABLE).memory()) == 5
    assert all("/" not in name for name in program(*MEMORABLE).memory())


def test_a_memory_is_a_copy() -> None:
    original = program("delay(a, 2)")
    original.evaluate(np.array([1.0, 0.0]))
    for array in original.memory().values():
        array.fill(5.0)
    assert original.evaluate(np.array([2.0, 0.0])).tolist() == [1.0]


def test_a_memory_of_other_expressions_is_refused() -> None:
    with pytest.raises(ValueError, match="1 memories were expected"):
        program("diff(a)").recall(program("diff(b)").memory())
    for text in ("diff(a)", "trace(a, 0.5)", "delay(a, 3)"):
        (name,) = program(text).memory()
        with pytest.raises(ValueError, match="This is not"):
            program(text).recall({name: np.array([-1.0, -1.0])})
