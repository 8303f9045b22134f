"""Each learner equals the slow one that stands in the paper, whatever it is told."""

from collections.abc import Callable

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.learn.algorithms import journeys, oracles_adaptive, oracles_fixed
from tests.learn.algorithms.journeys import SIZE, Journey, Numbers, learner, predictions

seeds = st.integers(0, 2**32 - 1)
few = settings(max_examples=8, deadline=None)
W = [0.4] * SIZE
FIXED: dict[str, Callable[[Journey, Numbers, float], Numbers]] = {
    "td": lambda journey, w, alpha: oracles_fixed.td(journey, w, alpha, "accumulating"),
    "td_replacing": lambda journey, w, alpha: oracles_fixed.td(journey, w, alpha, "replacing"),
    "td_normalised": lambda journey, w, alpha: oracles_fixed.td(journey, w, alpha * SIZE, "normalised"),
    "true_online": oracles_fixed.algorithm_1,
    "true_online_5": oracles_fixed.equations_5,
}


def heard(name: str, experience: Journey, step_size: float, **options: float) -> Numbers:
    given = journeys.settings(step_size, initial=W[0], options=options)
    return predictions(learner(name, given), experience)


@pytest.mark.parametrize("name", FIXED)
@few
@given(seeds, st.floats(0.01, 1))
def test_learners_with_one_step_size_do_what_the_thesis_says(name: str, seed: int, step_size: float) -> None:
    experience = journeys.journey(seed, rho=not name.startswith("true_online"))
    expected = FIXED[name](experience, W, step_size / SIZE)
    assert heard(name, experience, step_size) == pytest.approx(expected, rel=1e-8, abs=1e-8)


@pytest.mark.parametrize("name", ["td", "true_online", "true_online_5"])
@few
@given(seeds)
def test_features_may_be_real_numbers(name: str, seed: int) -> None:
    experience = journeys.journey(seed, binary=False)
    expected = FIXED[name](experience, W, 0.02 / SIZE)
    assert heard(name, experience, 0.02) == pytest.approx(expected, rel=1e-8, abs=1e-8)


@pytest.mark.parametrize("name", ["true_online", "true_online_5"])
@few
@given(seeds, st.floats(0.01, 1))
def test_true_online_td_is_the_forward_view_while_gamma_and_lambda_change(
    name: str, seed: int, step_size: float
) -> None:
    experience = journeys.journey(seed, steps=10, gaps=False)
    expected = oracles_fixed.forward_view(experience, W, step_size / SIZE)
    assert heard(name, experience, step_size) == pytest.approx(expected, rel=1e-9, abs=1e-9)


def test_td_with_accumulating_traces_is_not_the_forward_view() -> None:
    experience = journeys.journey(3, steps=10, gaps=False)
    expected = oracles_fixed.forward_view(experience, W, 0.8 / SIZE)
    assert heard("td", experience, 0.8) != pytest.approx(expected, rel=1e-3)


@few
@given(seeds, st.floats(0.01, 1))
def test_both_forms_of_true_online_td_agree(seed: int, step_size: float) -> None:
    experience = journeys.journey(seed)
    first, second = (heard(name, experience, step_size) for name in ("true_online", "true_online_5"))
    assert first == pytest.approx(second, rel=1e-10, abs=1e-10)


@few
@given(seeds, st.floats(0.01, 0.3), st.floats(0, 3))
def test_gtd_does_what_the_paper_says(seed: int, step_size: float, eta: float) -> None:
    experience = journeys.journey(seed, rho=True)
    expected = oracles_fixed.gtd(experience, W, step_size / SIZE, eta * step_size / SIZE)
    assert heard("gtd", experience, step_size, eta=eta) == pytest.approx(expected, rel=1e-8, abs=1e-8)


@pytest.mark.parametrize("binary", [True, False])
@few
@given(seeds, st.floats(0.01, 1), st.floats(0, 0.1))
def test_tidbd_does_what_the_paper_says(binary: bool, seed: int, step_size: float, theta: float) -> None:
    experience = journeys.journey(seed, binary=binary)
    expected = oracles_adaptive.tidbd(experience, W, step_size / SIZE, theta)
    assert heard("tidbd", experience, step_size, theta=theta) == pytest.approx(expected, rel=1e-7, abs=1e-7)


@pytest.mark.parametrize("binary", [True, False])
@few
@given(seeds, st.floats(0.01, 1), st.floats(0, 0.2), st.floats(1, 1000))
def test_autostep_does_what_the_papers_say(
    binary: bool, seed: int, step_size: float, theta: float, tau: float
) -> None:
    experience = journeys.journey(seed, binary=binary)
    expected = oracles_adaptive.autostep(experience, W, step_size / SIZE, theta, tau)
    ours = heard("autostep", experience, step_size, theta=theta, tau=tau)
    assert ours == pytest.approx(expected, rel=1e-7, abs=1e-7)


@pytest.mark.parametrize("binary", [True, False])
@few
@given(seeds, st.floats(0.01, 1), st.floats(0, 0.03), st.floats(0.05, 1))
def test_swifttd_does_what_the_paper_says(
    binary: bool, seed: int, step_size: float, theta: float, eta: float
) -> None:
    experience = journeys.journey(seed, binary=binary)
    expected = oracles_adaptive.swifttd(experience, W, step_size / SIZE, theta, eta, 0.9, 1e-6)
    ours = heard("swifttd", experience, step_size, theta=theta, eta=eta, decay=0.9, eta_min=1e-6)
    assert ours == pytest.approx(expected, rel=1e-7, abs=1e-7)


@few
@given(seeds, st.floats(0.01, 1))
def test_swifttd_that_adapts_nothing_is_true_online_td(seed: int, step_size: float) -> None:
    experience = journeys.journey(seed)
    expected = heard("true_online", experience, step_size)
    ours = heard("swifttd", experience, step_size, theta=0, eta=1)
    assert ours == pytest.approx(expected, rel=1e-10, abs=1e-10)
