"""The study of cliff sensors, on a shorter drive."""

import numpy as np
import pytest

from sim.studies import cliffs
from sim.studies.cliffs import LAMBDA, TIMESCALE, layer, predicted
from sim.studies.study import Findings

MINUTES = 1.5


@pytest.fixture(scope="module")
def found() -> Findings:
    return cliffs.run(1, MINUTES)


def test_three_sensors_are_predicted_and_from_those_predictions_a_fourth(found: Findings) -> None:
    assert [claim.row for claim in found.claims if not claim.holds] == []
    assert found.hold


def test_every_figure_of_the_thesis_has_its_counterpart(found: Findings) -> None:
    assert [picture.name for picture in found.pictures] == ["4-4", "4-5"]
    titles = [[panel.title for panel in picture.panels] for picture in found.pictures]
    assert titles == [["Left", "Front-Left", "Front-Right"], ["Right"]]
    for picture in found.pictures:
        for panel in picture.panels:
            assert set(panel.curves) == {"target", "prediction", "ideal"}
            assert {len(curve) for curve in panel.curves.values()} == {len(picture.time)}


def test_every_signal_and_prediction_is_told_at_every_step(found: Findings) -> None:
    assert {len(column) for column in found.series.values()} == {round(MINUTES * 60 * 30)}
    assert set(np.unique(found.series["right.binary"])) == {0, 1}


def test_the_fourth_sensor_is_learned_from_nothing_but_the_three_predictions(found: Findings) -> None:
    steps = 200
    first = np.column_stack([found.series[f"{name}.prediction"][:steps] for name in cliffs.PRIMARY])
    right = found.series["right.binary"][:steps, None]
    assert np.array_equal(layer(first, right)[:, 0], found.series["right.prediction"][:steps])


def test_a_layer_learns_by_true_online_td_with_the_settings_of_the_thesis() -> None:
    rng = np.random.default_rng(4)
    phis = rng.random((40, 5)) < 0.5
    target = rng.integers(0, 2, 40).astype(np.float64)
    gamma, alpha = 1 - 1 / TIMESCALE, 1 / 101
    w = w_before = e = np.zeros(5)
    expected = []
    for t, phi in enumerate(phis.astype(np.float64)):
        if t:
            old = phis[t - 1].astype(np.float64)
            delta = (1 - gamma) * target[t] + gamma * (w @ phi) - w_before @ old
            e = gamma * LAMBDA * e + alpha * old - alpha * gamma * LAMBDA * (e @ old) * old  # (4.5)
            w, w_before = w + delta * e + alpha * ((w_before - w) @ old) * old, w  # (4.6)
        expected.append(w @ phi)
    answers = predicted((np.flatnonzero(phi) for phi in phis), 5, target[:, None])[:, 0]
    assert answers == pytest.approx(np.array(expected), abs=1e-12)


def test_without_the_primary_layer_the_claims_about_the_fourth_sensor_fail(found: Findings) -> None:
    """The bounds can fail: predictions of another run, at another speed, tell nothing of this one."""
    steps = len(found.series["time_s"])
    strange = np.random.default_rng(0).random((steps, 3))
    right = found.series["right.binary"][:, None]
    judged = slice(steps // 2, steps - 150)
    useless = layer(strange, right)[judged, 0]
    claims = cliffs._secondary(useless, right[judged, 0], found.series["right.ideal"][judged])
    assert not any(claim.holds for claim in claims[:2])
