"""Threshold and maximum from rest and a contraction, and what is said when they cannot be told apart."""

import numpy as np
import pytest

from bentod.calibration.muscles import Levels, settings
from bentod.errors import Refused


def levels(mean: float, deviation: float, count: int = 100, seed: int = 1) -> Levels:
    return np.abs(np.random.default_rng(seed).normal(mean, deviation, count))


REST = {"up": levels(2e-6, 0.2e-6), "down": levels(3e-6, 0.2e-6, seed=2)}


def test_the_threshold_lies_above_rest_and_the_maximum_below_the_strongest_contraction() -> None:
    (found,) = settings(REST, {"up": REST | {"up": levels(60e-6, 5e-6)}})
    assert found.threshold == pytest.approx(2.6e-6, rel=0.05)
    assert found.maximum == pytest.approx(0.8 * 68e-6, rel=0.05)
    assert found.separable
    assert found.remarks == ()
    assert found.lines()[0].endswith("times as much)")
    assert "threshold_v = 2." in found.lines()[0]


def test_a_rest_without_any_scatter_has_its_threshold_a_fifth_above() -> None:
    rest = {"up": np.full(100, 2e-6)}
    (found,) = settings(rest, {"up": {"up": np.full(100, 60e-6)}})
    assert found.threshold == pytest.approx(2.4e-6)


def test_more_scatter_or_a_smaller_share_are_what_somebody_asks_for() -> None:
    (found,) = settings(REST, {"up": REST | {"up": levels(60e-6, 5e-6)}}, scatter=10, share=0.5)
    assert found.threshold == pytest.approx(4e-6, rel=0.1)
    assert found.maximum == pytest.approx(34e-6, rel=0.05)


def test_a_contraction_that_hardly_stands_out_is_said_so() -> None:
    (found,) = settings(REST, {"up": REST | {"up": levels(4e-6, 0.4e-6)}})
    assert not found.separable
    assert "up can hardly be told from rest" in found.remarks[0]


def test_a_wearer_who_did_not_rest_is_told_so() -> None:
    restless = np.concatenate((levels(2e-6, 0.2e-6), levels(60e-6, 5e-6, 15)))
    (found,) = settings({"up": restless}, {"up": {"up": levels(60e-6, 5e-6)}})
    assert found.remarks[0].startswith("up was not at rest all the time")
    assert not found.separable


def test_a_muscle_that_works_along_is_told() -> None:
    both = {"up": levels(60e-6, 5e-6), "down": levels(20e-6, 3e-6)}
    found = settings(REST, {"up": both, "down": REST | {"down": levels(60e-6, 5e-6)}})
    assert found[1].remarks == ("while up was contracted, down was above its threshold 100% of the time",)
    assert found[0].remarks == ()


def test_a_site_of_which_nothing_is_known_is_refused_by_name() -> None:
    with pytest.raises(Refused, match="too little is known of up while it was contracted: 0 looks"):
        settings(REST, {"up": REST | {"up": np.full(100, np.nan)}})


def test_a_toggle_site_asks_for_more_than_a_peak_of_rest() -> None:
    held = {"up": levels(60e-6, 5e-6)}
    (found,) = settings(REST, {"up": REST | held}, toggles={"up"})
    assert found.threshold == pytest.approx(0.3 * found.contraction, rel=0.01)
    assert found.separable
