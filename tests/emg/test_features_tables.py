import json
from collections.abc import Mapping

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bentod.emg.features.feature_list import FeatureList
from bentod.emg.features.tables import SETS, Asking
from bentod.errors import ConfigError
from bentod.frames import Value


def read(*asked: Asking) -> FeatureList:
    return FeatureList(asked, 4, 1000.0)


@pytest.mark.parametrize(
    ("asked", "told"),
    [
        ("mva", "there is no feature 'mva'; did you mean 'mav'"),
        ("ar", "did you mean 'tdar'|ar_burg"),
        (
            {"name": "zc", "treshold_v": 0.1},
            "features.zc.treshold_v: unknown key; did you mean 'threshold_v'",
        ),
        (
            {"name": "td", "treshold_v": 0.1},
            "no feature of 'td' has a key 'treshold_v'; did you mean 'thresh",
        ),
        ({"name": "zc", "threshold_v": -0.1}, "features.zc.threshold_v = -0.1"),
        ({"name": "zc", "threshold_v": float("nan")}, "features.zc.threshold_v = nan"),
        ({"name": "mav", "segments": 0}, "features.mav.segments = 0"),
        ({"name": "mavs", "segments": 1}, "features.mavs.segments = 1"),
        ({"name": "ar_burg", "order": 31}, "features.ar_burg.order = 31"),
        ({"name": "hist", "low_v": [0.0], "high_v": [1.0]}, "hist.low_v has 1 values for 4 channels"),
        ({"name": "hist", "low_v": [0.0] * 4}, "one of low_v and high_v without the other"),
        (
            {"name": "hist", "low_v": [0.0] * 4, "high_v": [1.0, 1.0, 0.0, 1.0]},
            "channel 2: low_v = 0 V must be",
        ),
        ({"segments": 2}, "has no name"),
    ],
)
def test_a_mistake_in_the_list_is_told(asked: Asking, told: str) -> None:
    with pytest.raises(ConfigError, match=told):
        read("wl", asked)


def test_a_list_without_features_is_refused() -> None:
    with pytest.raises(ConfigError, match="there is no feature in the list"):
        read()


def test_the_same_feature_twice_is_refused() -> None:
    with pytest.raises(ConfigError, match="'zc' is asked for twice"):
        read("td", "zc")


def test_ratios_of_one_channel_are_refused() -> None:
    with pytest.raises(ConfigError, match="of 1 there is none to compare"):
        FeatureList("ratios", 1, 1000.0)


def test_features_of_no_channel_are_refused() -> None:
    with pytest.raises(ConfigError, match="of 0 channels"):
        FeatureList("td", 0, 1000.0)


@pytest.mark.parametrize(
    ("asked", "told"),
    [
        ({"name": "mav", "segments": 4}, "'mav' is to cut windows of 150 samples into 4 segments"),
        ({"name": "wl", "segments": 75}, ""),
        ({"name": "ar_burg", "segments": 50, "order": 3}, "'ar_burg' of order 3 needs more than 3 samples"),
    ],
)
def test_windows_that_cannot_be_cut_so_are_refused(asked: Mapping[str, Value], told: str) -> None:
    if not told:
        read(asked).check(150)
        return
    with pytest.raises(ConfigError, match=told):
        read(asked).check(150)
    with pytest.raises(ConfigError, match=told):
        read(asked).of(np.zeros((1, 4, 150)))


def test_a_histogram_without_training_is_refused() -> None:
    with pytest.raises(ConfigError, match="'hist' has no bins yet"):
        read("hist").of(np.zeros((1, 4, 150)))
    with pytest.raises(ConfigError, match="no window to learn from"):
        read("hist").fit(np.zeros((0, 4, 150)))


def test_a_list_with_a_histogram_can_be_checked_before_training() -> None:
    read("thesis").check(150)
    with pytest.raises(ConfigError, match="no multiple of 10"):
        read("thesis").check(151)


def test_windows_of_other_channels_are_refused() -> None:
    with pytest.raises(ValueError, match="windows of 3 channels came to features of 4"):
        read("td").of(np.zeros((1, 3, 150)))


def test_a_threshold_of_a_set_is_that_of_its_counts() -> None:
    changed = read({"name": "td", "threshold_v": 0.02}).spec()
    by_hand = read(
        "mav", {"name": "zc", "threshold_v": 0.02}, {"name": "ssc", "threshold_v": 0.02}, "wl"
    ).spec()
    assert changed == by_hand


def test_the_set_of_the_thesis_is_its_table() -> None:
    features = FeatureList("thesis", 4, 1000.0)
    counts: dict[str, int] = {}
    for name in features.names:
        counts[name.partition("[")[0]] = counts.get(name.partition("[")[0], 0) + 1
    assert counts == {
        **{"mav": 40, "zc": 4, "ssc": 4, "wl": 20, "var_zero_mean": 24, "mavs": 16, "hist": 280},
        **{"ratios": 30, "cc": 8, "ar_burg": 8, "bias": 1},
    }


@given(
    asked=st.lists(
        st.one_of(
            st.sampled_from(["mav", "iav", "rms", "bias", "ratios", "var_centred"]),
            st.builds(
                lambda name, th, segments: {"name": name, "threshold_v": th, "segments": segments},
                st.sampled_from(["zc", "ssc", "wamp"]),
                st.floats(0, 1),
                st.integers(1, 3),
            ),
            st.builds(
                lambda order, method: {"name": "cc", "order": order, "method": method},
                st.integers(1, 5),
                st.sampled_from(["burg", "autocorr"]),
            ),
            st.just({"name": "hist", "bins": 7}),
        ),
        min_size=1,
        max_size=5,
        unique_by=str,
    )
)
def test_what_is_kept_of_a_list_makes_the_same_list(asked: list[Asking]) -> None:
    windows = np.random.default_rng(0).standard_normal((3, 2, 30))
    features = FeatureList(asked, 2, 1000.0).fit(windows)
    kept = json.loads(json.dumps(features.spec()))
    again = FeatureList.from_spec(kept)
    assert again.spec() == features.spec() == kept
    assert again.names == features.names
    np.testing.assert_array_equal(again.of(windows), features.of(windows))


def damaged(**changes: Value) -> dict[str, Value]:
    return {**read("td").spec(), **changes}


@pytest.mark.parametrize(
    ("spec", "told"),
    [
        (damaged(version=2), "version 2 in 'V'"),
        (damaged(unit="mV"), "version 1 in 'mV'"),
        (damaged(channels="4"), "damaged"),
        (damaged(features="td"), "damaged"),
        (damaged(features=["td"]), "not complete"),
        (damaged(more=1), "not complete, or says more"),
        (damaged(features=[{"name": "mave", "segments": 1}]), "did you mean 'mav'"),
    ],
)
def test_what_is_kept_is_checked_when_it_is_loaded(spec: dict[str, Value], told: str) -> None:
    with pytest.raises(ConfigError, match=told):
        FeatureList.from_spec(spec)


def test_the_sets_can_be_asked_for_by_name() -> None:
    for name in SETS:
        assert FeatureList(name, 4, 1000.0).names
