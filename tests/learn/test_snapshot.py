"""A snapshot is whole, or it is refused with a sentence; nothing in between."""

import errno
import hashlib
import json
import os
import struct
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from bentod.errors import SnapshotError
from bentod.frames import Value
from bentod.learn import snapshot_layout as layout
from bentod.learn.snapshot import Snapshot, read, taken, write
from bentod.whole_file import MODE, sweep_up

values: st.SearchStrategy[Value] = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text(max_size=8),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=12,
)
headers = st.dictionaries(st.text(max_size=5), values, max_size=4)
arrays = st.dictionaries(
    st.text(min_size=1, max_size=8),
    st.sampled_from(layout.KINDS).flatmap(
        lambda kind: hnp.arrays(kind, hnp.array_shapes(min_dims=0, min_side=0, max_dims=3, max_side=4))
    ),
    max_size=4,
)

SMALL = Snapshot(
    {"arm": "Bento", "spec": {"questions": [{"name": "elbow@20", "lam": 0.95}]}},
    {"weights": np.arange(6.0).reshape(2, 3), "counts": np.array([3, 4]), "δ": np.array(np.nan)},
)


def same(one: Snapshot, other: Snapshot) -> bool:
    """Whether two hold the same, to the last bit."""
    return one.header == other.header and [
        (n, a.dtype, a.shape, a.tobytes()) for n, a in one.arrays.items()
    ] == [(n, a.dtype, a.shape, a.tobytes()) for n, a in other.arrays.items()]


def refusal(path: Path, data: bytes) -> str:
    """The sentence with which `data` is refused; empty if they are taken."""
    path.write_bytes(data)
    try:
        read(path)
    except SnapshotError as error:
        return str(error).removeprefix(f"{path}: ")
    return ""


def forged(text: bytes, numbers: bytes = b"", version: int = layout.FORMAT) -> bytes:
    """A file whose checksums are right, whatever its header says."""
    start = struct.pack("<8sII", layout.MAGIC, version, len(text))
    return start + hashlib.sha256(start + text).digest() + text + numbers


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "arm.snapshot"
    write(path, SMALL)
    return path


@given(headers, arrays)
@settings(deadline=None, max_examples=40)
def test_what_is_written_is_read(header: dict[str, Value], held: dict[str, layout.Array]) -> None:
    with TemporaryDirectory() as folder:
        path = Path(folder) / "new" / "snapshot"
        size = write(path, Snapshot(header, held))
        assert size == path.stat().st_size
        assert same(read(path), Snapshot(header, held))


def test_arrays_of_any_layout_in_memory_are_read_as_they_are_indexed(tmp_path: Path) -> None:
    square = np.arange(12.0).reshape(3, 4)
    held = {
        "t": square.T,
        "part": square[::2, 1::2],
        "big": square.astype(">f8"),
        "fortran": square.copy("F"),
    }
    write(tmp_path / "s", Snapshot({}, held))
    found = read(tmp_path / "s").arrays
    for name, array in held.items():
        np.testing.assert_array_equal(found[name], array)


def test_any_changed_byte_is_found(file: Path) -> None:
    data = file.read_bytes()
    for place in range(len(data)):
        for mask in (0x01, 0x80):
            changed = bytearray(data)
            changed[place] ^= mask
            assert refusal(file, bytes(changed)), f"byte {place}"


def test_a_file_that_is_cut_off_anywhere_or_too_long_is_refused(file: Path) -> None:
    data = file.read_bytes()
    for length in range(len(data)):
        assert refusal(file, data[:length]), f"{length} bytes"
    assert "1 bytes follow its end" in refusal(file, data + b"\0")


def test_a_refusal_says_what_is_broken(file: Path) -> None:
    data = file.read_bytes()
    text = len(data) - 7 * 8 - 8 * 2
    assert "'weights' is damaged" in refusal(file, data[:text] + b"\1" + data[text + 1 :])
    assert "its header is damaged" in refusal(file, data[:60] + b"\0" + data[61:])
    assert "8 of 72 bytes of its arrays are missing" in refusal(file, data[:-8])
    assert "bytes of its header are missing" in refusal(file, data[:100])
    assert "cut off after 20 bytes" in refusal(file, data[:20])
    assert "this is no snapshot" in refusal(file, b"PK\3\4" + data[4:])
    assert "this is no snapshot" in refusal(file, b"")
    assert "is of format 2; this bentod reads up to 1" in refusal(file, forged(b"{}", version=2))
    file.unlink()
    with pytest.raises(SnapshotError, match="No such file"):
        read(file)
    with pytest.raises(SnapshotError, match="Is a directory"):
        read(file.parent)


def test_a_pipe_in_the_place_of_a_snapshot_keeps_nobody_waiting(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(SnapshotError, match="is not a file"):
        read(tmp_path / "pipe")


@given(st.binary(max_size=200))
@settings(deadline=None, max_examples=100)
def test_garbage_is_refused_and_nothing_else_happens(data: bytes) -> None:
    with TemporaryDirectory() as folder:
        path = Path(folder) / "s"
        assert refusal(path, data)
        assert refusal(path, forged(data))


_odd = values | st.sampled_from([2**62, -1, True, 1e300, [2**40], [0, 2**62], [1] * 9, "<f8", "|O", "<U5"])
_entries = st.fixed_dictionaries(
    {"name": _odd | st.just("a"), "dtype": _odd | st.just("<f8"), "shape": _odd | st.just([2])},
    optional={"sha256": _odd | st.just("00")},
)
_told = st.fixed_dictionaries({"header": headers | values, "arrays": st.lists(_entries, max_size=3) | values})


@given(_told | values, st.binary(max_size=40))
@settings(deadline=None, max_examples=100)
def test_headers_that_lie_are_refused_even_with_right_checksums(told: Value, numbers: bytes) -> None:
    with TemporaryDirectory() as folder:
        text = json.dumps(told).encode()
        empty = isinstance(told, dict) and isinstance(told.get("header"), dict) and told.get("arrays") == []
        assert bool(refusal(Path(folder) / "s", forged(text, numbers))) is not (empty and not numbers)


@pytest.mark.parametrize(
    ("shape", "told"),
    [([2**30], "are missing"), ([0, 2**40], "cannot have the shape"), ([2**40], "cannot have the shape")],
)
def test_sizes_are_checked_before_anything_is_allocated(tmp_path: Path, shape: list[int], told: str) -> None:
    entry = {"name": "w", "dtype": "<f8", "shape": shape, "sha256": ""}
    assert told in refusal(tmp_path / "s", forged(json.dumps({"header": {}, "arrays": [entry]}).encode()))


def test_a_file_beyond_all_bounds_and_one_that_is_nested_beyond_all_are_refused(tmp_path: Path) -> None:
    assert "not valid JSON" in refusal(tmp_path / "s", forged(b"[" * 200_000))
    os.truncate(tmp_path / "s", layout.LARGEST + 1)
    with pytest.raises(SnapshotError, match="bytes long"):
        read(tmp_path / "s")


def test_the_same_array_twice_is_refused(tmp_path: Path) -> None:
    entry = {"name": "w", "dtype": "<f8", "shape": [0], "sha256": hashlib.sha256().hexdigest()}
    text = json.dumps({"header": {}, "arrays": [entry, entry]}).encode()
    assert "names an array twice" in refusal(tmp_path / "s", forged(text))


def test_somebody_else_can_read_one_from_its_description(file: Path) -> None:
    with file.open("rb") as opened:
        magic, version, length = struct.unpack("<8sII", opened.read(16))
        digest, text = opened.read(32), opened.read(length)
        told = json.loads(text)
        found = {
            it["name"]: np.fromfile(opened, it["dtype"], int(np.prod(it["shape"]))).reshape(it["shape"])
            for it in told["arrays"]
        }
    assert (magic, version) == (b"\x89GVF\r\n\x1a\n", 1)
    assert hashlib.sha256(file.read_bytes()[:16] + text).digest() == digest
    assert told["header"] == SMALL.header
    np.testing.assert_array_equal(found["weights"], SMALL.arrays["weights"])


@pytest.mark.parametrize("call", ["fsync", "replace", "fchmod"])
def test_a_disk_that_fails_leaves_the_old_snapshot_and_no_litter(
    file: Path, monkeypatch: pytest.MonkeyPatch, call: str
) -> None:
    def fail(*_: object) -> None:
        raise OSError(errno.ENOSPC, "full")

    before = file.read_bytes()
    with monkeypatch.context() as patch:
        patch.setattr(os, call, fail)
        with pytest.raises(OSError, match="full"):
            write(file, Snapshot({}, {}), aside=file.with_name("old"))
    assert file.read_bytes() == before
    assert [found.name for found in file.parent.iterdir()] == [file.name]


def test_one_that_cannot_be_written_is_an_error_before_the_old_one_is_touched(file: Path) -> None:
    odd: list[Snapshot] = [
        Snapshot({"x": b"bytes"}, {}),
        Snapshot({}, {"": np.zeros(1)}),
        Snapshot({}, {"complex": np.zeros(1, np.complex128)}),
        Snapshot({}, {"objects": np.array([{}])}),
        Snapshot({}, {"deep": np.zeros((1,) * 9)}),
    ]
    for snapshot in odd:
        with pytest.raises(ValueError, match=r"array|JSON|header"):
            write(file, snapshot)
    assert same(read(file), SMALL)
    assert len(list(file.parent.iterdir())) == 1


def test_files_are_for_the_owner_and_the_group_whatever_the_umask(tmp_path: Path) -> None:
    before = os.umask(0)
    try:
        write(tmp_path / "s", SMALL)
    finally:
        os.umask(before)
    assert (tmp_path / "s").stat().st_mode & 0o777 == MODE


def test_what_a_power_cut_left_behind_is_swept_up_and_nothing_else(file: Path) -> None:
    left = file.with_name(f".{file.name}.a1b2c3d4.new")
    others = [file.with_name(".other.a1b2c3d4.new"), file.with_name(f".{file.name}.more.a1b2c3d4.new")]
    for path in (left, *others):
        path.touch()
    sweep_up(file)
    assert set(file.parent.iterdir()) == {file, *others}
    sweep_up(file.parent / "none" / "s")


def test_what_is_taken_from_learners_tells_what_they_are_asked_and_goes_back_to_them() -> None:
    class Learners:
        def __init__(self) -> None:
            self.known: dict[str, np.ndarray[tuple[int, ...], np.dtype[np.float64]]] = {"w": np.ones(2)}

        def spec(self) -> dict[str, Value]:
            return {"questions": []}

        def memory(self) -> dict[str, np.ndarray[tuple[int, ...], np.dtype[np.float64]]]:
            return self.known

        def recall(self, spec: object, memory: object) -> list[str]:
            assert spec == self.spec()
            assert isinstance(memory, dict)
            self.known = memory
            return ["new"]

    learners, other = Learners(), Learners()
    learners.known = {"w": np.full(2, 7.0)}
    snapshot = taken(learners, "Bento", 1.7e9, 5)
    assert snapshot.spec == {"questions": []}
    assert (snapshot.header["tick"], snapshot.header["wall"]) == (5, 1.7e9)
    assert snapshot.give(other) == ["new"]
    np.testing.assert_array_equal(other.known["w"], [7, 7])
