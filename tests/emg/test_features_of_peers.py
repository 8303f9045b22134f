"""What another library of features gets wrong, and what reference values there are."""

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from bentod.emg.features.feature_list import FeatureList
from bentod.emg.features.tables import Asking
from bentod.emg.recognition import Segmenting
from bentod.emg.segmenting import cut
from bentod.errors import ConfigError
from tests.emg import feature_oracles as oracles

Floats = NDArray[np.float64]

REFERENCE = Path(__file__).parents[3] / "shared" / "data" / "matlab_reference_features.npz"


def of(asking: Asking, windows: Floats) -> Floats:
    return FeatureList(asking, windows.shape[1], 1000.0).of(windows)


def one(values: list[float]) -> Floats:
    return np.array([[values]])


def test_a_flat_signal_has_no_slope_that_changes_its_sign() -> None:
    assert of("ssc", one([0.0] * 150)) == 0
    assert of("ssc", one([0.2] * 150)) == 0
    assert of("ssc_ge0", one([0.0] * 150)) == 148


def test_noise_below_the_threshold_crosses_nothing() -> None:
    noise = 0.009 * np.random.default_rng(0).uniform(-1, 1, (1, 1, 150))
    assert of("zc", noise) > 50
    assert of({"name": "zc", "threshold_v": 0.01}, noise) == 0


def test_a_crossing_through_exact_zeros_is_counted() -> None:
    samples = one(([1.0, 0.0, -1.0, 0.0] * 38)[:151])
    assert of("zc", samples) == 75
    assert of("zc_product", samples) == 0


def test_zeros_before_between_and_after_count_nothing_by_themselves() -> None:
    assert of("zc", one([0.0, 0.0, 1.0, 0.0, 0.0, 2.0, 0.0])) == 0
    assert of("zc", one([0.0, -1.0, 0.0, -2.0, 0.0, 1.0, 0.0])) == 1


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_a_sample_that_is_no_number_is_told_with_its_channel(bad: float) -> None:
    windows = np.ones((3, 4, 30))
    windows[1, 2, 7] = bad
    for name in ("td", "thesis", "bias"):
        with pytest.raises(ValueError, match=f"sample 7 of channel 2 in window 1 is {bad} V"):
            FeatureList(name, 4, 1000.0).fit(np.random.default_rng(0).standard_normal((2, 4, 30))).of(windows)


def test_a_list_works_on_after_a_bad_window() -> None:
    features, good = FeatureList("tdar", 1, 1000.0), np.random.default_rng(0).standard_normal((1, 1, 30))
    wanted = features.of(good)
    with pytest.raises(ValueError, match="finite"):
        features.of(good * np.nan)
    np.testing.assert_array_equal(features.of(good), wanted)


def test_slopes_are_of_their_own_window_only() -> None:
    windows = np.random.default_rng(0).standard_normal((5, 3, 30))
    table = of({"name": "mavs", "segments": 5}, windows)
    np.testing.assert_array_equal(of({"name": "mavs", "segments": 5}, windows[:1])[0], table[0])
    louder = windows.copy()
    louder[1:] *= 100
    np.testing.assert_array_equal(of({"name": "mavs", "segments": 5}, louder)[0], table[0])


def test_the_second_cepstral_coefficient_is_not_lost() -> None:
    windows = np.random.default_rng(0).standard_normal((1, 1, 200)).cumsum(axis=2)
    a1, a2 = of({"name": "ar_burg", "order": 2}, windows)[0]
    np.testing.assert_allclose(of({"name": "cc", "order": 2}, windows)[0], [-a1, -a2 + a1 * a1 / 2])


def test_methods_of_linear_prediction_have_names_and_differ() -> None:
    windows = np.random.default_rng(0).standard_normal((1, 1, 200)).cumsum(axis=2)
    burg, autocorr = of("ar_burg", windows), of("ar_autocorr", windows)
    np.testing.assert_allclose(burg[0], oracles.burg(windows[0, 0], 4))
    np.testing.assert_allclose(autocorr[0], oracles.autocorr(windows[0, 0], 4))
    assert np.abs(burg - autocorr).max() > 0.01
    with pytest.raises(ConfigError, match="no feature 'ar'"):
        of("ar", windows)


def test_a_name_that_is_not_known_is_not_left_out() -> None:
    with pytest.raises(ConfigError, match="there is no feature 'ar9'"):
        FeatureList(["mav", "ar9"], 1, 1000.0)


@pytest.fixture(scope="module")
def reference() -> dict[str, Floats]:
    if not REFERENCE.exists():
        pytest.skip("the reference values are not here")
    with np.load(REFERENCE, allow_pickle=False) as kept:
        return {name: kept[name] for name in kept.files}


def windows_of(reference: dict[str, Floats]) -> Floats:
    return cut(reference["signal"], Segmenting(int(reference["window"]), int(reference["increment"])))


@pytest.mark.parametrize(
    ("name", "asked", "rtol"),
    [
        ("MAV", "mav", 5e-5),
        ("WL", "wl", 5e-5),
        ("IAV", "iav", 5e-5),
        ("RMS", "rms", 5e-5),
        ("VAR", "var_meansquare", 5e-5),
        ("ZC", "zc_product", 0),
        ("SSC", "ssc_ge0", 0),
        ("WAMP", "wamp", 0),
    ],
)
def test_our_values_are_those_of_the_reference(
    reference: dict[str, Floats], name: str, asked: str, rtol: float
) -> None:
    np.testing.assert_allclose(of(asked, windows_of(reference)), reference[name], rtol=rtol)


def test_slopes_and_coefficients_are_those_of_the_reference(reference: dict[str, Floats]) -> None:
    windows = windows_of(reference)
    slopes = of({"name": "mavs", "segments": 2}, windows)
    np.testing.assert_allclose(slopes, reference["MAVSLP"], rtol=5e-5, atol=5e-5)
    np.testing.assert_allclose(of("ar_autocorr", windows), reference["AR"], rtol=0, atol=5.1e-6)


def test_where_we_differ_from_the_reference_we_differ_by_known_counts(reference: dict[str, Floats]) -> None:
    windows = windows_of(reference)
    np.testing.assert_array_equal(of("zc", windows)[0], [84, 87, 100, 112, 108, 102, 69, 91])
    assert of("zc", windows).sum() == 10_668
    assert of("ssc", windows).sum() == 13_411
    cepstrum = of({"name": "cc", "method": "autocorr"}, windows)[0, :4]
    np.testing.assert_allclose(cepstrum, [-0.075645, 0.116771, 0.089548, 0.128211], atol=5e-6)
