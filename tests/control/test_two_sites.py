"""What a pair asks when both of its muscles are contracted, by its rule."""

from typing import Literal

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bentod.config_sites import Pair
from bentod.control.switching import BACKWARD, FORWARD
from tests.control.scheme_rig import REST, Played, lost, muscles, same_however_cut

Rule = Literal["difference", "first_over", "greatest"]


def pair(rule: Rule, toggle: str | None = None, toggle_back: str | None = None) -> Pair:
    return Pair(
        group="arm",
        positive="flexor",
        negative="extensor",
        rule=rule,
        toggle=toggle,
        toggle_back=toggle_back,
    )


def wish(rule: Rule, *stretches: tuple[float, ...]) -> float:
    played = Played(pair(rule))
    played.step(muscles(*stretches))
    return played.wish


FLEXED, BOTH = (0.3, 0.4, 0.0), (0.3, 0.4, 0.8)


@pytest.mark.parametrize(
    ("rule", "expected"), [("difference", -0.5), ("greatest", -0.775), ("first_over", 0.275)]
)
def test_with_both_contracted_the_rule_decides(rule: Rule, expected: float) -> None:
    assert wish(rule, REST, FLEXED, BOTH) == pytest.approx(expected, abs=0.01)


@pytest.mark.parametrize("rule", ["difference", "first_over", "greatest"])
@pytest.mark.parametrize(("shares", "sign"), [((0.6, 0.0), 1), ((0.0, 0.6), -1), ((0.0, 0.0), 0)])
def test_one_alone_moves_the_arm_its_way_by_any_rule(
    rule: Rule, shares: tuple[float, float], sign: int
) -> None:
    assert wish(rule, REST, (0.3, *shares)) == pytest.approx(sign * 0.525, abs=0.01)


@pytest.mark.parametrize("rule", ["difference", "greatest"])
def test_two_that_are_equal_ask_for_nothing_and_are_tense(rule: Rule) -> None:
    played = Played(pair(rule))
    played.step(muscles(REST, (0.3, 1.2, 1.2)))
    assert (played.wish, played.tense) == (0.0, True)


def test_the_first_has_it_until_it_lets_go() -> None:
    assert wish("first_over", REST, FLEXED, BOTH, (0.3, 0.0, 0.8)) == pytest.approx(-0.775, abs=0.01)
    assert wish("first_over", REST, (0.3, 0.0, 0.4), (0.3, 0.8, 0.4)) == pytest.approx(-0.275, abs=0.01)


def test_of_two_that_were_contracted_at_the_start_neither_was_first() -> None:
    assert wish("first_over", BOTH) == 0.0
    assert wish("first_over", BOTH, REST, FLEXED) > 0


def test_lost_samples_do_not_change_who_was_first() -> None:
    played = Played(pair("first_over"))
    played.step(np.concatenate((muscles(REST, FLEXED, BOTH), lost(0.2))))
    assert played.wish == 0.0
    played.step(muscles(FLEXED))
    assert played.wish == pytest.approx(0.275, abs=0.01)


def test_a_second_site_toggles_back() -> None:
    table = pair("difference", toggle="third", toggle_back="extensor")
    played = Played(table)
    assert played.step(muscles(REST, (0.3, 0.0, 0.0, 0.8))) == [FORWARD]
    assert played.step(muscles(REST, (0.3, 0.0, 0.8, 0.0))) == [BACKWARD]


def test_one_site_toggles_on_when_its_contraction_is_short_and_back_when_it_is_long() -> None:
    table = pair("difference", toggle="third", toggle_back="third")
    samples = muscles(REST, (0.3, 0.0, 0.0, 0.8), REST, (0.9, 0.0, 0.0, 0.8), REST)
    assert Played(table).step(samples) == [FORWARD, BACKWARD]


def test_a_contraction_of_which_nobody_knows_yet_whether_it_is_long_is_no_rest() -> None:
    played = Played(pair("difference", toggle="third", toggle_back="third"))
    played.step(muscles(REST, (0.3, 0.0, 0.0, 0.8)))
    assert played.tense


@settings(max_examples=6, deadline=None)
@given(
    rule=st.sampled_from(["difference", "first_over", "greatest"]),
    cuts=st.lists(st.integers(0, 10_000), max_size=40),
    seed=st.integers(0, 100),
)
def test_what_is_asked_is_the_same_however_samples_are_cut(rule: Rule, cuts: list[int], seed: int) -> None:
    samples = muscles(REST, FLEXED, BOTH, (0.3, 0.0, 0.3), REST, BOTH, (0.3, 0.0, 0.0, 0.8), seed=seed)
    samples[150:165] = np.nan
    same_however_cut(pair(rule, "third", "third"), samples, cuts)
