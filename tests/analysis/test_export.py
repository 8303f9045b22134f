"""What is exported equals what was recorded, cell by cell, and explains itself."""

import csv
import json
import math
import sys
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest
from rosbags.rosbag2 import Reader
from rosbags.typesys import Stores, get_typestore

from bentod.analysis import parquet
from bentod.analysis.columns import COMMANDS, EVENTS, Cell, TickColumns, command_row, event_row
from bentod.analysis.export import DICTIONARY, Documented, export
from bentod.analysis.extras import MissingExtra
from bentod.analysis.stream import TABLES
from bentod.errors import BadRequest, Refused
from bentod.frames import ClientCommand, Event
from bentod.record.reader import Recording
from tests.analysis.helpers import blocks, excerpt, frames, header, record, samples, ticks

Table = Mapping[str, Sequence[Cell]]
Whole = Callable[[str], tuple[Path, Mapping[str, int]]]


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return record(tmp_path_factory.mktemp("recordings"), excerpt())


@pytest.fixture(scope="module")
def whole(file: Path, tmp_path_factory: pytest.TempPathFactory) -> Whole:
    """Every table in a format: its folder, and the rows it was said to have. For who only reads it."""

    @cache
    def made(kind: str) -> tuple[Path, Mapping[str, int]]:
        out = tmp_path_factory.mktemp(kind) / "out"
        return out, exported(file, kind, out)

    return made


def exported(file: Path, kind: str, out: Path, tables: Sequence[str] = TABLES) -> Mapping[str, int]:
    with Recording(file) as recording:
        return export(recording, kind, out, tables)


@cache
def expected_ticks() -> Table:
    known = [spec.name for spec in header(excerpt()).joints]
    columns = TickColumns(known, frames(excerpt())[:500])
    cells = columns.cells(frames(excerpt()))
    return {column.name: list(values) for column, values in zip(columns.columns, cells, strict=True)}


def expected_rows() -> Mapping[str, list[tuple[Cell, ...]]]:
    return {
        "events": [event_row(entry) for entry in excerpt() if isinstance(entry, Event)],
        "commands": [command_row(entry) for entry in excerpt() if isinstance(entry, ClientCommand)],
    }


def wanted_kinds() -> Mapping[str, str]:
    known = [spec.name for spec in header(excerpt()).joints]
    return {c.name: c.kind for c in TickColumns(known, frames(excerpt())[:500]).columns}


@cache
def expected_samples() -> np.ndarray:
    return np.concatenate([samples(block) for block in blocks(excerpt())])


def same(found: Cell, expected: Cell) -> bool:
    both_nan = (
        isinstance(found, float)
        and isinstance(expected, float)
        and math.isnan(found)
        and math.isnan(expected)
    )
    return both_nan or ((found == expected and type(found) is not bool) or found is expected)


def test_parquet_holds_every_cell_of_every_table(whole: Whole) -> None:
    out, rows = whole("parquet")
    table = pq.read_table(out / "ticks.parquet")
    wanted = expected_ticks()
    assert table.column_names == list(wanted)
    for name, values in wanted.items():
        found = table[name].to_pylist()
        assert all(map(same, found, values)), name
    assert rows["ticks"] == table.num_rows == len(frames(excerpt()))
    for columns, name in ((EVENTS, "events"), (COMMANDS, "commands")):
        read = pq.read_table(out / f"{name}.parquet")
        assert [tuple(row.values()) for row in read.to_pylist()] == expected_rows()[name]
        assert read.column_names == [column.name for column in columns]


def test_emg_keeps_every_bit_and_the_index_of_each_sample(file: Path, tmp_path: Path) -> None:
    exported(file, "parquet", tmp_path / "out", ["emg"])
    table = pq.read_table(tmp_path / "out" / "emg.parquet")
    volts = np.stack([table[f"channel_{number}_v"].to_numpy() for number in range(3)], axis=1)
    assert volts.dtype == np.float32
    assert volts.tobytes() == expected_samples().tobytes()
    index = [b.first_index + k for b in blocks(excerpt()) for k in range(len(b.samples))]
    assert table["index"].to_pylist() == index
    first = table.filter(table["block"])
    assert first["time_s"].to_pylist() == [block.time for block in blocks(excerpt())]
    assert first["dropped"].to_pylist() == [block.dropped for block in blocks(excerpt())]
    assert table["time_s"][1].as_py() == pytest.approx(blocks(excerpt())[0].time + 1 / 200)
    assert [path.name for path in sorted((tmp_path / "out").iterdir())] == [DICTIONARY, "emg.parquet"]


def test_csv_holds_every_cell(whole: Whole) -> None:
    out, _ = whole("csv")
    with (out / "ticks.csv").open(newline="", encoding="utf-8") as lines:
        head, *rows = csv.reader(lines)
    wanted = expected_ticks()
    assert head == list(wanted)
    for name, found in zip(head, zip(*rows, strict=True), strict=True):
        numeric = wanted_kinds()[name] == "float"
        told = ["" if v is None else str(float(v) if numeric else v) for v in wanted[name]]
        assert list(found) == told, name
    with (out / "emg.csv").open(newline="", encoding="utf-8") as lines:
        emg = list(csv.DictReader(lines))
    volts = [[row[f"channel_{number}_v"] for number in range(3)] for row in emg]
    assert np.array(volts, dtype=np.float32).tobytes() == expected_samples().tobytes()
    assert float(emg[0]["time_s"]) == blocks(excerpt())[0].time
    with (out / "commands.csv").open(newline="", encoding="utf-8") as lines:
        assert [row["client"] for row in csv.DictReader(lines)] == ["joy <&> \x1b[31m", "nobody"]


def test_npz_holds_every_cell_and_needs_numpy_only(
    file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for missing in ("pyarrow", "pyarrow.parquet", "matplotlib", "rosbags"):
        monkeypatch.setitem(sys.modules, missing, None)
    exported(file, "npz", tmp_path / "out")
    with np.load(tmp_path / "out" / "ticks.npz") as ticks_file:
        for name, values in expected_ticks().items():
            array = ticks_file[name]
            absent = {"f": math.nan, "i": -1, "b": False, "U": ""}[array.dtype.kind]
            wanted = np.array([absent if v is None else v for v in values], dtype=array.dtype)
            assert np.array_equal(array, wanted, equal_nan=array.dtype.kind == "f"), name
    with np.load(tmp_path / "out" / "emg.npz") as emg:
        assert emg["channel_2_v"].tobytes() == np.ascontiguousarray(expected_samples()[:, 2]).tobytes()


def test_a_ros_bag_is_read_back_by_rosbags(file: Path, tmp_path: Path) -> None:
    counts = exported(file, "rosbag2", tmp_path / "out")
    store = get_typestore(Stores.ROS2_JAZZY)
    found: dict[str, list[object]] = {}
    stamps: list[int] = []
    with Reader(tmp_path / "out") as bag:
        for connection, stamp, data in bag.messages():
            found.setdefault(connection.topic, []).append(store.deserialize_cdr(data, connection.msgtype))
            if connection.topic == "/bentod/frame":
                stamps.append(stamp)
    states = found["/joint_states"]
    assert len(states) == counts["ticks"] == len(frames(excerpt()))
    for state, frame in zip(states, frames(excerpt()), strict=True):
        assert list(state.name) == [joint.name for joint in frame.joints]  # type: ignore[attr-defined]
        assert list(state.position) == [joint.position for joint in frame.joints]  # type: ignore[attr-defined]
    arrays = [m.data for m in found["/bentod/emg"]]  # type: ignore[attr-defined]
    assert np.concatenate(arrays).tobytes() == expected_samples().tobytes()
    events = [json.loads(m.data)["text"] for m in found["/bentod/events"]]  # type: ignore[attr-defined]
    assert events == [entry.text for entry in excerpt() if isinstance(entry, Event)]
    told = json.loads(found["/bentod/frame"][300].data)  # type: ignore[attr-defined]
    assert told["joints"][0]["predictions"] == dict(frames(excerpt())[300].joints[0].predictions)
    about = header(excerpt())
    assert stamps[0] == round((frames(excerpt())[0].time - about.started + about.started_wall) * 1e9)


@pytest.mark.parametrize("kind", ["parquet", "csv", "npz"])
def test_the_dictionary_explains_every_column(whole: Whole, kind: str) -> None:
    out, rows = whole(kind)
    told = json.loads((out / DICTIONARY).read_text(encoding="utf-8"))
    assert {name: table["rows"] for name, table in told["tables"].items()} == rows
    columns = {column["name"]: column for column in told["tables"]["ticks"]["columns"]}
    assert list(columns) == list(expected_ticks())
    assert columns["elbow_flexion.velocity_rad_s"]["unit"] == "rad/s"
    assert all(column["meaning"] for column in columns.values())
    assert told["started_s"] == header(excerpt()).started


def test_parquet_files_carry_units_themselves(whole: Whole) -> None:
    schema = pq.read_schema(whole("parquet")[0] / "ticks.parquet")
    assert schema.field("elbow_flexion.position_rad").metadata[b"unit"] == b"rad"
    assert json.loads(schema.metadata[b"bentod"])["session"] == header(excerpt()).session


def test_a_table_without_rows_is_there_with_its_columns(tmp_path: Path) -> None:
    exported(record(tmp_path, ticks(3)), "parquet", tmp_path / "out")
    assert pq.read_table(tmp_path / "out" / "commands.parquet").num_rows == 0
    assert pq.read_schema(tmp_path / "out" / "emg.parquet").names == ["index", "time_s", "block", "dropped"]


def test_nothing_is_overwritten(file: Path, tmp_path: Path) -> None:
    (tmp_path / "out").mkdir()
    with pytest.raises(Refused, match="exists already"):
        exported(file, "csv", tmp_path / "out")


def test_an_export_that_fails_leaves_nothing(
    file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Documented, "save", full)
    with pytest.raises(OSError, match="No space"):
        exported(file, "csv", tmp_path / "out")
    assert list(tmp_path.iterdir()) == []


def test_an_unknown_topic_is_told_with_the_nearest(file: Path, tmp_path: Path) -> None:
    with pytest.raises(BadRequest, match="did you mean 'events'"):
        exported(file, "csv", tmp_path / "out", ["event"])


@pytest.mark.parametrize(("kind", "package"), [("parquet", "pyarrow"), ("rosbag2", "rosbags")])
def test_what_is_not_installed_is_named_with_the_extra_that_brings_it(
    file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, kind: str, package: str
) -> None:
    for name in list(sys.modules):
        if name.partition(".")[0] == package or name in ("bentod.analysis.parquet", "bentod.analysis.rosbag"):
            monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(MissingExtra, match=rf"'{package}.*bentod\[analysis\]"):
        exported(file, kind, tmp_path / "out")


def test_a_long_recording_is_exported_batch_by_batch(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("bentod.analysis.stream.BATCH", 256)
    many = ticks(625)  # two batches and a part of one
    exported(record(tmp_path, many), "npz", tmp_path / "out", ["ticks"])
    with np.load(tmp_path / "out" / "ticks.npz") as found:
        assert found["tick"].tolist() == [frame.tick for frame in many]
        assert set(found["mode"].tolist()) == {many[0].mode.value}


@pytest.mark.real_time
def test_several_processes_write_what_one_does(
    file: Path, whole: Whole, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    one, rows = whole("parquet")
    monkeypatch.setattr(parquet, "SLICE_S", 10.0)
    assert exported(file, "parquet", tmp_path / "several") == rows
    once, sliced = (pq.read_table(folder / "ticks.parquet") for folder in (one, tmp_path / "several"))
    assert sliced.equals(once, check_metadata=True)
