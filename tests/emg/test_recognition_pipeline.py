"""From samples to decisions: off-line and on-line, in any blocks, with samples missing."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from bentod.emg.classify.deciding import Deciding
from bentod.emg.classify.loudness import loudness
from bentod.emg.classify.pipeline import MISSING, Pipeline
from bentod.emg.recognition import REST, Decision, Features, Table, Windows
from bentod.emg.segmenting import cut
from bentod.frames import Value
from bentod.registry import CLASSIFIERS
from tests.emg import gestures

DECIDING = Deciding(reject_below=0.5, votes=3, flutter=2, ramp=3)
LENGTH, STEP = gestures.SETTING.segmenting.length, gestures.SETTING.segmenting.step


@cache
def signal() -> NDArray[np.float32]:
    (piece,) = gestures.session(repetitions=1, seconds=0.6, seed=3).pieces
    return piece.samples.astype(np.float32)


def run(samples: NDArray[np.float32], blocks: Sequence[int], kind: str) -> list[Decision]:
    """Decisions about samples that come in blocks of these sizes, again and again."""
    pipeline = Pipeline(gestures.model(kind), DECIDING)
    found: list[Decision] = []
    first = turn = 0
    while first < len(samples):
        size = blocks[turn % len(blocks)]
        found += pipeline.step(first, samples[first : first + size])
        first, turn = first + size, turn + 1
    return found


@pytest.mark.parametrize("kind", sorted(CLASSIFIERS))
@settings(max_examples=15, deadline=None)
@given(
    blocks=st.lists(st.integers(1, 90), min_size=1, max_size=12),
    gaps=st.lists(st.tuples(st.integers(0, 450), st.integers(1, 40)), max_size=3),
)
def test_any_blocks_make_the_decisions_of_the_whole_recording(
    kind: str, blocks: list[int], gaps: list[tuple[int, int]]
) -> None:
    samples = signal().copy()
    for start, length in gaps:
        samples[start : start + length] = np.nan
    assert run(samples, blocks, kind) == run(samples, [len(samples)], kind)


def test_a_decision_bears_the_index_of_the_sample_that_completed_its_window() -> None:
    indices = [decision.index for decision in run(signal(), [7], "lda")]
    assert indices == list(range(LENGTH - 1, len(signal()), STEP))


def test_the_decision_is_there_with_the_sample_that_completes_its_window() -> None:
    pipeline = Pipeline(gestures.model())
    assert pipeline.step(0, signal()[: LENGTH - 1]) == []
    assert len(pipeline.step(LENGTH - 1, signal()[LENGTH - 1 : LENGTH])) == 1


def test_what_was_done_is_recognised() -> None:
    pipeline = Pipeline(gestures.model())
    found = pipeline.step(0, signal())
    count = len(signal()) // len(gestures.GAINS)
    for place, label in enumerate(gestures.GAINS):
        inside = range(place * count + LENGTH - 1, (place + 1) * count)
        assert {decision.label for decision in found if decision.index in inside} == {label}


def test_a_window_with_missing_samples_rests_and_says_so() -> None:
    samples = signal().copy()
    samples[200] = np.nan
    missing = [decision for decision in run(samples, [10], "lda") if decision.reason]
    assert [decision.index for decision in missing] == [209, 219, 229]
    assert {(found.label, found.speed, found.reason) for found in missing} == {(REST, 0.0, MISSING)}


def test_samples_that_never_came_are_missing_and_nothing_shifts() -> None:
    pipeline = Pipeline(gestures.model(), DECIDING)
    jumped = pipeline.step(0, signal()[:200]) + pipeline.step(203, signal()[203:])
    samples = signal().copy()
    samples[200:203] = np.nan
    assert jumped == run(samples, [50], "lda")


def test_after_a_gap_without_end_decisions_begin_anew() -> None:
    pipeline = Pipeline(gestures.model(), Deciding(votes=5))
    close = signal()[120:240]
    before = pipeline.step(0, close)
    after = pipeline.step(100_000, close)
    assert [d.label for d in before if not d.reason] == [REST, REST] + ["close"] * (len(before) - 2)
    fine = [decision for decision in after if not decision.reason]
    assert fine[0].index > 100_000
    assert [decision.label for decision in fine][:3] == [REST, REST, "close"]


class _Broken:
    """Features of which one is not a number now and then."""

    def __init__(self, features: Features) -> None:
        self.names = features.names
        self._features = features

    def of(self, windows: Windows) -> Table:
        table = self._features.of(windows)
        table[np.abs(windows).max(axis=(1, 2)) > 1.0, 3] = np.nan
        return table

    def fit(self, windows: Windows) -> Features:
        raise NotImplementedError

    def spec(self) -> Mapping[str, Value]:
        return self._features.spec()


def test_a_feature_that_is_not_a_number_rests_and_is_named() -> None:
    model = replace(gestures.model(), features=_Broken(gestures.FEATURES))
    samples = signal().copy()
    samples[100] = 2.0
    found = Pipeline(model).step(0, samples)
    told = {decision.index: decision.reason for decision in found if decision.reason}
    assert told == dict.fromkeys((109, 119, 129), "The EMG feature mav[3] is not a finite number.")


def test_loudness_is_the_sum_of_the_mean_magnitudes_of_all_channels() -> None:
    windows = cut(np.array([[1.0, -2.0], [-3.0, 4.0], [0.0, 0.0]]), gestures.SETTING.segmenting)
    assert loudness(windows).shape == (0,)
    two = np.array([[[1.0, -3.0], [-2.0, 4.0]], [[0.0, 0.0], [0.0, 1.0]]])
    assert loudness(two).tolist() == [5.0, 0.5]


@settings(max_examples=50, deadline=None)
@given(st.integers(0, 30), st.integers(1, 20))
def test_loudness_of_a_window_has_the_same_bits_alone_and_among_others(first: int, count: int) -> None:
    windows = cut(signal(), gestures.SETTING.segmenting)[first : first + count]
    alone = [float(loudness(windows[k : k + 1])[0]) for k in range(len(windows))]
    assert loudness(windows).tolist() == alone
