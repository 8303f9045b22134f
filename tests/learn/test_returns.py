import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bentod.learn.returns import discount, ideal_predictions


@pytest.mark.parametrize(("timescale", "gamma"), [(1, 0.0), (20, 0.95), (120, 1 - 1 / 120)])
def test_the_discount_looks_the_timescale_ahead(timescale: float, gamma: float) -> None:
    assert discount(timescale) == pytest.approx(gamma)


@pytest.mark.parametrize("timescale", [0.5, 0, -3, float("inf"), float("nan")])
def test_an_impossible_timescale_is_refused(timescale: float) -> None:
    with pytest.raises(ValueError, match="at least 1 step"):
        discount(timescale)


@given(st.lists(st.floats(-3, 3), min_size=1, max_size=30), st.floats(1, 50))
def test_it_is_the_sum_of_the_definition_with_the_last_value_held(
    signal: list[float], timescale: float
) -> None:
    gamma = discount(timescale)
    held = signal + [signal[-1]] * 3000
    weights = (1 - gamma) * gamma ** np.arange(3000)
    expected = [weights @ held[t + 1 : t + 3001] for t in range(len(signal))]
    np.testing.assert_allclose(ideal_predictions(np.array(signal), timescale), expected, atol=1e-9)


def test_one_step_ahead_is_the_next_value() -> None:
    assert ideal_predictions(np.array([1.0, 2.0, 4.0]), timescale=1).tolist() == [2.0, 4.0, 4.0]


def test_several_joints_are_predicted_side_by_side() -> None:
    signals = np.random.default_rng(1).normal(size=(40, 3))
    together = ideal_predictions(signals, timescale=20)
    for joint in range(3):
        assert together[:, joint] == pytest.approx(ideal_predictions(signals[:, joint], timescale=20))


def test_an_empty_recording_has_no_predictions() -> None:
    assert ideal_predictions(np.array([]), timescale=20).tolist() == []
