"""Squeezes of both muscles: meant ones toggle once, and movements to and fro never do."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bentod.config_sites import CoContraction, Pair
from bentod.control.proportional import Site
from bentod.control.switching import BACKWARD, FORWARD
from sim.antagonists import Habits, squeezes, to_and_fro
from tests.control.scheme_rig import RATE_HZ, REST, Played, lost, muscles, same_however_cut

ARM = (Site("flexor", 0, 1.0, 15e-6, 60e-6), Site("extensor", 1, 1.0, 10e-6, 35e-6))
"""Thresholds of a biceps and a triceps, with which a real recording has both above for 5.7 % of the time."""


def pair(**changes: float | str) -> Pair:
    squeeze = CoContraction.model_validate(changes)
    return Pair(group="arm", positive="flexor", negative="extensor", co_contraction=squeeze)


def toggles(*stretches: tuple[float, ...], table: Pair | None = None, seed: int | None = None) -> list[int]:
    return Played(table or pair()).step(muscles(*stretches, seed=seed))


SQUEEZE = (0.4, 0.8, 0.7)


def test_a_squeeze_of_both_toggles_once() -> None:
    assert toggles(REST, SQUEEZE, REST) == [FORWARD]
    assert toggles(REST, SQUEEZE, REST, table=pair(direction="backward")) == [BACKWARD]


@pytest.mark.parametrize("seed", range(5))
def test_a_squeeze_that_is_held_for_a_minute_toggles_once_and_moves_nothing(seed: int) -> None:
    played = Played(pair())
    assert played.step(muscles(REST, (60.0, 0.8, 0.5), seed=seed)) == [FORWARD]
    assert played.wish == 0.0


def test_a_squeeze_never_moves_the_arm_from_its_beginning_to_its_end() -> None:
    uneven = muscles(REST, (0.05, 0.8, 0.0), (0.5, 0.8, 0.6), (0.3, 0.0, 0.6), REST)
    found, wishes = Played(pair()).course(uneven)
    assert [step for _, step in found] == [FORWARD]
    assert set(wishes) == {0.0}


def test_after_a_squeeze_the_arm_moves_again_once_both_were_released() -> None:
    played = Played(pair())
    played.step(muscles(REST, SQUEEZE, (0.2, 0.0, 0.0), (0.4, 0.6, 0.0)))
    assert played.wish == pytest.approx(0.5, abs=0.05)


def test_one_muscle_moves_the_arm_once_the_other_cannot_join_in_any_more() -> None:
    samples = muscles(REST, (1.0, 0.6, 0.0))
    found, wishes = Played(pair()).course(samples)
    first = next(index for index, wish in enumerate(wishes) if wish)
    assert found == []
    assert (first / RATE_HZ - 0.5) == pytest.approx(0.12, abs=0.04)


def test_a_muscle_that_joins_in_later_brakes_and_does_not_toggle() -> None:
    assert toggles(REST, (0.3, 0.8, 0.0), SQUEEZE, REST) == []
    assert toggles(REST, (0.3, 0.8, 0.0), SQUEEZE, REST, table=pair(together_s=0.4)) == [FORWARD]


def test_a_squeeze_that_is_over_too_soon_is_none() -> None:
    assert toggles(REST, (0.08, 0.8, 0.8), REST) == []
    assert toggles(REST, (0.08, 0.8, 0.8), REST, table=pair(dwell_s=0.08)) == [FORWARD]


def test_a_muscle_that_only_accompanies_the_other_is_no_squeeze() -> None:
    played = Played(pair())
    assert played.step(muscles(REST, (0.6, 1.0, 0.3))) == []
    assert played.wish > 0.5
    assert toggles(REST, (0.6, 1.0, 0.3), REST, table=pair(balance=0.2)) == [FORWARD]


def test_both_must_rest_before_the_next_squeeze() -> None:
    short, long = (0.12, 0.0, 0.0), (0.4, 0.0, 0.0)
    assert toggles(REST, SQUEEZE, short, SQUEEZE, REST) == [FORWARD]
    assert toggles(REST, SQUEEZE, long, SQUEEZE, REST) == [FORWARD, FORWARD]


def test_a_squeeze_soon_after_a_toggle_neither_toggles_nor_moves() -> None:
    hasty = pair(refractory_s=2.0)
    found, wishes = Played(hasty).course(muscles(REST, SQUEEZE, REST, SQUEEZE, REST))
    assert len(found) == 1
    assert set(wishes) == {0.0}
    assert toggles(REST, SQUEEZE, (2.0, 0.0, 0.0), SQUEEZE, table=hasty) == [FORWARD, FORWARD]


def test_a_squeeze_while_the_pair_moves_the_arm_does_not_toggle() -> None:
    assert toggles(REST, (1.0, 0.0, 0.6), (1.0, 0.7, 0.7), REST) == []


def test_a_squeeze_that_was_there_at_the_start_or_at_a_reset_is_nobodys() -> None:
    played = Played(pair())
    assert played.step(muscles((1.0, 0.8, 0.7))) == []
    assert played.wish == 0.0
    played.step(muscles(REST, (0.14, 0.8, 0.7)))
    played.scheme.reset()
    assert played.step(muscles((1.0, 0.8, 0.7))) == []
    assert played.wish == 0.0
    assert played.step(muscles(REST, SQUEEZE)) == [FORWARD]


@pytest.mark.parametrize("before_s", [0.05, 0.12, 0.3])
def test_lost_samples_never_make_a_toggle_and_nothing_moves_until_both_rested(before_s: float) -> None:
    played = Played(pair())
    played.step(muscles(REST, (before_s, 0.0, 0.0)))
    assert played.step(np.concatenate((muscles((0.02, 0.8, 0.7)), lost(0.2), muscles((1.0, 0.8, 0.2))))) == []
    assert played.wish == 0.0
    assert played.step(muscles(REST, SQUEEZE)) == [FORWARD]


def test_a_lead_that_is_off_does_not_keep_the_other_muscle_from_moving_the_arm() -> None:
    samples = muscles(REST, REST, (0.5, 0.6, 0.0))
    samples[60:, 1] = np.nan
    played = Played(pair())
    assert played.step(samples) == []
    assert played.wish > 0.4


def test_one_bad_sample_on_both_channels_is_no_squeeze() -> None:
    samples = muscles(REST, REST)
    samples[60] = 1.0
    assert Played(pair()).step(samples) == []


def test_muscles_are_tense_as_long_as_they_are_squeezed() -> None:
    played = Played(pair())
    played.step(muscles(REST))
    assert not played.tense
    played.step(muscles((0.3, 0.7, 0.7)))
    assert (played.wish, played.tense) == (0.0, True)


@pytest.mark.parametrize("rate_hz", [200.0, 1000.0])
def test_movements_to_and_fro_with_both_contracted_at_the_turns_never_toggle(rate_hz: float) -> None:
    samples = to_and_fro(105.0, rate_hz, seed=4)
    played = Played(pair(), rate_hz, ARM)
    assert played.step(samples) == []
    assert 0.035 < both_above(samples, rate_hz) < 0.08


def both_above(samples: np.ndarray, rate_hz: float) -> float:
    """Share of the time in which both are above their thresholds."""
    window = np.ones(round(0.05 * rate_hz)) / round(0.05 * rate_hz)
    loud = [np.convolve(np.abs(samples[:, site.channel]), window) > site.threshold for site in ARM]
    return float(np.mean(np.logical_and(*loud)))


def test_a_detector_without_patience_would_be_fooled_by_them() -> None:
    samples = to_and_fro(105.0, RATE_HZ, seed=4, habits=Habits(company=(0.4, 0.6)))
    careless = pair(together_s=0.5, dwell_s=0.06, balance=0.0, rest_s=0.05, refractory_s=0.0)
    assert len(Played(careless, RATE_HZ, ARM).step(samples)) > 5


def test_squeezes_as_people_make_them_are_not_missed() -> None:
    samples, onsets = squeezes(100, RATE_HZ, seed=5)
    played = Played(pair(), RATE_HZ, ARM)
    counts = [len(played.step(piece)) for piece in np.split(samples, onsets)]
    assert counts.pop(0) == 0
    assert counts.count(0) <= 2
    assert max(counts) == 1


@settings(max_examples=6, deadline=None)
@given(cuts=st.lists(st.integers(0, 10_000), max_size=40), seed=st.integers(0, 100))
def test_squeezes_are_the_same_however_samples_are_cut(cuts: list[int], seed: int) -> None:
    samples = muscles(REST, SQUEEZE, REST, (0.5, 0.6, 0.3), REST, SQUEEZE, REST, seed=seed)
    samples[230:245] = np.nan
    same_however_cut(pair(), samples, cuts)
