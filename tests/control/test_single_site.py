"""One muscle that drives a joint both ways."""

from typing import Literal

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bentod.config_sites import SingleSite
from bentod.control.switching import FORWARD
from tests.control.scheme_rig import RATE_HZ, REST, Played, lost, muscles, same_however_cut


def single(rule: Literal["two_state", "alternate"] = "two_state", **changes: float | str) -> SingleSite:
    return SingleSite.model_validate({"group": "hand", "site": "flexor", "rule": rule} | changes)


def wish(*stretches: tuple[float, ...], table: SingleSite | None = None, seed: int | None = None) -> float:
    played = Played(table or single())
    assert played.step(muscles(*stretches, seed=seed)) == []
    return played.wish


WEAK, STRONG = (0.5, 0.4), (0.5, 0.9)


def test_a_weak_contraction_goes_one_way_and_a_strong_one_the_other() -> None:
    assert wish(REST, WEAK) == pytest.approx(0.275, abs=0.01)
    assert wish(REST, STRONG) == pytest.approx(-0.9, abs=0.01)
    assert wish(REST, WEAK, table=single(weak="negative")) < 0
    assert wish(REST, WEAK, table=single(strong=0.2)) < 0


def test_nothing_moves_before_it_is_decided() -> None:
    for contraction in (WEAK, STRONG):
        _, wishes = Played(single()).course(muscles(REST, contraction))
        first = next(index for index, wish in enumerate(wishes) if wish)
        assert (first / RATE_HZ - 0.5) == pytest.approx(0.15, abs=0.04)


def test_once_decided_it_keeps_its_way_however_strong_it_is() -> None:
    assert wish(REST, WEAK, STRONG) == pytest.approx(0.9, abs=0.01)
    assert wish(REST, STRONG, WEAK) == pytest.approx(-0.275, abs=0.01)
    assert wish(REST, WEAK, (0.1, 0.0), STRONG) == pytest.approx(0.9, abs=0.01)


def test_after_a_rest_it_is_decided_anew() -> None:
    assert wish(REST, WEAK, (0.3, 0.0), STRONG) == pytest.approx(-0.9, abs=0.01)


@pytest.mark.parametrize("seed", range(8))
def test_scatter_does_not_make_a_weak_contraction_strong_nor_a_strong_one_weak(seed: int) -> None:
    played = Played(single())
    played.step(muscles(REST, (0.5, 0.35), seed=seed))
    _, weak = Played(single()).course(muscles(REST, (0.5, 0.35), seed=seed))
    _, strong = Played(single()).course(muscles(REST, (0.5, 1.0), seed=seed))
    assert (min(weak), max(strong)) == (0.0, 0.0)
    assert (max(weak), -min(strong)) > (0.0, 0.0)


def test_alternate_contractions_go_to_and_fro() -> None:
    to_and_fro = single("alternate")
    assert wish(REST, WEAK, table=to_and_fro) > 0
    assert wish(REST, WEAK, REST, WEAK, table=to_and_fro) < 0
    assert wish(REST, WEAK, REST, WEAK, REST, STRONG, table=to_and_fro) > 0


def test_a_twitch_does_not_turn_alternate_contractions_round() -> None:
    assert wish(REST, WEAK, REST, (0.06, 0.4), REST, WEAK, table=single("alternate")) < 0


@pytest.mark.parametrize("rule", ["two_state", "alternate"])
def test_what_is_contracted_at_the_start_after_a_reset_or_a_gap_must_rest_first(
    rule: Literal["two_state", "alternate"],
) -> None:
    played = Played(single(rule))
    played.step(muscles(STRONG))
    assert (played.wish, played.tense) == (0.0, True)
    played.step(muscles(REST, STRONG))
    assert played.wish
    played.scheme.reset()
    played.step(muscles(STRONG))
    assert played.wish == 0.0
    played.step(np.concatenate((muscles(REST, STRONG), lost(0.1), muscles(STRONG))))
    assert played.wish == 0.0


def test_another_site_toggles() -> None:
    played = Played(single(toggle="third"))
    assert played.step(muscles(REST, (0.3, 0.0, 0.0, 0.8))) == [FORWARD]


@settings(max_examples=6, deadline=None)
@given(
    rule=st.sampled_from(["two_state", "alternate"]),
    cuts=st.lists(st.integers(0, 10_000), max_size=40),
    seed=st.integers(0, 100),
)
def test_what_is_asked_is_the_same_however_samples_are_cut(
    rule: Literal["two_state", "alternate"], cuts: list[int], seed: int
) -> None:
    samples = muscles(REST, WEAK, REST, STRONG, REST, (0.06, 0.4), REST, WEAK, seed=seed)
    samples[300:315] = np.nan
    same_however_cut(single(rule), samples, cuts)
