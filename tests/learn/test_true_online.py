"""The forms in which papers write True Online TD(λ) are one rule, and equal the forward view."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.learn import oracles
from tests.learn.oracles import Stream, Vector

SIZE = 12
Rule = Callable[[Stream, Vector, float, float], list[Vector]]
unit = st.floats(0, 1)
seeds = st.integers(0, 2**32 - 1)
few = settings(max_examples=20)


def random_stream(seed: int, steps: int = 40, alpha: float | None = 0.1) -> Stream:
    """Binary features and normal rewards; α None: a new step size for every step."""
    rng = np.random.default_rng(seed)
    phis = [(rng.random(SIZE) < 0.4).astype(np.float64) for _ in range(steps + 1)]
    alphas = rng.uniform(0.01, 0.15, steps) if alpha is None else np.full(steps, alpha)
    return Stream(phis, rng.normal(size=steps).tolist(), alphas.tolist())


def start(seed: int) -> Vector:
    return np.full(SIZE, np.random.default_rng(seed + 1).normal())


def furthest(ours: list[Vector], theirs: list[Vector]) -> float:
    return float(np.max(np.abs(np.array(ours) - np.array(theirs))))


@pytest.mark.parametrize("alpha", [0.1, None], ids=["constant step size", "varying step size"])
@few
@given(seeds, unit, unit)
def test_algorithm_1_and_5_2_to_5_4_are_one_rule(
    alpha: float | None, seed: int, gamma: float, lam: float
) -> None:
    stream, w = random_stream(seed, alpha=alpha), start(seed)
    ours = oracles.equations_5_2_to_5_4(stream, w, gamma, lam)
    assert furthest(ours, oracles.algorithm_1(stream, w, gamma, lam)) < 1e-10


@pytest.mark.parametrize("alpha", [0.1, None], ids=["constant step size", "varying step size"])
@few
@given(seeds, unit, unit)
def test_the_rule_equals_the_forward_view_at_every_step(
    alpha: float | None, seed: int, gamma: float, lam: float
) -> None:
    stream, w = random_stream(seed, steps=12, alpha=alpha), start(seed)
    ours = oracles.equations_5_2_to_5_4(stream, w, gamma, lam)
    assert furthest(ours, oracles.online_lambda_return(stream, w, gamma, lam)) < 1e-10


@few
@given(seeds, unit, unit)
def test_a_step_size_outside_the_trace_agrees_while_it_is_constant(
    seed: int, gamma: float, lam: float
) -> None:
    stream, w = random_stream(seed), start(seed)
    ours = oracles.equations_5_2_to_5_4(stream, w, gamma, lam)
    assert furthest(ours, oracles.step_size_outside_the_trace(stream, w, gamma, lam)) < 1e-10


def test_a_step_size_outside_the_trace_differs_once_it_varies() -> None:
    stream, w = random_stream(1, alpha=None), start(1)
    ours = oracles.equations_5_2_to_5_4(stream, w, 0.95, 0.9)
    assert furthest(ours, oracles.step_size_outside_the_trace(stream, w, 0.95, 0.9)) > 0.01


@pytest.mark.parametrize("rule", [oracles.mixed_forms, oracles.late_v_old])
def test_mixing_the_two_forms_gives_another_rule(rule: Rule) -> None:
    stream, w = random_stream(1), start(1)
    ours = oracles.equations_5_2_to_5_4(stream, w, 0.95, 0.9)
    assert furthest(ours, rule(stream, w, 0.95, 0.9)) > 0.01
