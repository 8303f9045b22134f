"""`bentod emg`: what it says of recordings and models, and how it ends."""

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result

from bentod.cli import emg as command
from bentod.emg.classify import labelled_files, model_file
from tests.emg import gestures

FEATURES = ("--feature", "mav", "--feature", "zc:threshold_v=1e-6")


def run(*arguments: object) -> Result:
    return CliRunner().invoke(command.emg, [str(argument) for argument in arguments])


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("emg") / "session.npz"
    labelled_files.write(path, gestures.session())
    return path


@pytest.fixture(scope="module")
def model(recording: Path) -> Path:
    path = recording.with_name("hand.emg")
    assert run("train", recording, "--out", path, *FEATURES, "--option", "shrinkage=0.1").exit_code == 0
    return path


def test_training_says_how_well_each_repetition_is_recognised_by_the_others(
    recording: Path, tmp_path: Path
) -> None:
    told = run("train", recording, "--out", tmp_path / "hand.emg")
    assert told.exit_code == 0
    assert "each repetition by the others: " in told.output
    assert "done \\ recognised  close  open  rest  turn  right" in told.output
    assert "too good: windows overlap" in told.output
    assert f"{(tmp_path / 'hand.emg').stat().st_size} bytes" in told.output


def test_a_model_has_what_was_asked_for(model: Path) -> None:
    found = model_file.read(model)
    assert found.setting == gestures.SETTING
    assert found.options == {"shrinkage": 0.1}
    assert found.features.names == (*(f"mav[{k}]" for k in range(4)), *(f"zc[{k}]" for k in range(4)))
    assert found.training["recordings"] == ["session.npz"]


def test_a_config_conditions_what_is_trained_on(recording: Path, tmp_path: Path) -> None:
    config = tmp_path / "arm.toml"
    shipped = Path(__file__).parents[2] / "config" / "sim.toml"
    filters = "[[emg.filters]]\nkind = 'high_pass'\nhz = 20\n"
    config.write_text(f"{shipped.read_text()}\n{filters}")
    told = run("train", recording, "--out", tmp_path / "hand.emg", "--config", config)
    assert told.exit_code == 0, told.output
    (found,) = model_file.read(tmp_path / "hand.emg").setting.filters
    assert (found.kind, found.hz) == ("high_pass", 20)


def test_a_model_is_tried_on_another_session(model: Path, tmp_path: Path) -> None:
    labelled_files.write(tmp_path / "other.npz", gestures.session(seed=2))
    told = run("test", model, tmp_path / "other.npz")
    assert told.exit_code == 0
    first, *_ = told.output.splitlines()
    assert float(first.split()[0]) > 95
    assert first.endswith(f"of {len(gestures.windows())} windows")


def test_a_recording_that_the_model_was_not_trained_for_is_refused(model: Path, tmp_path: Path) -> None:
    path = tmp_path / "other.npz"
    np.savez(path, emg=np.zeros((400, 6)), fs=1000, labels=["rest"] * 400)
    told = run("test", model, path)
    assert told.exit_code == 1
    assert "The model's rate is 200 Hz; here it is 1000 Hz." in told.output
    assert "The model's number of channels is 4; here it is 6." in told.output


def test_a_model_is_told_in_sentences(model: Path) -> None:
    told = run("show", model)
    assert told.exit_code == 0
    assert "classifier: lda (shrinkage 0.1), seed 0" in told.output
    assert "signals: 4 channels at 200 Hz, filters: none" in told.output
    assert "windows: 30 samples every 10" in told.output
    assert "features: 8 columns, mav, zc" in told.output
    assert "class open: loudness " in told.output
    assert "recordings: session.npz" in told.output
    assert "None" not in told.output


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (("--feature", "mavx"), "did you mean 'mav'"),
        (("--feature", "zc:threshold"), "--feature zc:threshold: write NAME:KEY=VALUE"),
        (("--option", "shrinkage"), "--option shrinkage: write KEY=NUMBER"),
        (("--option", "c=1"), "the classifier lda has no option 'c'"),
        (("--rate-hz", "1000"), "it states 200 Hz, not 1000 Hz"),
        (("--window-s", "0.001"), "a window of 0 samples is too short"),
    ],
)
def test_what_cannot_be_is_one_sentence_and_writes_nothing(
    arguments: tuple[str, ...], sentence: str, recording: Path, tmp_path: Path
) -> None:
    told = run("train", recording, "--out", tmp_path / "hand.emg", *arguments)
    assert told.exit_code == 1
    assert sentence in told.output
    assert not list(tmp_path.iterdir())


def test_what_is_no_model_is_told(recording: Path) -> None:
    told = run("show", recording)
    assert told.exit_code == 1
    assert "session.npz: this is no model of muscle signals" in told.output
