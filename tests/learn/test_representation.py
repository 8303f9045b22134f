import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bentod.learn.representation import Representation
from bentod.learn.tiles import TileCoder
from bentod.learn.traces import HistoryTraces

LIMITS = [(-1.0, 1.0), (0.5, 2.5)]


@given(st.lists(st.floats(0, 1), min_size=1, max_size=50), st.floats(0, 0.999))
def test_a_trace_is_the_decaying_sum_of_what_was_seen(signal: list[float], decay: float) -> None:
    traces = HistoryTraces(decay)
    for theta in signal:
        (trace,) = traces.step([theta])
    weights = [(1 - decay) * decay**age for age in range(len(signal) - 1)]
    newest_first = signal[:0:-1]
    expected = sum(w * x for w, x in zip(weights, newest_first, strict=True))
    assert trace == pytest.approx(expected + decay ** (len(signal) - 1) * signal[0])


def test_a_trace_starts_where_the_signal_is() -> None:
    traces = HistoryTraces(0.99)
    assert traces.step([0.3, 0.8]) == pytest.approx([0.3, 0.8])
    assert traces.step([0.4, 0.8]) == pytest.approx([0.301, 0.8])
    traces.restart()
    assert traces.step([0.4, 0.1]) == pytest.approx([0.4, 0.1])


@pytest.mark.parametrize("decay", [-0.1, 1.0])
def test_a_decay_out_of_range_is_refused(decay: float) -> None:
    with pytest.raises(ValueError, match="at least 0 and below 1"):
        HistoryTraces(decay)


def test_the_thesis_has_2049_features_of_which_101_are_active() -> None:
    representation = Representation(LIMITS)
    assert (representation.size, representation.active) == (2049, 101)
    features = representation.features([0.0, 1.0])
    assert 90 < len(features) <= 101


def test_the_bias_is_the_last_feature_and_always_active() -> None:
    representation = Representation(LIMITS)
    rng = np.random.default_rng(1)
    for positions in rng.uniform(-3, 3, (50, 2)).tolist():
        features = representation.features(positions)
        assert features[-1] == 2048
        assert (np.diff(features) > 0).all()


def test_angles_and_their_traces_are_tiled_after_normalising_over_the_limits() -> None:
    representation = Representation(LIMITS, tilings=16, memory=512, trace_decay=0.75)
    representation.features([-1.0, 2.5])
    features = representation.features([0.0, 2.0])
    tiles = TileCoder(4, tilings=16, memory=512).encode([0.5, 0.75, 0.125, 0.9375])
    assert features.tolist() == [*tiles.tolist(), 512]


def test_a_joint_beyond_its_limit_looks_like_one_at_the_limit() -> None:
    beyond = Representation(LIMITS).features([5.0, 0.0])
    at_the_limit = Representation(LIMITS).features([1.0, 0.5])
    assert beyond.tolist() == at_the_limit.tolist()


def test_the_same_place_looks_different_when_it_is_reached_from_elsewhere() -> None:
    from_left, from_right = Representation(LIMITS, trace_decay=0.9), Representation(LIMITS, trace_decay=0.9)
    from_left.features([-1.0, 1.0])
    from_right.features([1.0, 1.0])
    assert from_left.features([0.0, 1.0]).tolist() != from_right.features([0.0, 1.0]).tolist()


def test_after_a_restart_the_past_is_forgotten() -> None:
    representation = Representation(LIMITS, trace_decay=0.9)
    fresh = representation.features([0.0, 1.0]).tolist()
    representation.features([1.0, 1.0])
    representation.restart()
    assert representation.features([0.0, 1.0]).tolist() == fresh


def test_a_position_that_is_not_finite_is_refused_and_leaves_no_trace() -> None:
    representation = Representation(LIMITS, trace_decay=0.9)
    before = representation.features([0.0, 1.0]).tolist()
    with pytest.raises(ValueError, match="finite"):
        representation.features([float("nan"), 1.0])
    assert representation.features([0.0, 1.0]).tolist() == before


@pytest.mark.parametrize("limits", [(1.0, 1.0), (2.0, 1.0), (float("-inf"), 1.0), (0.0, float("nan"))])
def test_an_empty_or_endless_range_is_refused(limits: tuple[float, float]) -> None:
    with pytest.raises(ValueError, match="minimum below its maximum"):
        Representation([limits])
