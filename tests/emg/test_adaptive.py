"""A classifier that follows its wearer: what it learns from, what it refuses, and how it goes back."""

import numpy as np
import pytest
from numpy.typing import NDArray

from bentod.config_adaptation import Adaptation
from bentod.emg.adapt import normal
from bentod.emg.adapt.adaptive import Adaptive
from bentod.emg.classify import lda
from bentod.emg.classify.kinds import restored
from bentod.errors import ConfigError, SnapshotError

STEP_S = 0.05
CENTRES = {"close": (6.0, 0.0), "open": (0.0, 6.0), "rest": (0.0, 0.0)}
Rows = NDArray[np.float64]


def made(label: str, count: int, seed: int, shift: tuple[float, float] = (0.0, 0.0)) -> Rows:
    noise: Rows = np.random.default_rng([seed, len(label)]).normal(scale=0.5, size=(count, 2))
    found: Rows = noise + CENTRES[label] + np.asarray(shift)
    return found


def trained() -> normal.Normal:
    rows = np.concatenate([made(label, 50, 1) for label in CENTRES])
    return normal.train(rows, [label for label in CENTRES for _ in range(50)], {}, 0)


def following(**rules: float) -> Adaptive:
    return Adaptive(trained(), Adaptation.model_validate(rules), STEP_S)


def contraction(one: Adaptive, label: str, shift: tuple[float, float], seed: int, count: int = 40) -> None:
    """Held for 2 s, with as much rest after it."""
    one.probabilities(made(label, count, seed, shift))
    one.probabilities(made("rest", 40, seed))


def place_of(one: Adaptive, label: str) -> Rows:
    mean: Rows = one.arrays()["means"][one.labels.index(label)]
    return mean


def test_what_can_be_adapted_answers_as_lda_does() -> None:
    rows = np.random.default_rng(3).normal(size=(90, 5)) + np.repeat(np.eye(3, 5), 30, axis=0)
    labels = np.repeat(["a", "b", "c"], 30).tolist()
    asked = np.random.default_rng(4).normal(size=(50, 5))
    expected = lda.train(rows, labels, {}).probabilities(asked)
    np.testing.assert_allclose(normal.train(rows, labels, {}).probabilities(asked), expected, rtol=1e-6)


def test_a_column_without_scatter_tells_nothing() -> None:
    rows = np.column_stack([np.concatenate([made(label, 50, 1) for label in CENTRES]), np.full(150, 7.0)])
    found = normal.train(rows, [label for label in CENTRES for _ in range(50)], {}, 0)
    assert found.labels[int(np.argmax(found.probabilities(np.array([[6.0, 0.0, 7.0]]))))] == "close"


def test_it_is_the_same_when_it_is_had_back_from_a_file() -> None:
    found = trained()
    again = restored("lda_adaptive", found.labels, found.arrays())
    asked = made("open", 20, 5)
    np.testing.assert_array_equal(again.probabilities(asked), found.probabilities(asked))


@pytest.mark.parametrize("name", ["means", "precision", "logs"])
def test_what_is_missing_in_a_file_is_told(name: str) -> None:
    arrays = {key: value for key, value in trained().arrays().items() if key != name}
    with pytest.raises(SnapshotError, match=name):
        normal.restore(("close", "open", "rest"), arrays)


def test_an_option_that_it_does_not_know_is_an_error() -> None:
    with pytest.raises(ConfigError, match="shrinkage"):
        normal.train(made("close", 9, 1), ["close"] * 9, {"shrinkge": 0.1}, 0)


def test_confirmed_contractions_draw_their_class_along() -> None:
    one = following()
    for number in range(12):
        contraction(one, "close", (0.1 * number, 0.1 * number), number)
    assert one.learned >= 12
    np.testing.assert_allclose(place_of(one, "close"), (7.0, 1.0), atol=0.5)
    np.testing.assert_allclose(place_of(one, "open"), (0.0, 6.0), atol=0.3)


def test_the_answer_to_a_window_does_not_depend_on_how_many_come_at_once() -> None:
    rows = np.concatenate([made(label, 40, n, (0.5, 0.5)) for n in range(4) for label in ("close", "rest")])
    whole, single = following(), following()
    by_one = np.concatenate([single.probabilities(rows[n : n + 1]) for n in range(len(rows))])
    np.testing.assert_array_equal(whole.probabilities(rows), by_one)
    assert whole.learned == single.learned > 0


def test_who_lets_go_early_has_confirmed_nothing() -> None:
    one = following()
    contraction(one, "close", (1.0, 1.0), 1, count=10)
    np.testing.assert_array_equal(place_of(one, "close"), trained().means[0])


def test_another_movement_right_after_it_is_taken_for_a_correction() -> None:
    one = following()
    one.probabilities(made("close", 40, 1, (1.0, 1.0)))
    one.probabilities(made("rest", 6, 1))
    one.probabilities(made("open", 40, 1))
    np.testing.assert_array_equal(place_of(one, "close"), trained().means[0])


def test_a_movement_that_turns_into_another_without_rest_teaches_nothing() -> None:
    one = following()
    one.probabilities(made("close", 40, 1, (1.0, 1.0)))
    one.probabilities(made("open", 40, 1))
    one.probabilities(made("rest", 40, 1))
    np.testing.assert_array_equal(place_of(one, "close"), trained().means[0])


def test_nothing_is_learned_while_the_arm_does_not_obey() -> None:
    one = following()
    one.obeyed = False
    contraction(one, "close", (1.0, 1.0), 1)
    assert one.learned == 0
    np.testing.assert_array_equal(one.arrays()["means"], trained().means)


def test_windows_that_are_missing_end_a_contraction_without_a_lesson() -> None:
    one = following()
    one.probabilities(made("close", 40, 1, (1.0, 1.0)))
    one.interrupt()
    one.probabilities(made("rest", 40, 1))
    np.testing.assert_array_equal(place_of(one, "close"), trained().means[0])


def test_a_class_stays_within_its_bound_and_apart_from_the_others() -> None:
    one = following(bound=0.2)
    for number in range(30):
        contraction(one, "close", (2.0, 0.0), number)
    assert one.drift()["close"] == pytest.approx(1.0)
    near = following(apart=0.9, sure=0.0)
    for number in range(30):
        contraction(near, "close", (-1.8, 0.0), number)
    between = trained().distances(trained().means[2])[0]
    known = near.arrays()["means"]
    apart = normal.Normal(near.labels, known, trained().precision, trained().logs)
    assert apart.distances(known[2])[0] >= 0.9 * between - 1e-9


def test_when_the_band_is_put_back_it_goes_back_to_what_was_trained() -> None:
    one = following()
    for number in range(20):
        contraction(one, ("close", "open")[number % 2], (2.0, 2.0), number)
    assert np.linalg.norm(place_of(one, "close") - trained().means[0]) > 1.5
    for number in range(12):
        contraction(one, ("close", "open")[number % 2], (0.0, 0.0), number)
    assert one.describe()["rolled_back"] == 1
    assert np.linalg.norm(place_of(one, "close") - trained().means[0]) < 0.7


def test_a_reset_forgets_all_that_was_learned_in_use() -> None:
    one = following()
    contraction(one, "close", (1.0, 1.0), 1)
    assert not np.array_equal(one.arrays()["means"], trained().means)
    one.reset()
    np.testing.assert_array_equal(one.arrays()["means"], trained().means)
