"""Training data with tonic contractions added, and the features that go with it."""

import numpy as np
import pytest
from numpy.typing import NDArray

from bentod.emg.augment import Tonic, with_tonic
from bentod.emg.classify.labelled import LabelledWindows
from bentod.emg.classify.training import Recipe, fitted
from bentod.emg.features.feature_list import FeatureList
from bentod.errors import ConfigError

Floats = NDArray[np.float64]


def windows(count: int = 60, seed: int = 0) -> tuple[Floats, list[str]]:
    """A third each of rest, of a movement on channel 0, and of one on channel 1."""
    random = np.random.default_rng(seed)
    labels = ["rest", "flexion", "extension"] * (count // 3)
    gains = {"rest": (0.01, 0.01, 0.01), "flexion": (1.0, 0.05, 0.1), "extension": (0.05, 0.5, 0.1)}
    noise = random.standard_normal((count, 3, 150))
    return noise * np.array([gains[label] for label in labels])[..., np.newaxis], labels


def levels(some: Floats) -> Floats:
    return np.asarray(np.sqrt(np.mean(some**2, axis=-1)))


def test_the_windows_themselves_come_first_and_every_copy_keeps_its_label() -> None:
    volts, labels = windows()
    made, told = with_tonic(volts, labels, Tonic(copies=3), 1)
    assert made.shape == (4 * len(volts), 3, 150)
    assert list(told) == 4 * labels
    np.testing.assert_array_equal(made[: len(volts)], volts)
    assert not np.isclose(made[len(volts) :], np.tile(volts, (3, 1, 1))).all(axis=-1).any()


def test_equal_seeds_add_the_same() -> None:
    volts, labels = windows()
    first, second, other = (with_tonic(volts, labels, Tonic(), seed)[0] for seed in (1, 1, 2))
    np.testing.assert_array_equal(first, second)
    assert not np.array_equal(first, other)


def test_what_is_added_reaches_every_channel_up_to_the_strength_and_not_beyond() -> None:
    volts, labels = windows(300)
    made, _ = with_tonic(volts, labels, Tonic(copies=10, strength=2.0), 1)
    added = levels(made[300:] - np.tile(volts, (10, 1, 1)))
    loudest = levels(volts[np.array(labels) != "rest"]).mean(axis=0).max()
    assert added.max() < 2.0 * loudest
    assert (added.max(axis=0) > 1.5 * loudest).all()
    assert added.mean() == pytest.approx(0.5 * loudest, rel=0.05)  # u·v of two even draws is 1/4 on average


def test_what_is_added_has_the_spectrum_of_its_channel() -> None:
    volts, labels = windows(90)
    volts[:, 1] = np.cumsum(volts[:, 1], axis=-1) / 20  # slow
    made, _ = with_tonic(volts, labels, Tonic(copies=5), 1)
    added = made[90:] - np.tile(volts, (5, 1, 1))
    rough = np.abs(np.diff(added, axis=-1)).mean(axis=(0, 2)) / np.abs(added).mean(axis=(0, 2))
    assert rough[1] < 0.5 * rough[0]


def test_nothing_is_added_without_copies() -> None:
    volts, labels = windows()
    made, told = with_tonic(volts, labels, Tonic(copies=0), 1)
    assert made is volts
    assert list(told) == labels


def test_windows_of_zeros_stay_finite() -> None:
    volts, labels = windows()
    made, _ = with_tonic(np.zeros_like(volts), labels, Tonic(), 1)
    assert not made.any()


def test_rest_alone_cannot_be_made_busy() -> None:
    volts, _ = windows()
    with pytest.raises(ConfigError, match="windows with movements"):
        with_tonic(volts, ["rest"] * len(volts), Tonic(), 1)


@pytest.mark.parametrize(
    ("copies", "strength", "told"), [(21, 1.0, "copies is 21"), (1, -1.0, "strength is -1")]
)
def test_what_is_out_of_bounds_is_refused(copies: int, strength: float, told: str) -> None:
    with pytest.raises(ConfigError, match=told):
        Tonic(copies, strength)


def test_a_logarithm_has_a_floor_and_is_that_of_the_root_mean_square() -> None:
    volts, _ = windows()
    volts[0] = 0.0
    found = FeatureList({"name": "log_rms", "floor_v": 0.02}, 3, 1000.0).of(volts)
    np.testing.assert_allclose(found, np.log(np.maximum(levels(volts), 0.02)), rtol=1e-12)
    assert found[0].tolist() == [np.log(0.02)] * 3


def test_the_robust_features_of_a_window_alone_are_those_among_others() -> None:
    volts, _ = windows()
    robust = FeatureList("robust", 3, 1000.0)
    assert len(robust.names) == 3 + 3 + 3 * 4
    table = robust.of(volts)
    for number, row in enumerate(table):
        np.testing.assert_array_equal(robust.of(volts[number : number + 1])[0], row)
    assert FeatureList.from_spec(robust.spec()).spec() == robust.spec()


def test_a_recipe_with_tonic_contractions_recognises_movements_under_them_and_one_without_does_not() -> None:
    volts, labels = windows(300)
    known = LabelledWindows(volts, np.array(labels), np.zeros(300, np.int64), np.full(300, ""))
    random = np.random.default_rng(5)
    load = np.array([0.3, 0.3, 0.3])[:, np.newaxis] * random.standard_normal(volts.shape)
    right = {}
    for tonic in (None, Tonic()):
        features, classifier = fitted(known, Recipe(FeatureList("robust", 3, 1000.0), tonic=tonic))
        told = np.array(classifier.labels)[classifier.probabilities(features.of(volts + load)).argmax(axis=1)]
        right[tonic] = float(np.mean(told == labels))
    assert right[None] < 0.8
    assert right[Tonic()] > 0.9
