"""A short, strong contraction of one muscle toggles; anything else that it does moves the arm."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bentod.config_sites import CoContraction, Pair, Pulse
from bentod.control.switching import BACKWARD, FORWARD
from tests.control.scheme_rig import RATE_HZ, REST, Played, lost, muscles, same_however_cut

BEAT = (0.15, 0.0, 1.0)


def pair(**changes: float | str) -> Pair:
    pulse = Pulse.model_validate({"site": "extensor"} | changes)
    return Pair(group="arm", positive="flexor", negative="extensor", pulse=pulse)


def toggles(*stretches: tuple[float, ...], table: Pair | None = None) -> list[int]:
    return Played(table or pair()).step(muscles(*stretches))


def test_a_pulse_toggles_once_and_moves_nothing() -> None:
    found, wishes = Played(pair()).course(muscles(REST, BEAT, REST))
    assert [step for _, step in found] == [FORWARD]
    assert set(wishes) == {0.0}


def test_a_pulse_may_toggle_back_while_a_squeeze_goes_on() -> None:
    both = pair(direction="backward").model_copy(update={"co_contraction": CoContraction()})
    played = Played(both)
    assert played.step(muscles(REST, BEAT, REST)) == [BACKWARD]
    assert played.step(muscles((0.4, 0.8, 0.8), REST)) == [FORWARD]


@pytest.mark.parametrize(
    "contraction",
    [(0.15, 0.0, 0.5), (0.6, 0.0, 1.0), (0.15, 1.0, 0.0), (0.15, 1.0, 1.0), (0.02, 0.0, 1.0)],
    ids=["weak", "long", "of the other muscle", "of both", "too short for a muscle"],
)
def test_another_contraction_is_no_pulse(contraction: tuple[float, ...]) -> None:
    assert toggles(REST, contraction, REST) == []


def test_a_contraction_that_grows_slowly_moves_the_arm_after_a_moment() -> None:
    samples = muscles(REST, (0.2, 0.0, 0.5), (0.2, 0.0, 1.0), (0.5, 0.0, 0.0))
    found, wishes = Played(pair()).course(samples)
    first = next(index for index, wish in enumerate(wishes) if wish)
    assert found == []
    assert (first / RATE_HZ - 0.5) == pytest.approx(0.12, abs=0.04)
    assert min(wishes) == pytest.approx(-1.0)


def test_the_other_muscle_moves_the_arm_at_once() -> None:
    played = Played(pair())
    played.step(muscles(REST, (0.06, 0.6, 0.0)))
    assert played.wish > 0.4


def test_a_pulse_in_the_middle_of_a_motion_does_not_toggle() -> None:
    assert toggles(REST, (0.3, 0.0, 0.4), BEAT, (0.3, 0.0, 0.4), REST) == []


def test_pulses_one_upon_the_other_count_once() -> None:
    assert toggles(REST, BEAT, (0.15, 0.0, 0.0), BEAT, REST) == [FORWARD]
    assert toggles(REST, BEAT, (0.7, 0.0, 0.0), BEAT, REST) == [FORWARD, FORWARD]


def test_one_bad_sample_is_no_pulse() -> None:
    samples = muscles(REST, REST)
    samples[60, 1] = 1.0
    assert Played(pair()).step(samples) == []


def test_lost_samples_and_a_reset_forget_a_pulse_under_way() -> None:
    played = Played(pair())
    gap = np.concatenate((muscles(REST, (0.1, 0.0, 1.0)), lost(0.1), muscles(REST)))
    assert played.step(gap) == []
    played.step(muscles((0.1, 0.0, 1.0)))
    played.scheme.reset()
    assert played.step(muscles(REST)) == []
    assert played.step(muscles(BEAT, REST)) == [FORWARD]


@settings(max_examples=6, deadline=None)
@given(cuts=st.lists(st.integers(0, 10_000), max_size=40), seed=st.integers(0, 100))
def test_pulses_are_the_same_however_samples_are_cut(cuts: list[int], seed: int) -> None:
    samples = muscles(REST, BEAT, REST, (0.5, 0.0, 0.6), REST, BEAT, REST, seed=seed)
    samples[200:212] = np.nan
    same_however_cut(pair(), samples, cuts)
