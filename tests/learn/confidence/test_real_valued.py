import numpy as np
import pytest

from bentod.learn.confidence.real_valued import RealUncertainty
from bentod.learn.confidence.uncertainty import Uncertainty

SIZE = 12


def test_over_binary_features_it_is_the_other_one() -> None:
    rng = np.random.default_rng(1)
    ranges = np.array([np.nan, 2.0])
    real, binary = RealUncertainty(SIZE, ranges, 0.3, 0.01), Uncertainty(SIZE, ranges, 0.3, 0.01)
    phi_before = before = None
    for t in range(200):
        now = np.sort(rng.permutation(SIZE)[:4])
        phi = np.bincount(now, minlength=SIZE).astype(np.float64)
        delta, cumulants = rng.normal(size=2), rng.normal(size=2)
        delta[rng.random(2) < 0.1] = np.nan
        ticks = 1 + (t % 50 == 49)
        got = real.step(phi_before, delta, phi, cumulants, ticks)
        np.testing.assert_allclose(got, binary.step(before, delta, now, cumulants, ticks), rtol=0, atol=1e-12)
        phi_before, before = phi, now


def test_an_error_is_taken_away_by_the_share_eta_however_long_the_features_are() -> None:
    for length in (0.01, 1.0, 300.0):
        phi = np.linspace(-1, 1, SIZE) * length
        uncertainty = RealUncertainty(SIZE, np.ones(1), 0.25, 0.0)
        uncertainty.step(None, np.zeros(1), phi, np.zeros(1))
        u, c = uncertainty.step(phi, np.zeros(1), phi, np.zeros(1))
        assert (u[0], c[0]) == (pytest.approx(0.75), pytest.approx(0.25))


def test_where_all_features_are_zero_nothing_is_known_and_nothing_breaks() -> None:
    nowhere = np.zeros(SIZE)
    uncertainty = RealUncertainty(SIZE, np.ones(1))
    uncertainty.step(None, np.zeros(1), nowhere, np.zeros(1))
    assert uncertainty.step(nowhere, np.zeros(1), nowhere, np.zeros(1))[0][0] == 1


def test_rates_that_make_no_sense_are_refused() -> None:
    with pytest.raises(ValueError, match="σ must be 0 or more, below η"):
        RealUncertainty(SIZE, np.ones(1), 0.1, 0.2)
