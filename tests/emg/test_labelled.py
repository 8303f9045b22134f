"""Labelled recordings, the windows of them, and how well classes are told apart in those."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bentod.config_conditioning import Filter
from bentod.emg.classify import labelled_files
from bentod.emg.classify.evaluation import Score, across, at_random, by_repetition, scored, total
from bentod.emg.classify.labelled import LabelledWindows, Piece, Recorded, counted, windows_of
from bentod.emg.classify.training import Recipe
from bentod.emg.features.feature_list import FeatureList
from bentod.emg.recognition import Segmenting
from bentod.errors import ConfigError, InputFileError
from tests.emg import gestures

RECIPE = Recipe(gestures.FEATURES)
MYO = Path(__file__).parents[3] / "shared" / "data" / "libemg_myo_200hz.npz"


def piece(labels: str, repetitions: str = "") -> Piece:
    """One sample a letter, of one channel, which counts; a dash has no label."""
    samples = np.arange(float(len(labels)))[:, np.newaxis]
    words = np.array(["" if letter == "-" else letter for letter in labels])
    numbers = np.array([int(digit) for digit in repetitions or "0" * len(labels)])
    return Piece(samples, words, numbers, np.full(len(labels), ""))


def windows(*pieces: Piece, length: int = 3, step: int = 1) -> LabelledWindows:
    return windows_of([Recorded(200.0, pieces)], Segmenting(length, step))


def firsts(found: LabelledWindows) -> list[tuple[float, str]]:
    """First sample and label of each window."""
    return list(zip(found.windows[:, 0, 0].tolist(), found.labels.tolist(), strict=True))


def test_a_window_says_one_thing_or_is_left_out() -> None:
    assert firsts(windows(piece("aaaabbbb"))) == [(0, "a"), (1, "a"), (4, "b"), (5, "b")]


def test_samples_without_a_label_are_left_out() -> None:
    assert firsts(windows(piece("aaa--aaaa"))) == [(0, "a"), (5, "a"), (6, "a")]


def test_windows_do_not_reach_from_one_repetition_to_the_next() -> None:
    assert firsts(windows(piece("aaaaaa", "000111"))) == [(0, "a"), (3, "a")]


def test_windows_do_not_reach_from_one_piece_to_the_next() -> None:
    assert firsts(windows(piece("aaaa"), piece("aaa"))) == [(0, "a"), (1, "a"), (0, "a")]


def test_windows_with_missing_samples_are_left_out() -> None:
    broken = piece("aaaaaaa")
    broken.samples[3] = np.nan
    assert firsts(windows(broken)) == [(0, "a"), (4, "a")]


def test_windows_are_of_conditioned_samples() -> None:
    recorded = gestures.session()
    offset = replace(recorded.pieces[0], samples=recorded.pieces[0].samples + 1e-3)
    high_pass = (Filter(kind="high_pass", hz=20),)
    found = windows_of([Recorded(200.0, (offset,))], gestures.SETTING.segmenting, high_pass)
    assert np.abs(found.windows.mean(axis=2)).max() < 1e-5
    assert len(found) < len(gestures.windows())  # the filter settles first


def test_recordings_that_are_not_alike_are_told() -> None:
    other = Recorded(100.0, (piece("aaaa"),))
    with pytest.raises(ConfigError, match="there is 1 channels at 100 Hz and 1 channels at 200 Hz"):
        windows_of([Recorded(200.0, (piece("aaaa"),)), other], Segmenting(3, 1))


def test_recordings_too_short_for_a_window_are_told() -> None:
    with pytest.raises(ConfigError, match="no window of 3 samples"):
        windows(piece("aabb"))


def test_repetitions_are_counted_where_they_are_not_told() -> None:
    labels = np.array(list("raarrbrra"))
    assert counted(labels).tolist() == [0, 0, 0, 1, 1, 0, 2, 2, 1]


def test_what_was_written_is_read_again(tmp_path: Path) -> None:
    recorded = gestures.session(seconds=0.5)
    labelled_files.write(tmp_path / "session.npz", recorded)
    again = labelled_files.read(tmp_path / "session.npz")
    one, other = (windows_of([found], gestures.SETTING.segmenting) for found in (recorded, again))
    assert again.rate_hz == recorded.rate_hz
    assert np.array_equal(one.windows, other.windows)
    assert np.array_equal(one.labels, other.labels)
    assert np.array_equal(one.repetitions, other.repetitions)


def saved(path: Path, **arrays: object) -> Path:
    np.savez(path, allow_pickle=False, **{name: np.asarray(values) for name, values in arrays.items()})
    return path


def test_numbers_are_names_and_below_zero_nothing_is_known(tmp_path: Path) -> None:
    path = saved(tmp_path / "a.npz", emg=np.zeros((4, 2)), fs=200, cls=[-1, 0, 1, 1], names=["rest", "close"])
    (found,) = labelled_files.read(path).pieces
    assert found.labels.tolist() == ["", "rest", "close", "close"]


def test_numbers_without_names_are_named_by_themselves(tmp_path: Path) -> None:
    path = saved(tmp_path / "a.npz", emg=np.zeros((3, 2)), fs=200, cls=[0, 2, 2])
    assert labelled_files.read(path).pieces[0].labels.tolist() == ["class_0", "class_2", "class_2"]


def test_whole_numbers_are_microvolts_unless_the_file_is_said_to_hold_others(tmp_path: Path) -> None:
    path = saved(tmp_path / "a.npz", emg=np.array([[3], [-5]], np.int8), fs=200, labels=["a", "a"])
    assert labelled_files.read(path).pieces[0].samples[:, 0].tolist() == pytest.approx([3e-6, -5e-6])
    scaled = labelled_files.read(path, volts_per_unit=0.5)
    assert scaled.pieces[0].samples[:, 0].tolist() == [1.5, -2.5]


def test_recordings_one_after_another_are_pieces(tmp_path: Path) -> None:
    path = saved(
        tmp_path / "a.npz",
        emg=np.zeros((5, 1)),
        fs=200,
        length=[2, 3],
        cls=[0, 1],
        rep=[4, 5],
        condition=["x", "y"],
    )
    one, other = labelled_files.read(path).pieces
    assert (len(one.samples), len(other.samples)) == (2, 3)
    assert (other.labels[0], other.repetitions[0], other.conditions[0]) == ("class_1", 5, "y")


def test_a_table_with_a_column_of_labels_is_a_recording(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("time,ch0,ch1,label,repetition\n0.000,0.5,1e-3,rest,0\n0.005,0.25,2e-3,close,1\n")
    found = labelled_files.read(path)
    assert found.rate_hz == pytest.approx(200)
    assert found.pieces[0].samples.tolist() == [[0.5, 1e-3], [0.25, 2e-3]]
    assert found.pieces[0].labels.tolist() == ["rest", "close"]
    assert found.pieces[0].repetitions.tolist() == [0, 1]


@pytest.mark.parametrize(
    ("arrays", "sentence"),
    [
        ({"cls": [0, 0]}, "it needs 'emg'"),
        ({"emg": np.zeros((2, 1)), "fs": 200}, "it needs 'labels' or 'cls'"),
        ({"emg": np.zeros((2, 1)), "cls": [0, 0]}, "does not state its rate"),
        ({"emg": np.zeros((2, 1)), "cls": [0, 0, 0], "fs": 200}, "'cls' is of shape"),
        ({"emg": np.zeros((2, 1)), "cls": [0, 3], "names": ["a"], "fs": 200}, "label 3 has no name"),
        ({"emg": np.zeros((2, 1)), "cls": [0.5, 1], "fs": 200}, "words or whole numbers"),
        (
            {"emg": np.zeros((2, 1)), "cls": [0], "length": [3], "fs": 200},
            "adds up to 3 samples; there are 2",
        ),
        ({"emg": np.zeros((2, 1)), "cls": [0, 0], "fs": 5}, "its rate is 5 Hz; it must be from 50"),
        ({"emg": np.zeros((0, 1)), "cls": [], "fs": 200}, "there is nothing in it"),
    ],
)
def test_what_is_wrong_with_a_file_is_told(arrays: dict[str, object], sentence: str, tmp_path: Path) -> None:
    with pytest.raises(InputFileError, match=f"a.npz: .*{sentence}"):
        labelled_files.read(saved(tmp_path / "a.npz", **arrays))


def test_files_that_cannot_be_read_are_told(tmp_path: Path) -> None:
    with pytest.raises(InputFileError, match="there is no such file"):
        labelled_files.read(tmp_path / "a.npz")
    (tmp_path / "a.npz").write_bytes(b"PK\x03\x04 not quite")
    with pytest.raises(InputFileError, match="cannot be read"):
        labelled_files.read(tmp_path / "a.npz")
    (tmp_path / "a.csv").write_text("ch0,ch1\n1,2\n")
    with pytest.raises(InputFileError, match="one of them 'label'"):
        labelled_files.read(tmp_path / "a.csv")
    (tmp_path / "a.csv").write_text("ch0,label\nx,rest\n")
    with pytest.raises(InputFileError, match="cannot be read: could not convert"):
        labelled_files.read(tmp_path / "a.csv", rate_hz=200)
    with pytest.raises(InputFileError, match=r"ends in \.npz or \.csv"):
        labelled_files.read(tmp_path / "a.mat")


def test_a_rate_that_contradicts_the_file_is_told(tmp_path: Path) -> None:
    path = saved(tmp_path / "a.npz", emg=np.zeros((2, 1)), cls=[0, 0], fs=200)
    with pytest.raises(InputFileError, match="it states 200 Hz, not 1000 Hz"):
        labelled_files.read(path, rate_hz=1000)


def test_each_repetition_is_recognised_by_what_was_learned_from_the_others() -> None:
    scores = by_repetition(gestures.windows(), RECIPE)
    assert sorted(scores) == [0, 1, 2]
    assert sum(score.windows for score in scores.values()) == len(gestures.windows())
    assert min(score.accuracy for score in scores.values()) > 0.95


def test_labels_that_mean_nothing_are_recognised_as_often_as_chance_has_it() -> None:
    found = gestures.windows()
    shuffled = np.random.default_rng(3).permutation(found.labels)
    score = total(list(by_repetition(replace(found, labels=shuffled), RECIPE).values()))
    assert abs(score.accuracy - 1 / len(gestures.GAINS)) < 0.1


def test_one_repetition_cannot_be_left_out() -> None:
    found = gestures.windows()
    with pytest.raises(ConfigError, match="two or more"):
        by_repetition(found.where(found.repetitions == 0), RECIPE)


@pytest.mark.parametrize("share", [0.0, 1.0, float("nan")])
def test_a_share_to_train_on_leaves_some_to_try(share: float) -> None:
    with pytest.raises(ConfigError, match="must be between 0 and 1"):
        at_random(gestures.windows(), RECIPE, share)


def test_random_splits_try_the_windows_that_were_not_trained_on() -> None:
    scores = at_random(gestures.windows(), RECIPE, share=0.8, times=3)
    assert [score.windows for score in scores] == [len(gestures.windows()) // 5] * 3
    assert not np.array_equal(scores[0].confusion.sum(axis=1), scores[1].confusion.sum(axis=1))
    again = at_random(gestures.windows(), RECIPE, share=0.8, times=3)
    assert all(
        np.array_equal(one.confusion, other.confusion) for one, other in zip(scores, again, strict=True)
    )


def test_a_class_that_was_not_trained_is_never_right() -> None:
    found = gestures.windows()
    score = across(found.where(found.labels != "turn"), found, RECIPE)
    assert score.labels == ("close", "open", "rest", "turn")
    assert score.recall()["turn"] == 0
    assert score.confusion.sum(axis=1)[3] == np.sum(found.labels == "turn")


def test_nothing_to_try_is_told() -> None:
    model = gestures.model()
    none = gestures.windows().where(np.zeros(len(gestures.windows()), bool))
    with pytest.raises(ConfigError, match="no windows to try"):
        scored(none, model.features, model.classifier)


@settings(max_examples=50, deadline=None)
@given(st.lists(st.sampled_from("abc"), min_size=2))
def test_scores_add_up_whatever_classes_each_has(truth: list[str]) -> None:
    def score(labels: list[str]) -> Score:
        names = tuple(sorted(set(labels)))
        return Score(names, np.diag([labels.count(name) for name in names]).astype(np.int64))

    half = len(truth) // 2
    added = score(truth[:half]) + score(truth[half:])
    assert added.labels == score(truth).labels
    assert np.array_equal(added.confusion, score(truth).confusion)


@pytest.mark.skipif(not MYO.exists(), reason="the public recording is not here")
def test_a_public_recording_is_recognised_as_well_as_others_recognise_it() -> None:
    """Repetition 2 by 0 and 1; of 3, for which the armband was moved, as little as with LibEMG's features."""
    found = windows_of([labelled_files.read(MYO)], Segmenting(30, 10))
    features = FeatureList(["mav", "zc_product", "ssc_ge0", "wl"], 8, 200.0)
    known = found.where(found.repetitions < 2)
    again, moved = (
        across(known, found.where(found.repetitions == k), Recipe(features)).accuracy for k in (2, 3)
    )
    assert again == 1.0
    assert moved == pytest.approx(0.215, abs=0.0005)
