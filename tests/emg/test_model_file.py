"""A model's file: whole or refused, the same bytes for the same model, and what differs told in sentences."""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import replace
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bentod.config_conditioning import Filter
from bentod.emg.classify import model_file
from bentod.emg.classify.model import Model, Setting
from bentod.emg.classify.model_file import MAGIC
from bentod.emg.classify.training import Recipe, trained
from bentod.emg.features.feature_list import FeatureList
from bentod.emg.recognition import Segmenting
from bentod.errors import BentodError, SnapshotError
from bentod.registry import CLASSIFIERS
from tests.emg import gestures

FILTERS = (Filter(kind="high_pass", hz=20, order=2), Filter(kind="notch", hz=50, harmonics=2))


def archive(data: bytes) -> dict[str, np.ndarray[tuple[int, ...], np.dtype[np.generic]]]:
    with np.load(BytesIO(data[40:]), allow_pickle=False) as file:
        return {name: file[name] for name in file.files}


def rewritten(data: bytes, changes: Mapping[str, object]) -> bytes:
    """The file with other values in its header, and a checksum that fits."""
    arrays = archive(data)
    header = json.loads(arrays["header"].tobytes()) | changes
    arrays["header"] = np.frombuffer(json.dumps(header).encode(), np.uint8)
    return sealed(arrays)


def sealed(arrays: Mapping[str, np.ndarray[tuple[int, ...], np.dtype[np.generic]]]) -> bytes:
    body = BytesIO()
    np.savez(body, allow_pickle=True, **arrays)
    return MAGIC + hashlib.sha256(body.getvalue()).digest() + body.getvalue()


@pytest.mark.parametrize("kind", sorted(CLASSIFIERS))
def test_a_model_comes_back_as_it_was(kind: str, tmp_path: Path) -> None:
    model = gestures.model(kind)
    size = model_file.write(tmp_path / "hand.emg", model)
    again = model_file.read(tmp_path / "hand.emg")
    assert (tmp_path / "hand.emg").stat().st_size == size
    assert (again.setting, again.labels, again.kind) == (model.setting, model.labels, kind)
    assert (again.options, again.seed, again.ranges) == (model.options, model.seed, model.ranges)
    assert again.training == model.training
    assert again.features.spec() == model.features.spec()
    asked = gestures.table()
    assert np.array_equal(again.classifier.probabilities(asked), model.classifier.probabilities(asked))


def test_filters_and_what_features_found_in_training_are_kept() -> None:
    features = FeatureList([{"name": "hist", "bins": 5}, "mav"], gestures.CHANNELS, gestures.RATE_HZ)
    model = trained(gestures.windows(), Recipe(features), replace(gestures.SETTING, filters=FILTERS))
    again = model_file.understood(model_file.content(model))
    assert again.setting.filters == FILTERS
    assert again.features.spec() == model.features.spec() != features.spec()
    assert model_file.content(again) == model_file.content(model)


def test_the_same_model_makes_the_same_bytes() -> None:
    one, other = (trained(gestures.windows(), Recipe(gestures.FEATURES), gestures.SETTING) for _ in range(2))
    assert model_file.content(one) == model_file.content(other)


def test_what_stood_there_stays_if_the_disk_does_not_take_the_new_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "hand.emg"
    model_file.write(path, gestures.model())

    def full(number: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", full)
    with pytest.raises(OSError, match="No space"):
        model_file.write(path, gestures.model("knn"))
    assert model_file.read(path).kind == "lda"
    assert list(tmp_path.iterdir()) == [path]


@settings(max_examples=50, deadline=None)
@given(st.data())
def test_a_file_with_any_byte_changed_is_refused(data: st.DataObject) -> None:
    content = bytearray(model_file.content(gestures.model()))
    place = data.draw(st.integers(0, len(content) - 1))
    content[place] ^= data.draw(st.integers(1, 255))
    with pytest.raises(SnapshotError):
        model_file.understood(bytes(content))


@settings(max_examples=50, deadline=None)
@given(st.integers(0, 4000))
def test_a_file_that_is_cut_off_is_refused(length: int) -> None:
    content = model_file.content(gestures.model())
    with pytest.raises(SnapshotError):
        model_file.understood(content[: min(length, len(content) - 1)])


def test_a_file_with_something_behind_its_end_is_refused() -> None:
    with pytest.raises(SnapshotError, match="cut off or damaged"):
        model_file.understood(model_file.content(gestures.model()) + b"\0")


def test_pickles_are_refused_even_with_a_checksum_that_fits() -> None:
    arrays = archive(model_file.content(gestures.model()))
    with pytest.raises(SnapshotError, match="no archive of arrays"):
        model_file.understood(sealed({**arrays, "classifier.bias": np.array([{}], object)}))


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"format": 2}, "it is of format 2; this bentod reads up to 1"),
        ({"rate_hz": -1}, "its header cannot be understood: rate_hz"),
        ({"surprise": 1}, "its header cannot be understood: surprise"),
        ({"classifier": "oracle"}, "there is no classifier 'oracle'"),
        ({"classifier": "knn"}, "the array 'rows' is missing"),
        ({"columns": ["mav[0]"]}, "its features are 1 columns from 'mav\\[0\\]'"),
        ({"labels": ["close", "open"]}, "of shape \\(4, 16\\); what goes with it needs \\(2, 16\\)"),
        ({"ranges": {}}, "its class 'close' has no range of loudness"),
        ({"features": {"version": 99}}, "version 99"),
    ],
)
def test_what_does_not_go_together_is_refused(changes: dict[str, object], sentence: str) -> None:
    with pytest.raises(BentodError, match=sentence):
        model_file.understood(rewritten(model_file.content(gestures.model()), changes))


def test_rows_of_another_length_than_the_features_make_are_refused() -> None:
    arrays = archive(model_file.content(gestures.model()))
    weights = np.asarray(arrays["classifier.weights"], np.float64)
    with pytest.raises(SnapshotError, match="does not take rows of 16 columns"):
        model_file.understood(sealed({**arrays, "classifier.weights": weights[:, :5]}))


def test_a_file_that_is_none_or_not_there_is_told_with_its_name(tmp_path: Path) -> None:
    path = tmp_path / "hand.emg"
    with pytest.raises(SnapshotError, match=r"hand.emg: cannot be read: No such file"):
        model_file.read(path)
    path.write_text("not a model")
    with pytest.raises(SnapshotError, match=r"hand.emg: this is no model"):
        model_file.read(path)


def differences(setting: Setting, features: FeatureList | None = None) -> list[str]:
    return gestures.model().differences(setting, features)


def test_a_model_fits_what_it_was_trained_with() -> None:
    assert differences(gestures.SETTING) == []
    assert differences(gestures.SETTING, gestures.FEATURES) == []


def test_every_difference_is_a_sentence() -> None:
    other = Setting(1000.0, 8, Segmenting(150, 50), FILTERS)
    assert differences(other) == [
        "The model's rate is 200 Hz; here it is 1000 Hz.",
        "The model's number of channels is 4; here it is 8.",
        "The model's window is 30 samples; here it is 150 samples.",
        "The model's step of the windows is 10 samples; here it is 50 samples.",
        "The model's conditioning is none; here it is kind high_pass, hz 20.0, order 2; "
        "kind notch, hz 50.0, q 20.0, harmonics 2.",
    ]


def test_other_features_are_told_by_their_keys() -> None:
    asked = FeatureList(["mav", {"name": "zc", "threshold_v": 1e-5}, "ssc", "wl"], 4, 200.0)
    assert differences(gestures.SETTING, asked) == [
        "The model's features.features[1].threshold_v is 0.0; here it is 1e-05."
    ]
    assert len(differences(gestures.SETTING, FeatureList("mav", 4, 200.0))) == 1


def test_what_features_found_in_training_is_no_difference() -> None:
    features = FeatureList([{"name": "hist", "bins": 5}], gestures.CHANNELS, gestures.RATE_HZ)
    model: Model = trained(gestures.windows(), Recipe(features), gestures.SETTING)
    assert model.differences(gestures.SETTING, features) == []
