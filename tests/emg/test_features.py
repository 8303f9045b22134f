from collections.abc import Callable, Sequence

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from bentod.emg.features.feature_list import FeatureList
from bentod.emg.features.tables import SETS, TABLES, Asking
from bentod.emg.recognition import Segmenting
from bentod.emg.segmenting import cut
from tests.emg import feature_oracles as oracles

Floats = NDArray[np.float64]

COUNTED: list[Asking] = [{"name": name, "threshold_v": 0.3} for name in sorted(oracles.COUNTS)]
SPLIT: list[Asking] = [
    {"name": name, "segments": 3} for name in ("mav", "zc", "ssc_ge0", "wl", "hist", "ratios")
]
EVERYTHING: list[Asking] = [
    *("mav", "iav", "wl", "rms", "var_centred", "var_meansquare", "var_zero_mean", "mavs", "ratios", "bias"),
    *("log_rms", "hist", "zc", "ar_burg", "ar_autocorr", "cc"),
    *COUNTED,
    *SPLIT,
    {"name": "ar_burg", "segments": 3, "order": 2},
    {"name": "cc", "method": "autocorr", "order": 2},
]


def muscles(windows: int, channels: int, length: int, seed: int = 0) -> Floats:
    """Noise with some exact zeros and repeated values, V."""
    random = np.random.default_rng(seed)
    noise = random.standard_normal((windows, channels, length))
    coarse: Floats = np.round(noise, 1) * (random.random(noise.shape) > 0.1)
    return coarse


def of(asking: Asking | Sequence[Asking], windows: Floats) -> Floats:
    return FeatureList(asking, windows.shape[1], 1000.0).fit(windows).of(windows)


def each(windows: Floats, oracle: Callable[[Floats], Floats], segments: int = 1) -> Floats:
    """The oracle's values, one row a window, channel after channel, segment after segment."""
    return np.array(
        [
            np.concatenate([np.atleast_1d(oracle(x)) for row in window for x in np.split(row, segments)])
            for window in windows
        ]
    )


@pytest.mark.parametrize("segments", [1, 4])
@pytest.mark.parametrize("name", sorted(oracles.AMPLITUDES))
def test_an_amplitude_is_what_its_definition_says(name: str, segments: int) -> None:
    windows = muscles(5, 3, 24) + 0.2
    wanted = each(windows, lambda x: np.array(oracles.AMPLITUDES[name](x)), segments)
    np.testing.assert_allclose(of({"name": name, "segments": segments}, windows), wanted, rtol=1e-13)


@given(
    name=st.sampled_from(sorted(oracles.COUNTS)),
    threshold=st.sampled_from([0.0, 0.1, 0.35, 1.0]),
    shape=st.tuples(st.integers(1, 3), st.integers(1, 3), st.integers(2, 40)),
    segments=st.integers(1, 3),
    seed=st.integers(0, 1000),
)
def test_a_count_is_what_its_definition_says(
    name: str, threshold: float, shape: tuple[int, int, int], segments: int, seed: int
) -> None:
    windows = muscles(shape[0], shape[1], shape[2] * segments, seed)
    wanted = each(windows, lambda x: np.array(oracles.COUNTS[name](x, threshold)), segments)
    found = of({"name": name, "threshold_v": threshold, "segments": segments}, windows)
    np.testing.assert_array_equal(found, wanted)


@pytest.mark.parametrize("order", [1, 2, 4, 9])
@pytest.mark.parametrize("name", ["burg", "autocorr"])
def test_coefficients_are_those_of_the_textbook(name: str, order: int) -> None:
    windows = muscles(4, 3, 60) + 0.1
    oracle = {"burg": oracles.burg, "autocorr": oracles.autocorr}[name]
    wanted = each(windows, lambda x: oracle(x, order), 2)
    found = of({"name": f"ar_{name}", "order": order, "segments": 2}, windows)
    np.testing.assert_allclose(found, wanted, atol=1e-12)


@given(
    seed=st.integers(0, 10_000), length=st.integers(8, 60), kind=st.sampled_from(["noise", "sine", "drift"])
)
def test_burg_predicts_with_a_stable_filter(seed: int, length: int, kind: str) -> None:
    t = np.arange(length)
    noise = muscles(1, 1, length, seed)[0, 0]
    x = {"noise": noise, "sine": np.sin(0.1 * (seed % 30 + 1) * t) + 1e-3 * noise, "drift": t + noise}[kind]
    a = of({"name": "ar_burg", "order": 4}, x[np.newaxis, np.newaxis])[0]
    assert np.abs(np.roots(np.concatenate(([1.0], a)))).max(initial=0) < 1 + 1e-6


@pytest.mark.parametrize("method", ["burg", "autocorr"])
def test_cepstral_coefficients_are_of_the_log_spectrum_of_the_filter(method: str) -> None:
    windows = muscles(6, 2, 80)
    a = of({"name": f"ar_{method}", "order": 6}, windows).reshape(6, 2, 6)
    wanted = np.array([[oracles.cepstrum(channel) for channel in window] for window in a]).reshape(6, -1)
    found = of({"name": "cc", "order": 6, "method": method}, windows)
    np.testing.assert_allclose(found, wanted, atol=1e-9)


def test_a_logarithm_does_not_fall_below_that_of_its_floor() -> None:
    windows = muscles(4, 2, 30)
    asked: Asking = {"name": "log_rms", "floor_v": 1e-3}
    np.testing.assert_allclose(of(asked, windows), np.log(of("rms", windows)), rtol=1e-12)
    np.testing.assert_allclose(of(asked, 1e-9 * windows), np.log(1e-3), rtol=1e-12)


def test_the_slope_is_from_each_segment_to_the_next() -> None:
    windows = muscles(4, 2, 30)
    mav = of({"name": "mav", "segments": 5}, windows).reshape(4, 2, 5)
    np.testing.assert_array_equal(
        of({"name": "mavs", "segments": 5}, windows), np.diff(mav, axis=2).reshape(4, 8)
    )


def test_ratios_compare_each_pair_of_channels_once() -> None:
    windows = muscles(4, 3, 30)
    mav = of("mav", windows)
    pairs = [(0, 1), (0, 2), (1, 2)]
    wanted = [(mav[:, i] - mav[:, j]) / (mav[:, i] + mav[:, j]) for i, j in pairs]
    np.testing.assert_allclose(of("ratios", windows), np.stack(wanted, axis=1), rtol=1e-14)


def test_ratios_of_channels_at_rest_stay_small() -> None:
    windows = 1e-7 * muscles(4, 3, 30)
    assert np.abs(of({"name": "ratios", "floor_v": 1e-5}, windows)).max() < 0.05


def test_a_histogram_has_the_share_of_each_bin_and_its_outer_bins_are_open() -> None:
    windows = muscles(4, 2, 30)
    asked: Asking = {"name": "hist", "bins": 5, "low_v": [-1.01, -0.51], "high_v": [1.01, 0.51]}
    found = of(asked, 2 * windows).reshape(4, 2, 5)
    for channel, end in enumerate((1.01, 0.51)):
        edges = [-np.inf, *np.linspace(-end, end, 6)[1:-1], np.inf]
        for window in range(4):
            wanted = np.histogram(2 * windows[window, channel], edges)[0] / 30
            np.testing.assert_allclose(found[window, channel], wanted)


def test_bins_come_from_training_data_and_stay() -> None:
    windows = muscles(50, 2, 30) * np.array([1.0, 5.0])[:, np.newaxis]
    features = FeatureList("hist", 2, 1000.0).fit(windows)
    again = features.fit(3 * windows)
    assert again.spec() == features.spec()
    table = features.spec()["features"]
    assert isinstance(table, list)
    assert isinstance(table[0], dict)
    spread = 3 * windows.std(axis=(0, 2))
    np.testing.assert_allclose(np.array(table[0]["high_v"]) - windows.mean(axis=(0, 2)), spread)


def test_one_is_always_in_the_column_of_the_bias() -> None:
    np.testing.assert_array_equal(of(["mav", "bias"], muscles(5, 2, 20))[:, 2], 1)


@given(
    windows=st.integers(1, 12),
    channels=st.integers(2, 9),
    length=st.integers(1, 60).map(lambda third: 3 * third + 12),
    step=st.integers(1, 40),
    seed=st.integers(0, 1000),
)
@settings(max_examples=25, deadline=None)
def test_a_window_alone_is_the_same_to_the_bit_as_among_others(
    windows: int, channels: int, length: int, step: int, seed: int
) -> None:
    samples = np.random.default_rng(seed).standard_normal((length + step * (windows - 1), channels))
    some = cut(samples, Segmenting(length, step))
    features = FeatureList(EVERYTHING, channels, 1000.0).fit(some)
    table = features.of(some)
    assert table.shape == (windows, len(features.names))
    for number in range(windows):
        np.testing.assert_array_equal(features.of(some[number : number + 1])[0], table[number])
    np.testing.assert_array_equal(features.of(some[windows // 2 :].copy()), table[windows // 2 :])


def test_a_recording_that_is_worked_on_in_parts_is_the_same_to_the_bit() -> None:
    some = cut(muscles(1, 8, 10_000)[0].T, Segmenting(150, 50))
    features = FeatureList("thesis", 8, 1000.0).fit(some)
    table = features.of(some)
    np.testing.assert_array_equal(np.concatenate([features.of(one[np.newaxis]) for one in some]), table)


@pytest.mark.parametrize("value", [0.0, 1.0, -0.3, 1e-12, 5.0])
def test_flat_windows_give_finite_numbers(value: float) -> None:
    windows = np.full((3, 4, 30), value)
    windows[1] = 0
    assert np.isfinite(of(EVERYTHING, windows)).all()


@given(scale=st.integers(-30, 3), seed=st.integers(0, 100))
@settings(max_examples=40, deadline=None)
def test_all_that_a_converter_can_give_has_finite_features(scale: int, seed: int) -> None:
    assert np.isfinite(of(EVERYTHING, 10.0**scale * muscles(2, 2, 30, seed))).all()


def test_no_windows_are_an_empty_table() -> None:
    features = FeatureList("tdar", 3, 1000.0)
    assert features.of(np.empty((0, 3, 30))).shape == (0, len(features.names))


def test_an_answer_is_not_changed_by_the_next() -> None:
    features, windows = FeatureList("td", 3, 1000.0), muscles(2, 3, 30)
    found = features.of(windows[:1])
    kept = found.copy()
    features.of(windows[1:])
    np.testing.assert_array_equal(found, kept)


def test_windows_are_not_written_to() -> None:
    windows = muscles(2, 3, 30)
    windows.flags.writeable = False
    of(EVERYTHING, windows)


def test_there_is_a_column_for_each_name() -> None:
    windows = muscles(2, 3, 150)
    for name in (*TABLES, *SETS):
        features = FeatureList(name, 3, 1000.0).fit(windows)
        assert features.of(windows).shape == (2, len(features.names))
        assert len(set(features.names)) == len(features.names)


def test_names_say_channel_segment_and_coefficient() -> None:
    asked: list[Asking] = ["mav", {"name": "wl", "segments": 2}, {"name": "ar_burg", "order": 2}, "ratios"]
    assert FeatureList(asked, 2, 1000.0).names == (
        *("mav[0]", "mav[1]", "wl[0].s0", "wl[0].s1", "wl[1].s0", "wl[1].s1"),
        *("ar_burg[0].a1", "ar_burg[0].a2", "ar_burg[1].a1", "ar_burg[1].a2", "ratios[0,1]"),
    )


def test_names_tell_columns_of_two_thresholds_apart() -> None:
    asked: list[Asking] = ["zc", {"name": "zc", "threshold_v": 0.1}]
    assert FeatureList(asked, 1, 1000.0).names == ("zc[0]", "zc#2[0]")
