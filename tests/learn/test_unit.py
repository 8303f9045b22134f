"""One unit of questions in time: several ticks at once, a γ that the state decides, a policy, blindness."""

import math
from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from bentod.config_learn import Gvf, RepresentationTable, Tiles
from bentod.learn.assembly import Means, assembled
from bentod.learn.expression import Vocabulary
from bentod.learn.horde import Horde
from bentod.learn.kernel import choose
from bentod.learn.questions import questions_of
from bentod.learn.representation import state_coding
from bentod.learn.signals import Declared
from bentod.learn.unit import Discount

SIGNALS = Declared({"place": (0.0, 1.0), "value": None, "go_on": None, "rho": None})
STATES = 4
VALUES = np.array([1.0, -2.0, 0.5, 3.0])


def new_horde(**keys: object) -> Horde:
    """One question over a chain of four places, each with a feature of its own."""
    table = {
        "name": "it",
        "cumulant": "value",
        "representation": "chain",
        "step_size": 0.3,
        "trace_lambda": 0.9,
    }
    asked = questions_of(Gvf.model_validate(table | keys), SIGNALS, 30.0)
    tiles = Tiles(inputs=("place",), tilings=1, width=1 / STATES)
    vocabulary = Vocabulary(SIGNALS)
    chain = RepresentationTable(name="chain", bias=False, tiles=(tiles,))
    coding = state_coding(chain, vocabulary, "chain")
    return Horde(assembled(asked, Means(vocabulary, {"chain": coding}, choose(), np.float64)))


class Life:
    """Arrivals at places of the chain, and what was predicted and learned there."""

    def __init__(self, horde: Horde) -> None:
        self.horde = horde
        self._tick = -1

    def arrive(
        self, place: float, value: float, elapsed: int = 1, steps: int | None = None, **told: float
    ) -> float:
        self._tick += elapsed
        signals = np.array([place, value, told.get("go_on", math.nan), told.get("rho", math.nan)])
        self.horde.begin(self._tick, signals, elapsed, elapsed if steps is None else steps)
        self.horde.step()
        return self.horde.answers.newest("it")

    @property
    def delta(self) -> float:
        return float(self.horde.answers.delta[0])

    @property
    def weights(self) -> NDArray[np.float64]:
        """By place."""
        places = [self.horde.encoders["chain"].coding.encode(np.array([at(i)]))[0] for i in range(STATES)]
        return self.horde.units[0].pupils.weights()[places, 0]


def at(state: int) -> float:
    """The middle of a place."""
    return (state + 0.5) / STATES


def go_round(life: Life, turns: int, elapsed: int = 1) -> None:
    """Round and round the four places."""
    for turn in range(turns):
        state = turn % STATES
        life.arrive(at(state), VALUES[state], elapsed)


@given(st.floats(0, 1), st.integers(1, 9), st.floats(-5, 5), st.booleans())
def test_several_ticks_at_once_are_worth_their_sum(gamma: float, ticks: int, c: float, scaled: bool) -> None:
    discount = Discount(gamma, 0.9, np.array([scaled]))
    factor = 1 - gamma if scaled else 1.0
    expected = sum(gamma**i * factor * c for i in range(ticks))
    assert discount.rewards(np.array([c]), gamma, ticks)[0] == pytest.approx(expected, rel=1e-9, abs=1e-12)


def test_scaled_and_unscaled_questions_of_a_unit_have_rewards_of_their_own() -> None:
    discount = Discount(0.5, 0.9, np.array([True, False, False]))
    assert discount.rewards(np.array([2.0, 2.0, math.nan]), 0.5, 2).tolist()[:2] == [1.5, 3.0]
    assert discount.rewards(np.array([2.0, 2.0, math.nan]), 1.0, 3).tolist()[:2] == [0.0, 6.0]


@pytest.mark.parametrize("algorithm", ["true_online", "td"])
def test_who_sees_every_third_tick_of_a_steady_signal_expects_what_a_patient_one_would(
    algorithm: str,
) -> None:
    """The signal stays for three ticks, and is seen in the last of them."""
    life = Life(new_horde(timescale=8.0, algorithm=algorithm))
    go_round(life, 200, elapsed=3)
    gamma = 1 - 1 / 8
    coming = [VALUES[(1 + tick // 3) % STATES] for tick in range(400)]  # ticks, from the last one in place 0
    ideal = [sum((1 - gamma) * gamma**i * c for i, c in enumerate(coming[3 * s :][:250])) for s in range(4)]
    assert life.weights == pytest.approx(ideal, abs=0.02)


@pytest.mark.parametrize("ticks", [2, 3])
def test_a_step_of_several_ticks_is_discounted_by_as_many(ticks: int) -> None:
    life = Life(new_horde(timescale=5.0, trace_lambda=0.0))
    life.arrive(at(0), 0.0)
    life.arrive(at(1), 2.0)
    before, gamma = life.weights, 0.8
    life.arrive(at(2), 4.0, elapsed=ticks)
    reward = sum(gamma**i * 0.2 * 4.0 for i in range(ticks))
    assert life.delta == pytest.approx(reward + gamma**ticks * before[2] - before[1], abs=1e-12)


def test_the_trace_fades_as_often_as_ticks_have_passed() -> None:
    life = Life(new_horde(gamma=0.8, trace_lambda=0.5, algorithm="td"))
    for state, elapsed in ((0, 1), (1, 2), (2, 1)):
        life.arrive(at(state), 0.0, elapsed)
    before = life.weights
    life.arrive(at(3), 1.0)
    moved = life.weights - before
    assert moved[1] / moved[2] == pytest.approx(0.8 * 0.5)
    assert moved[0] / moved[1] == pytest.approx((0.8 * 0.5) ** 2)


def test_a_gap_that_cannot_be_spanned_teaches_nothing_and_ends_the_trace() -> None:
    life = Life(new_horde(timescale=5.0))
    go_round(life, 20)
    before = life.weights
    life.arrive(at(0), 100.0, elapsed=7, steps=0)
    assert math.isnan(life.delta)
    life.arrive(at(1), 50.0)
    changed = np.flatnonzero(np.abs(life.weights - before) > 1e-12)
    assert changed.tolist() == [0]


def test_a_gamma_that_the_state_decides_ends_returns_where_it_is_0() -> None:
    """From each place on: how many ticks until the last place is reached."""
    life = Life(new_horde(cumulant="1", gamma="below(place, 0.75)", scaling="cumulative", step_size=0.5))
    for turn in range(160):
        life.arrive(at(turn % STATES), 0.0)
    # The first tick of a round comes from the last place: it needs four ticks to be there again.
    assert life.weights == pytest.approx([3, 2, 1, 4], abs=1e-6)


@pytest.mark.parametrize(("told", "kept"), [(1.7, 1.0), (-0.3, 0.0), (0.25, 0.25)])
def test_a_gamma_beyond_its_bounds_is_kept_within_them(told: float, kept: float) -> None:
    life = Life(new_horde(gamma="go_on", scaling="cumulative"))
    for state in range(2):
        life.arrive(at(state), 1.0, go_on=0.5)
    before = life.weights
    life.arrive(at(0), 1.0, go_on=told)
    assert life.delta == pytest.approx(1.0 + kept * before[0] - before[1])


def test_while_gamma_is_not_known_nothing_is_learned_but_all_is_predicted() -> None:
    life = Life(new_horde(gamma="go_on", scaling="cumulative"))
    for turn in range(8):
        life.arrive(at(turn % STATES), 1.0, go_on=0.5)
    before = life.weights
    assert life.arrive(at(2), 1.0, go_on=math.nan) == pytest.approx(before[2])
    assert math.isnan(life.delta)
    np.testing.assert_allclose(life.weights, before, rtol=0, atol=1e-12)
    life.arrive(at(3), 1.0, go_on=0.5)
    assert not math.isnan(life.delta)


def test_a_cumulant_that_is_not_known_is_predicted_and_teaches_nothing() -> None:
    life = Life(new_horde(timescale=5.0, algorithm="td"))
    go_round(life, 20)
    before = life.weights
    assert life.arrive(at(0), math.nan) == pytest.approx(before[0])
    assert math.isnan(life.delta)
    np.testing.assert_allclose(life.weights, before, rtol=0, atol=1e-12)


@pytest.mark.parametrize("algorithm", ["gtd", "td"])
def test_a_policy_that_would_not_have_done_it_learns_nothing_from_it(algorithm: str) -> None:
    life = Life(new_horde(gamma=0.0, policy="rho", algorithm=algorithm, trace_lambda=0.0))
    for turn in range(200):
        other = turn % 2 == 0
        # Every other tick something else is done, and brings something else.
        life.arrive(at(0), 9.0 if other else 1.0, rho=0.0 if other else 2.0)
    assert life.weights[0] == pytest.approx(1.0, abs=1e-6)


def test_a_policy_is_never_less_likely_than_not_at_all() -> None:
    negative, zero = (Life(new_horde(gamma=0.5, policy="rho", algorithm="gtd")) for _ in range(2))
    for turn in range(20):
        for life, rho in ((negative, -3.0), (zero, 0.0)):
            life.arrive(at(turn % STATES), 1.0, rho=rho if turn % 3 else 1.0)
    np.testing.assert_array_equal(negative.weights, zero.weights)


def test_who_is_blind_makes_no_prediction_and_later_learns_only_from_what_it_saw() -> None:
    life = Life(new_horde(timescale=5.0))
    go_round(life, 20)
    before, newest = life.weights, life.horde.answers.newest("it")
    for age in (1, 2):
        assert life.arrive(math.nan, 9.0) == newest
        assert math.isnan(life.horde.answers.fresh("it"))
        assert life.horde.answers.older() == {"it": age}
    life.arrive(at(2), 9.0)
    assert math.isnan(life.delta)
    assert life.horde.answers.older() == {}
    np.testing.assert_allclose(life.weights, before, rtol=0, atol=1e-12)


@pytest.mark.parametrize(
    ("algorithm", "options"),
    [("true_online", {}), ("td_replacing", {}), ("gtd", {"eta": 0.1}), ("swifttd", {})],
)
def test_every_kind_of_learner_finds_the_values_of_a_ring(algorithm: str, options: Sequence[float]) -> None:
    life = Life(new_horde(timescale=4.0, algorithm=algorithm, options=options, step_size=0.2))
    go_round(life, 240)
    gamma, ideal = 0.75, np.zeros(STATES)
    for _ in range(60):
        for state in reversed(range(STATES)):
            after = (state + 1) % STATES
            ideal[state] = (1 - gamma) * VALUES[after] + gamma * ideal[after]
    assert life.weights == pytest.approx(ideal, abs=0.02)
