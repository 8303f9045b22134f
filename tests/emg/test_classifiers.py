"""Classifiers: equal to what trained them, the same alone and among others, and without threads."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sklearn.discriminant_analysis import LinearDiscriminantAnalysis
from sklearn.ensemble import RandomForestClassifier
from sklearn.neighbors import KNeighborsClassifier
from sklearn.preprocessing import StandardScaler
from sklearn.svm import SVC

from bentod.emg.classify.kinds import restored, trainer
from bentod.emg.classify.pairs import calibrated, coupled
from bentod.emg.classify.svm import train_linear, train_rbf
from bentod.emg.recognition import Classifier, Table
from bentod.errors import ConfigError, SnapshotError
from bentod.registry import CLASSIFIERS
from tests.emg import gestures

KINDS = sorted(CLASSIFIERS)


def known() -> tuple[Table, list[str]]:
    windows = gestures.windows()
    return gestures.FEATURES.of(windows.windows), windows.labels.tolist()


def classifier(kind: str) -> Classifier:
    return gestures.model(kind).classifier


def test_every_kind_is_tried_here() -> None:
    assert sorted(gestures.OPTIONS) == KINDS


@pytest.mark.parametrize("kind", KINDS)
def test_the_probabilities_of_a_window_add_up_to_one(kind: str) -> None:
    shares = classifier(kind).probabilities(gestures.table())
    assert shares.shape == (len(gestures.table()), len(gestures.GAINS))
    assert (shares >= 0).all()
    assert np.abs(shares.sum(axis=1) - 1).max() < 1e-12


@pytest.mark.parametrize("kind", KINDS)
@settings(max_examples=25, deadline=None)
@given(data=st.data())
def test_a_window_has_the_same_bits_alone_and_among_others(kind: str, data: st.DataObject) -> None:
    table = gestures.table()
    chosen = data.draw(st.lists(st.integers(0, len(table) - 1), min_size=1, max_size=20))
    together = classifier(kind).probabilities(table[chosen])
    alone = [classifier(kind).probabilities(table[place : place + 1]) for place in chosen]
    assert np.array_equal(together, np.concatenate(alone))


@pytest.mark.parametrize("kind", KINDS)
def test_no_windows_have_no_probabilities(kind: str) -> None:
    assert classifier(kind).probabilities(gestures.table()[:0]).shape == (0, len(gestures.GAINS))


@pytest.mark.parametrize("kind", KINDS)
def test_training_again_gives_the_same_bits(kind: str) -> None:
    again = trainer(kind)(*known(), gestures.OPTIONS[kind], 0).arrays()
    for name, array in classifier(kind).arrays().items():
        assert np.array_equal(array, again[name]), name


def test_another_seed_grows_another_forest() -> None:
    one, other = (trainer("random_forest")(*known(), {"trees": 5}, seed).arrays() for seed in (0, 1))
    assert not np.array_equal(one["bound"], other["bound"])


@pytest.mark.parametrize("kind", KINDS)
def test_what_was_kept_says_the_same_as_what_was_trained(kind: str) -> None:
    trained = classifier(kind)
    again = restored(kind, trained.labels, {name: array.copy() for name, array in trained.arrays().items()})
    assert np.array_equal(again.probabilities(gestures.table()), trained.probabilities(gestures.table()))


@pytest.mark.parametrize("kind", KINDS)
def test_arrays_that_do_not_go_together_are_refused(kind: str) -> None:
    trained = classifier(kind)
    for name in trained.arrays():
        arrays = dict(trained.arrays())
        missing = {key: array for key, array in arrays.items() if key != name}
        with pytest.raises(SnapshotError, match=name):
            restored(kind, trained.labels, missing)
        with pytest.raises(SnapshotError, match=r"finite|shape"):
            restored(kind, trained.labels, arrays | {name: np.full_like(arrays[name], np.nan)})


def test_a_forest_that_leads_out_of_itself_is_refused() -> None:
    trained = classifier("random_forest")
    for name, value in (("low", 1e9), ("high", -1.0), ("column", 1e6), ("roots", -2.0)):
        with pytest.raises(SnapshotError, match="nodes that it does not have"):
            restored(
                "random_forest",
                trained.labels,
                {**trained.arrays(), name: trained.arrays()[name] * 0 + value},
            )


def test_lda_is_that_of_scikit_learn() -> None:
    table, labels = known()
    theirs = LinearDiscriminantAnalysis().fit(table, labels).predict_proba(gestures.table())
    assert np.abs(theirs - classifier("lda").probabilities(gestures.table())).max() < 1e-9


def test_lda_of_two_classes_is_that_of_scikit_learn() -> None:
    table, labels = known()
    labels = ["moving" if label != "rest" else label for label in labels]
    theirs = LinearDiscriminantAnalysis().fit(table, labels).predict_proba(gestures.table())
    ours = trainer("lda")(table, labels, {}, 0)
    assert ours.labels == ("moving", "rest")
    assert np.abs(theirs - ours.probabilities(gestures.table())).max() < 1e-9


def test_lda_does_without_a_column_that_never_changes() -> None:
    table, labels = known()
    wider = trainer("lda")(np.column_stack([table, np.ones(len(table))]), labels, {}, 0)
    asked = np.column_stack([gestures.table(), np.ones(len(gestures.table()))])
    without = classifier("lda").probabilities(gestures.table())
    assert np.abs(wider.probabilities(asked) - without).max() < 1e-9


def test_the_nearest_neighbours_are_those_of_scikit_learn() -> None:
    table, labels = known()
    scale = StandardScaler().fit(table)
    theirs = KNeighborsClassifier(5).fit(scale.transform(table), labels)
    ours = classifier("knn").probabilities(gestures.table())
    assert np.array_equal(theirs.predict_proba(scale.transform(gestures.table())), ours)


def test_a_random_forest_is_that_of_scikit_learn() -> None:
    table, labels = known()
    theirs = RandomForestClassifier(20, random_state=0).fit(table, labels).predict_proba(gestures.table())
    assert np.abs(theirs - classifier("random_forest").probabilities(gestures.table())).max() < 1e-12


@pytest.mark.parametrize("kernel", ["linear", "rbf"])
@pytest.mark.parametrize("classes", [2, 4])
def test_support_vector_machines_decide_pairs_as_those_of_scikit_learn(kernel: str, classes: int) -> None:
    table, labels = known()
    labels = labels if classes == 4 else [str(label == "rest") for label in labels]
    scale = StandardScaler().fit(table)
    theirs = SVC(kernel=kernel, C=3.0, gamma=0.1, decision_function_shape="ovo")
    decisions = theirs.fit(scale.transform(table), labels).decision_function(
        scale.transform(gestures.table())
    )
    if classes == 2:  # theirs is then above 0 for the second of the pair
        decisions = -decisions[:, np.newaxis]
    options = {"c": 3.0} if kernel == "linear" else {"c": 3.0, "gamma": 0.1}
    ours = (train_linear if kernel == "linear" else train_rbf)(table, labels, options)
    assert np.abs(decisions - ours.decisions(gestures.table())).max() < 1e-9


def test_a_class_that_beats_all_others_is_the_likeliest() -> None:
    sure = coupled(np.array([[2.0, 2.0, -1.0]]), 3, slope=1.0)  # 0 beats 1 and 2, 2 beats 1
    assert sure.argmax() == 0
    assert sure[0, 2] > sure[0, 1]


def test_pairs_that_say_nothing_make_all_classes_alike() -> None:
    assert coupled(np.zeros((1, 6)), 4, slope=3.0) == pytest.approx(np.full((1, 4), 0.25))


def test_machines_that_were_often_wrong_are_less_sure() -> None:
    codes = np.repeat([0, 1], 50).astype(np.intp)
    right = np.where(codes == 0, 1.0, -1.0)[:, np.newaxis]
    noisy = right.copy()
    noisy[::4] *= -1
    assert calibrated(noisy, codes, 2) < calibrated(right, codes, 2)


def test_machines_that_were_never_wrong_are_not_certain() -> None:
    codes = np.repeat([0, 1], 50).astype(np.intp)
    right = np.where(codes == 0, 1.0, -1.0)[:, np.newaxis]
    assert coupled(right, 2, calibrated(right, codes, 2)).max() < 0.99


@pytest.mark.parametrize(
    ("kind", "options", "sentence"),
    [
        ("lda", {"shrinkag": 0.1}, "the classifier lda has no option 'shrinkag'; did you mean 'shrinkage'?"),
        ("lda", {"shrinkage": 2.0}, "is 2; it must be from 0 to 1"),
        ("knn", {"neighbours": 2.5}, "is 2.5; it must be whole"),
        ("knn", {"neighbours": 0.0}, "it must be from 1 to 100"),
        ("svm_rbf", {"c": 0.0}, "the option 'c' of the classifier svm_rbf is 0"),
        ("random_forest", {"trees": 5000.0}, "it must be from 1 to 1000"),
    ],
)
def test_an_option_that_cannot_be_is_told_with_its_bounds(
    kind: str, options: dict[str, float], sentence: str
) -> None:
    with pytest.raises(ConfigError) as raised:
        trainer(kind)(*known(), options, 0)
    assert sentence in str(raised.value)


@pytest.mark.parametrize("kind", KINDS)
def test_rows_that_cannot_be_learned_from_are_told(kind: str) -> None:
    train = trainer(kind)
    with pytest.raises(ConfigError, match="'close' is the only one"):
        train(np.zeros((3, 2)), ["close"] * 3, {}, 0)
    with pytest.raises(ConfigError, match="the class 'open' has 1 rows"):
        train(np.eye(6), ["close"] * 5 + ["open"], {}, 0)
    with pytest.raises(ConfigError, match="column 1 of training row 2"):
        train(np.array([[0, 0], [1, 1], [0, np.nan], [1, 0]]), ["close", "open"] * 2, {}, 0)
    with pytest.raises(ConfigError, match="3 labels were given"):
        train(np.zeros((4, 2)), ["close", "open", "open"], {}, 0)


def test_more_neighbours_than_rows_cannot_be_had() -> None:
    with pytest.raises(ConfigError, match="10 neighbours"):
        trainer("knn")(np.eye(4), ["close", "open"] * 2, {"neighbours": 10}, 0)


def test_an_unknown_classifier_is_told_with_the_nearest() -> None:
    with pytest.raises(ConfigError, match="did you mean 'svm_rbf'"):
        trainer("svm_rfb")


def test_without_scikit_learn_one_is_told_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delitem(sys.modules, "bentod.emg.classify.lda", raising=False)
    monkeypatch.setitem(sys.modules, "sklearn.discriminant_analysis", None)
    with pytest.raises(ConfigError, match=r"pip install 'bentod\[emg\]'"):
        trainer("lda")


@pytest.mark.skipif(not Path("/proc/self/schedstat").exists(), reason="Linux tells how long threads work")
def test_prediction_needs_numpy_only_and_keeps_to_one_thread() -> None:
    """In a process of its own, with so many rows that BLAS would share out a product of them."""
    program = Path(__file__).with_name("predicting_alone.py")
    told = subprocess.run([sys.executable, program], capture_output=True, text=True, timeout=60, check=False)
    assert told.stdout == "one thread, no scikit-learn, no SciPy\n", told.stdout + told.stderr
