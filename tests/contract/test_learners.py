"""What every learner promises, and one from another package would."""

import importlib.metadata
import math
from collections.abc import Mapping

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bentod import registry
from bentod.contracts import Arrival, Learner, LearnerSettings, Vector
from bentod.errors import ConfigError
from tests.learn.algorithms import journeys
from tests.learn.algorithms.journeys import SIZE, journey, learner, predictions

pytestmark = pytest.mark.parametrize("name", sorted(registry.LEARNERS))

HERE = np.array([1.0, 0.0, 1.0, 0.0, 1.0])
THERE = np.array([0.0, 1.0, 1.0, 0.0, 0.0])
SOME = Arrival(1.0, 0.9, 0.8)


def new(name: str, initial: float = 0.5) -> Learner:
    return learner(name, journeys.settings(initial=initial))


def experienced(name: str, seed: int = 1) -> Learner:
    taught = new(name)
    predictions(taught, journey(seed))
    return taught


def same(one: Mapping[str, Vector], other: Mapping[str, Vector]) -> bool:
    return one.keys() == other.keys() and all((one[key] == other[key]).all() for key in one)


def test_the_first_step_only_predicts(name: str) -> None:
    taught = new(name)
    assert taught.step(HERE, SOME) == 1.5
    assert taught.memory()["weights"].tolist() == [0.5] * SIZE
    assert math.isnan(taught.delta)


def test_the_second_step_learns_and_tells_its_error(name: str) -> None:
    taught = new(name)
    taught.step(HERE, SOME)
    taught.step(THERE, SOME)
    assert taught.delta == pytest.approx(1.0 + 0.9 * 1.0 - 1.5)
    assert taught.memory()["weights"][0] > 0.5


def test_after_a_cut_it_learns_as_a_new_learner_with_the_old_weights(name: str) -> None:
    taught = experienced(name)
    before = taught.memory()["weights"]
    taught.cut()
    value = taught.step(HERE, Arrival(1e6, 0.9, 0.8))
    assert taught.memory()["weights"].tolist() == before.tolist()
    assert value == pytest.approx(before @ HERE)
    idle = np.flatnonzero(HERE == 0)
    taught.step(HERE, SOME)
    assert taught.memory()["weights"][idle].tolist() == before[idle].tolist()


def test_a_cumulant_that_was_not_observed_teaches_nothing(name: str) -> None:
    taught = new(name)
    taught.step(HERE, SOME)
    taught.step(THERE, Arrival(math.nan, 0.9, 0.8))
    assert math.isnan(taught.delta)
    assert taught.memory()["weights"].tolist() == [0.5] * SIZE


def test_what_is_learned_after_a_gap_is_credited_to_what_came_before_it(name: str) -> None:
    taught = new(name)
    taught.step(HERE, SOME)
    taught.step(THERE, Arrival(math.inf, 1.0, 1.0))
    taught.step(np.zeros(SIZE), Arrival(50.0, 0.0, 0.0))
    assert taught.memory()["weights"][0] > 0.5


def test_a_way_that_is_not_known_teaches_nothing_and_ends_the_traces(name: str) -> None:
    taught = experienced(name)
    before = taught.memory()["weights"]
    taught.step(HERE, Arrival(1.0, math.nan, 0.8))
    assert taught.memory()["weights"].tolist() == before.tolist()
    assert math.isnan(taught.delta)


@settings(max_examples=5, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_the_same_experience_gives_the_same_predictions_to_the_bit(name: str, seed: int) -> None:
    assert predictions(new(name), journey(seed)) == predictions(new(name), journey(seed))


def test_a_learner_that_recalls_goes_on_as_if_it_had_never_stopped(name: str) -> None:
    taught, woken = experienced(name), new(name, initial=9.0)
    woken.recall(taught.memory())
    assert same(woken.memory(), taught.memory())
    for phi, _, arrival in journey(2).transitions():
        assert woken.step(np.array(phi), arrival) == taught.step(np.array(phi), arrival)


def test_its_memory_is_a_copy(name: str) -> None:
    taught = experienced(name)
    before = taught.memory()
    for vector in taught.memory().values():
        vector.fill(7)
    assert same(taught.memory(), before)
    assert not any("/" in key for key in before)


@pytest.mark.parametrize("fault", ["longer", "without weights", "more", "not finite"])
def test_a_memory_that_does_not_fit_is_refused_and_changes_nothing(name: str, fault: str) -> None:
    taught = experienced(name)
    before = taught.memory()
    memory = taught.memory()
    if fault == "longer":
        memory["weights"] = np.zeros(SIZE + 1)
    elif fault == "without weights":
        del memory["weights"]
    elif fault == "more":
        memory["another"] = np.zeros(SIZE)
    else:
        memory["weights"][2] = math.nan
    with pytest.raises(ValueError, match="memory"):
        taught.recall(memory)
    assert same(taught.memory(), before)


def test_it_neither_changes_nor_keeps_the_features_it_is_given(name: str) -> None:
    taught, undisturbed = new(name), new(name)
    for phi, _, arrival in journey(3).transitions():
        given = np.array(phi)
        taught.step(given, arrival)
        assert given.tolist() == phi
        given.fill(99)
        undisturbed.step(np.array(phi), arrival)
    assert same(taught.memory(), undisturbed.memory())


def test_features_that_are_not_finite_are_refused_and_change_nothing(name: str) -> None:
    taught = experienced(name)
    before = taught.memory()
    for phi in (np.array([1.0, math.nan, 0, 0, 0]), np.array([math.inf, 0, 0, 0, 0]), np.ones(SIZE + 1)):
        with pytest.raises(ValueError, match="features"):
            taught.step(phi, SOME)
    assert same(taught.memory(), before)


def test_a_learner_that_explodes_begins_anew_and_learns_again(name: str) -> None:
    taught = new(name, initial=0.25)
    for _ in range(20):
        assert math.isfinite(taught.step(HERE, Arrival(1.7e308, 1.0, 1.0)))
    assert taught.resets > 0
    for _ in range(1500):
        value = taught.step(HERE, Arrival(1.0, 0.5, 0.5))
    assert value == pytest.approx(2.0, abs=0.05)


def test_no_step_size_overshoots_however_large_the_features_are(name: str) -> None:
    taught = learner(name, journeys.settings(1.0, active=1))
    values = [taught.step(100 * HERE, Arrival(1.0, 0.0, 0.0)) for _ in range(300)]
    assert taught.resets == 0
    assert -0.01 <= min(values) < max(values) <= 1.01


def test_traces_that_fade_never_become_subnormal(name: str) -> None:
    taught = experienced(name)
    for _ in range(3000):
        taught.step(np.zeros(SIZE), Arrival(0.0, 0.9, 0.8))
    for vector in taught.memory().values():
        assert not ((vector != 0) & (np.abs(vector) < 1e-300)).any()


@pytest.mark.parametrize(
    ("wrong", "told"),
    [
        (journeys.settings(step_size=0.0), "step size"),
        (journeys.settings(step_size=1.1), "step size"),
        (journeys.settings(size=0), "at least 1 feature"),
        (journeys.settings(active=0.0), "φ"),
        (journeys.settings(initial=math.nan), "initial"),
    ],
)
def test_settings_out_of_bounds_are_refused(name: str, wrong: LearnerSettings, told: str) -> None:
    with pytest.raises(ValueError, match=told):
        learner(name, wrong)


def test_options_that_it_does_not_know_or_that_are_out_of_bounds_are_refused(name: str) -> None:
    with pytest.raises(ValueError, match="no option 'thetaa'"):
        learner(name, journeys.settings(options={"thetaa": 0.1}))
    known = registry.resolve(registry.LEARNERS[name])
    for option in getattr(known, "OPTIONS"):  # noqa: B009 -- mypy does not know the class
        with pytest.raises(ValueError, match=f"option {option} must be"):
            learner(name, journeys.settings(options={option: -1.0}))


def test_a_learner_from_another_package_is_found_by_its_entry_point(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    target = registry.LEARNERS[name]
    point = importlib.metadata.EntryPoint("their_own", target, "bentod.learners")
    monkeypatch.setattr(importlib.metadata, "entry_points", lambda group: [point])
    assert registry.open_learner("their_own") is registry.resolve(target)
    with pytest.raises(ConfigError, match="'theirown' is unknown; did you mean 'their_own'"):
        registry.open_learner("theirown")
