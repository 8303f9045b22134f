import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from bentod.contracts import Features
from bentod.learn.confidence.uncertainty import Uncertainty
from bentod.learn.group import Group
from bentod.learn.lazy_numpy import NumpyKernel
from tests.learn.confidence.oracles import Experience, Vector, equation_6_5, equation_6_5_as_printed

SIZE = 15
ONE = np.ones(1)
seeds = st.integers(0, 2**32 - 1)
sigmas = st.sampled_from([0.0, 1e-5, 0.01, 0.05])


def experience(seed: int, steps: int = 60, active: int | None = 5) -> Experience:
    """Features of which a few change in a step; `active` None: their number changes too."""
    rng = np.random.default_rng(seed)
    order = rng.permutation(SIZE)
    features = []
    for _ in range(steps + 1):
        i, j = rng.integers(SIZE, size=2)
        order[[i, j]] = order[[j, i]]
        count = active or int(rng.integers(1, SIZE + 1))
        features.append(np.sort(order[:count]))
    errors = np.where(rng.random(steps) < 0.1, np.nan, rng.random(steps))
    return Experience(features, errors.tolist(), SIZE)


def replay(uncertainty: Uncertainty, lived: Experience) -> tuple[list[Vector], list[float]]:
    """ζ_t and U_t of the first GVF at every step."""
    before: Features | None = None
    zetas, uncertainties = [], []
    for now, error in zip(lived.features, [np.nan, *lived.errors], strict=True):
        u, c = uncertainty.step(before, np.full(uncertainty.count, -error), now, np.ones(uncertainty.count))
        assert c[0] == min(1 - u[0], 1)
        zetas.append(uncertainty.zeta[:, 0])
        uncertainties.append(float(u[0]))
        before = now
    return zetas, uncertainties


@settings(max_examples=25)
@given(seeds, st.floats(0.06, 1), sigmas)
def test_zeta_and_u_are_those_of_6_5_element_by_element(seed: int, eta: float, sigma: float) -> None:
    lived = experience(seed, active=None)
    zetas, us = replay(Uncertainty(SIZE, ONE, eta, sigma), lived)
    expected, expected_us = equation_6_5(lived, eta, sigma)
    np.testing.assert_allclose(zetas, expected, rtol=0, atol=1e-12)
    np.testing.assert_allclose(us, expected_us, rtol=0, atol=1e-12)


@settings(max_examples=12)
@given(seeds, st.floats(0.06, 1), sigmas)
def test_with_a_constant_number_of_features_it_is_the_rule_as_printed(
    seed: int, eta: float, sigma: float
) -> None:
    lived = experience(seed)
    taught = Experience(lived.features, np.nan_to_num(lived.errors, nan=0.5).tolist(), SIZE)
    zetas, us = replay(Uncertainty(SIZE, ONE, eta, sigma), taught)
    expected, expected_us = equation_6_5_as_printed(taught, eta / 5, sigma)
    np.testing.assert_allclose(np.array(zetas) / 5, expected, rtol=0, atol=1e-12)
    np.testing.assert_allclose(us, expected_us, rtol=0, atol=1e-12)


def test_it_stays_exact_when_the_scale_begins_anew() -> None:
    lived = experience(7, steps=700, active=None)
    zetas, us = replay(Uncertainty(SIZE, ONE, 0.5, 0.4), lived)  # 0.6^700 = 1e-155
    expected, expected_us = equation_6_5(lived, 0.5, 0.4)
    np.testing.assert_allclose(zetas, expected, rtol=0, atol=1e-12)
    np.testing.assert_allclose(us, expected_us, rtol=0, atol=1e-12)


def test_single_precision_costs_digits_that_no_confidence_needs() -> None:
    lived = experience(8, steps=1500, active=None)
    _, us = replay(Uncertainty(SIZE, ONE, 0.3, 0.05, np.float32), lived)
    np.testing.assert_allclose(us, equation_6_5(lived, 0.3, 0.05)[1], rtol=0, atol=1e-5)


def test_nothing_is_known_at_first_wherever_the_arm_is() -> None:
    for active in (1, 7, SIZE):
        u, c = Uncertainty(SIZE, ONE).step(None, np.array([np.nan]), np.arange(active), ONE)
        assert (u[0], c[0]) == (1, 0)


class World:
    """A signal that goes round in eight places, with features of their own and some that they share."""

    def __init__(self) -> None:
        self.learner = Group(np.zeros((60, 1)), np.zeros(1), "true_online", 0.3 / 5, NumpyKernel())
        self.uncertainty = Uncertainty(60, np.array([np.nan]))
        self.signal = np.array([0.0, 1.0, 1.0, 0.0, 1.0, 0.0, 0.0, 1.0])
        self.before: Features | None = None
        self.guess = 0.0

    def live(self, laps: int, places: int = 8) -> float:
        """Mean C over the last lap."""
        for _ in range(laps):
            cs = [self.visit(place) for place in range(places)]
        return float(np.mean(cs))

    def visit(self, place: int) -> float:
        features = np.unique([5 * place, 5 * place + 1, 5 * place + 2, 50 + place // 2, 55 + place // 4])
        reward = 0.2 * self.signal[place]
        prediction = float(self.learner.step(features, np.array([reward]), 0.8, 0.9)[0])
        # The error is told as learners tell it: of the prediction before, and the one here before learning.
        delta = reward + 0.8 * prediction - self.guess
        _, c = self.uncertainty.step(self.before, np.array([delta]), features, np.array([reward]))
        self.before, self.guess = features, prediction
        return float(c[0])

    def look_at(self, features: Features) -> float:
        """C somewhere, without going there."""
        zeta = self.uncertainty.zeta
        return 1 - float(zeta[features].mean())


def test_confidence_rises_with_experience_in_a_state() -> None:
    world = World()
    assert world.live(1) < 0.1 < 0.3 < world.live(5) < 0.6 < 0.9 < world.live(30) <= 1


def test_confidence_is_low_in_states_that_were_never_seen() -> None:
    world = World()
    world.live(100, places=4)
    assert world.look_at(np.array([0, 1, 2, 50, 55])) > 0.9
    assert world.look_at(np.array([35, 36, 37, 53, 56])) == pytest.approx(0, abs=1e-9)
    assert 0.1 < world.look_at(np.array([20, 21, 22, 51, 55])) < 0.8  # some of it looks familiar


def test_confidence_falls_when_the_world_changes_and_comes_back() -> None:
    world = World()
    settled = world.live(150)
    world.signal = 1 - world.signal
    assert world.live(3) < settled - 0.15
    assert world.live(150) > settled - 0.05


def test_what_is_known_of_a_state_is_half_forgotten_after_a_quarter_of_an_hour() -> None:
    here, away = np.arange(5), np.arange(5, 10)
    uncertainty, nothing = Uncertainty(SIZE, ONE), np.zeros(1)
    uncertainty.step(None, nothing, here, nothing)
    for _ in range(300):
        _, c = uncertainty.step(here, nothing, here, nothing)
    assert c[0] == pytest.approx(1, abs=0.001)
    uncertainty.step(here, nothing, away, nothing)
    for _ in range(15 * 60):
        uncertainty.step(None, nothing, away, nothing, ticks=30)
    _, c = uncertainty.step(None, nothing, here, nothing)
    assert c[0] == pytest.approx(0.5, abs=0.02)


def test_missed_ticks_age_what_is_known_as_if_they_had_been() -> None:
    here, nothing = np.arange(5), np.zeros(1)
    one, many = Uncertainty(SIZE, ONE, sigma=0.01), Uncertainty(SIZE, ONE, sigma=0.01)
    for it in (one, many):
        it.step(None, nothing, here, nothing)
        it.step(here, nothing, here, nothing)
    for _ in range(5):
        u, _ = one.step(None, nothing, here, nothing)
    assert many.step(None, nothing, here, nothing, ticks=5)[0] == pytest.approx(u, abs=1e-14)
    assert many.step(None, nothing, here, nothing, ticks=10**9)[0][0] == 1


def test_an_error_beyond_the_range_counts_as_the_range() -> None:
    here = np.arange(5)
    uncertainty = Uncertainty(SIZE, np.array([2.0, 2.0, 2.0]), eta=0.5)
    zero = np.zeros(3)
    uncertainty.step(None, zero, here, zero)
    for _ in range(20):
        u, _ = uncertainty.step(here, np.array([1.0, 50.0, np.inf]), here, zero)
    np.testing.assert_allclose(u, [0.5, 1, 1], atol=1e-4)


def test_the_range_is_the_span_of_the_cumulant_until_one_is_given() -> None:
    here = np.arange(5)
    uncertainty = Uncertainty(SIZE, np.array([np.nan, 8.0, np.nan]), eta=1.0, sigma=0.0)
    uncertainty.step(None, np.zeros(3), here, np.array([3.0, 3.0, 3.0]))
    uncertainty.step(here, np.ones(3), here, np.array([7.0, 7.0, 3.0]))
    u, c = uncertainty.step(here, np.array([-1.0, 2.0, 0.0]), here, np.array([np.nan, np.inf, 3.0]))
    np.testing.assert_allclose(u, [0.25, 0.25, 1])
    assert c[2] == 0, "a signal that has never moved was never predicted"


def test_a_cumulant_of_several_ticks_does_not_widen_the_span() -> None:
    here = np.arange(5)
    uncertainty = Uncertainty(SIZE, np.array([np.nan]), eta=1.0, sigma=0.0)
    for cumulant, ticks in [(0.0, 1), (1.0, 1), (3.0, 3)]:
        u, _ = uncertainty.step(here, np.array([0.5]), here, np.array([cumulant]), ticks)
    assert u[0] == pytest.approx(0.5)


@pytest.mark.parametrize("sigma", [0.01, 0.4])
def test_gvfs_come_and_go_without_a_trace_in_the_others(sigma: float) -> None:
    lived = experience(3, steps=900)
    kept, alone = Uncertainty(SIZE, np.array([1.0, 2, 4, 8]), 0.5, sigma), Uncertainty(SIZE, ONE, 0.5, sigma)
    alone.grow(1, 8.0)
    others: NDArray[np.float64] = np.array([0.1, 1, 0.1, 1])
    before = None
    for t, (now, error) in enumerate(zip(lived.features, [np.nan, *lived.errors], strict=True)):
        if t == 450:
            kept.take(np.array([3, 1]))
            kept.grow(1, 1.0)
            kept.forget(np.array([1]))
            others = np.array([1, 1.0, 1.0])
            alone.forget(np.array([0]))
        delta = others * error
        u, _ = kept.step(before, delta, now, np.zeros(len(others)))
        expected, _ = alone.step(before, np.full(2, error), now, np.zeros(2))
        before = now
    assert u[0] == pytest.approx(expected[1], abs=1e-12)
    assert u[2] == pytest.approx(expected[0], abs=1e-12)


@pytest.mark.parametrize("precision", [np.float64, np.float32])
def test_what_is_recalled_goes_on_bit_for_bit(precision: type[np.float64] | type[np.float32]) -> None:
    first, then = experience(4, steps=700), experience(5, steps=700)
    old = Uncertainty(SIZE, np.array([np.nan, 1.0]), 0.5, 0.3, precision)
    replay(old, first)
    new = Uncertainty(SIZE, np.array([np.nan, 1.0]), 0.5, 0.3, precision)
    new.recall(old.memory())
    np.testing.assert_array_equal(new.zeta, old.zeta)
    before = first.features[-1]
    for now, error in zip(then.features, [0.3, *then.errors], strict=True):
        got = [it.step(before, np.full(2, error), now, np.array([error, 1.0])) for it in (old, new)]
        np.testing.assert_array_equal(got[0], got[1])
        before = now


@pytest.mark.parametrize(("eta", "sigma"), [(0.1, 0.1), (1.5, 0.1), (0.1, -0.1), (0.0, 0.0)])
def test_rates_that_make_no_sense_are_refused(eta: float, sigma: float) -> None:
    with pytest.raises(ValueError, match="σ must be 0 or more, below η"):
        Uncertainty(SIZE, ONE, eta, sigma)
