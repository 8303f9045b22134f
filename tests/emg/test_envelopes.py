"""Root mean square and smoothed rectified signal, the same bits at any block size."""

from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bentod.control.proportional import Envelope, Loudness
from bentod.emg.envelopes import LowPass, RootMeanSquare
from bentod.frames import Samples

RATE_HZ = 200.0
KINDS: list[Callable[[], Loudness]] = [
    lambda: RootMeanSquare(Envelope(10)),
    lambda: LowPass(4.0, RATE_HZ, 2),
]


def noise(count: int, seed: int = 1) -> Samples:
    return np.random.default_rng(seed).normal(0, 1.0, (count, 2)).astype(np.float32)


def test_root_mean_square_is_what_its_name_says() -> None:
    samples = noise(100)
    wanted = np.sqrt(np.mean(np.square(samples[-10:].astype(np.float64)), axis=0))
    np.testing.assert_allclose(RootMeanSquare(Envelope(10)).step(samples)[-1], wanted, rtol=1e-12)


def test_a_smoothed_envelope_is_steadier_than_a_mean_of_50_ms_and_as_high() -> None:
    samples = noise(20_000)
    smooth, mean = LowPass(4.0, RATE_HZ, 2).step(samples), Envelope(10).step(samples)
    assert np.nanmean(smooth) == pytest.approx(np.sqrt(2 / np.pi), rel=0.01)
    assert np.nanstd(smooth) < 0.8 * np.nanstd(mean)
    assert np.nanmin(smooth) >= 0


def test_a_smoothed_envelope_tells_nothing_until_it_has_settled() -> None:
    smooth = LowPass(4.0, RATE_HZ, 2)
    assert np.isnan(smooth.step(noise(5))).all()
    assert np.isfinite(smooth.step(noise(200))[-1]).all()
    smooth.reset()
    assert np.isnan(smooth.step(noise(5))).all()


@settings(max_examples=20, deadline=None)
@given(
    kind=st.sampled_from(KINDS),
    cuts=st.lists(st.integers(0, 300), max_size=10),
    gap=st.tuples(st.integers(0, 299), st.integers(0, 60)),
)
def test_the_bits_are_the_same_in_blocks_of_any_size(
    kind: Callable[[], Loudness], cuts: list[int], gap: tuple[int, int]
) -> None:
    samples = noise(300)
    samples[gap[0] : sum(gap)] = np.nan
    edges, in_blocks = [0, *sorted(cuts), 300], kind()
    pieces = [in_blocks.step(samples[a:b]) for a, b in pairwise(edges)]
    np.testing.assert_array_equal(np.concatenate(pieces), kind().step(samples))
