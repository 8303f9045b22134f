import pickle
import zipfile
from pathlib import Path

import numpy as np
import pytest

from bentod.errors import InputFileError
from drivers.emg.recording import load

COUNTS = np.array([[1, -2], [3, 4], [-5, 6]], np.int8)


def npz(folder: Path, **arrays: np.typing.NDArray[np.generic] | float) -> Path:
    path = folder / "recording.npz"
    np.savez(path, **{name: np.asarray(values) for name, values in arrays.items()})  # type: ignore[arg-type]
    return path


def csv(folder: Path, text: str) -> Path:
    path = folder / "recording.csv"
    path.write_text(text, encoding="utf-8")
    return path


def test_counts_of_an_armband_are_taken_for_microvolts(tmp_path: Path) -> None:
    recording = load(npz(tmp_path, emg=COUNTS), None, None)
    np.testing.assert_allclose(recording.samples, COUNTS * 1e-6, rtol=1e-6)
    assert recording.samples.dtype == np.float32


def test_numbers_with_a_point_are_taken_for_volts(tmp_path: Path) -> None:
    recording = load(npz(tmp_path, emg=COUNTS * 1e-5), None, None)
    np.testing.assert_allclose(recording.samples, COUNTS * 1e-5, rtol=1e-6)


@pytest.mark.parametrize("values", [COUNTS, COUNTS.astype(float)])
def test_a_given_scale_counts_for_both(tmp_path: Path, values: np.typing.NDArray[np.generic]) -> None:
    recording = load(npz(tmp_path, emg=values), None, 2e-7)
    np.testing.assert_allclose(recording.samples, COUNTS * 2e-7, rtol=1e-6)


def test_the_rate_is_read_from_the_array_fs(tmp_path: Path) -> None:
    assert load(npz(tmp_path, emg=COUNTS, fs=500), None, None).rate_hz == 500.0
    assert load(npz(tmp_path, emg=COUNTS), None, None).rate_hz is None


def test_the_array_called_emg_comes_first(tmp_path: Path) -> None:
    path = npz(tmp_path, stream=COUNTS * 2, emg=COUNTS)
    np.testing.assert_allclose(load(path, None, 1.0).samples, COUNTS)
    np.testing.assert_allclose(load(path, "stream", 1.0).samples, COUNTS * 2)


def test_else_the_only_flat_array_is_taken(tmp_path: Path) -> None:
    path = npz(tmp_path, signal=COUNTS, labels=np.arange(3))
    np.testing.assert_allclose(load(path, None, 1.0).samples, COUNTS)


def test_else_the_arrays_are_listed(tmp_path: Path) -> None:
    path = npz(tmp_path, one=COUNTS, two=COUNTS)
    with pytest.raises(InputFileError, match=r"neither .*'one' \(int8 of shape \(3, 2\)\), 'two'"):
        load(path, None, None)
    with pytest.raises(InputFileError, match="no array 'three'; the arrays are: 'one'"):
        load(path, "three", None)


@pytest.mark.parametrize("bad", [np.nan, np.inf, 1e300])
def test_what_is_not_finite_is_refused_with_its_place(tmp_path: Path, bad: float) -> None:
    values = np.zeros((5, 3))
    values[3, 1] = bad
    with pytest.raises(InputFileError, match="row 3, channel 1 is not a finite number"):
        load(npz(tmp_path, emg=values), None, None)


@pytest.mark.parametrize(
    ("values", "why"),
    [
        (np.zeros(5), r"float64 of shape \(5,\), not a 2-D array"),
        (np.zeros((5, 2), bool), "bool of shape"),
        (np.zeros((5, 2), complex), "complex128 of shape"),
        (np.array([["a", "b"]]), "<U1 of shape"),
        (np.zeros((0, 2)), r"shape \(0, 2\)"),
        (np.zeros((5, 0)), r"shape \(5, 0\)"),
        (np.zeros((8, 12_000)), "of 1 to 256 channels"),
    ],
)
def test_what_holds_no_samples_is_refused(
    tmp_path: Path, values: np.typing.NDArray[np.generic], why: str
) -> None:
    with pytest.raises(InputFileError, match=why):
        load(npz(tmp_path, emg=values), None, None)


@pytest.mark.parametrize("rate", [0.0, -1.0, np.nan, np.inf, 1e9])
def test_a_rate_out_of_bounds_is_refused(tmp_path: Path, rate: float) -> None:
    with pytest.raises(InputFileError, match="must be from 1 to 100000 Hz"):
        load(npz(tmp_path, emg=COUNTS, fs=rate), None, None)


def test_a_rate_that_is_not_one_number_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputFileError, match=r"'fs' is float64 of shape \(2,\)"):
        load(npz(tmp_path, emg=COUNTS, fs=np.array([1.0, 2.0])), None, None)


def test_a_pickle_is_never_opened(tmp_path: Path) -> None:
    path = tmp_path / "recording.npz"
    path.write_bytes(pickle.dumps({"emg": COUNTS}))
    with pytest.raises(InputFileError, match=r"recording\.npz: cannot be read"):
        load(path, None, None)
    np.savez(path, emg=np.array([{"a": 1}], object))
    with pytest.raises(InputFileError, match="allow_pickle=False"):
        load(path, None, None)


def test_a_damaged_archive_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "recording.npz"
    np.savez_compressed(path, emg=np.arange(20_000).reshape(-1, 2))
    whole = path.read_bytes()
    for damaged in (whole[:100], b"", whole[:90] + bytes(200) + whole[290:]):
        path.write_bytes(damaged)
        with pytest.raises(InputFileError, match="cannot be read"):
            load(path, None, None)


def test_an_archive_of_something_else_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "recording.npz"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("readme.txt", "no arrays")
    with pytest.raises(InputFileError, match="the arrays are: none"):
        load(path, None, None)


def test_a_file_that_does_not_exist_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputFileError, match=r"absent\.csv: there is no such file"):
        load(tmp_path / "absent.csv", None, None)


def test_a_file_of_another_kind_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputFileError, match=r"ends in \.npz or \.csv"):
        load(tmp_path / "recording.mat", None, None)


@pytest.mark.parametrize("heading", ["", "left,right\n", '\ufeff"left","right"\n\n'])
def test_a_csv_may_have_a_heading(tmp_path: Path, heading: str) -> None:
    recording = load(csv(tmp_path, heading + "1,-2\n3,4\n-5,6\n"), None, None)
    np.testing.assert_allclose(recording.samples, COUNTS * 1e-6, rtol=1e-6)
    assert recording.rate_hz is None


@pytest.mark.parametrize("name", ["time", "Time (s)", "timestamp", "T"])
def test_a_column_of_times_gives_the_rate_and_is_no_channel(tmp_path: Path, name: str) -> None:
    text = f"left,{name},right\n1e-6,7.000,2e-6\n1e-6,7.004,2e-6\n1e-6,7.010,2e-6\n"
    recording = load(csv(tmp_path, text), None, None)
    assert recording.rate_hz == pytest.approx(200.0)
    np.testing.assert_allclose(recording.samples, [[1e-6, 2e-6]] * 3, rtol=1e-6)


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("", "no samples in it"),
        ("left,right\n", "no samples in it"),
        ("1,2\n3\n", "number of columns changed"),
        ("1,2\n3,x\n", "could not convert string 'x'"),
        ("1,2\n3,\n", "could not convert string ''"),
        ("1,2\n3,nan\n", "row 1, channel 1 is not a finite number"),
        ("time,a\n0,1\n2,1\n1,1\n", "does not rise after row 1"),
        ("time,a\n0,1\nnan,1\n", "does not rise after row 0"),
        ("time,a\n5,1\n5,1\n", "spans no time"),
        ("time,a\n5,1\n", "spans no time"),
        ("time\n0\n1\n", r"shape \(2, 0\)"),
    ],
)
def test_a_csv_that_cannot_be_played_is_refused(tmp_path: Path, text: str, why: str) -> None:
    with pytest.raises(InputFileError, match=f"recording.csv: .*{why}"):
        load(csv(tmp_path, text), None, None)


def test_a_csv_that_is_not_text_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "recording.csv"
    path.write_bytes(b"\xff\xfe\x00\x81")
    with pytest.raises(InputFileError, match="cannot be read"):
        load(path, None, None)
