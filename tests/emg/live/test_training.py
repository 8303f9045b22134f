"""Another process aligns and trains; what it is given and what it says is plain data."""

import asyncio
from pathlib import Path

import numpy as np
import pytest

from bentod.emg.classify import model_file
from bentod.emg.classify.labelled_files import read
from bentod.emg.live import workshop
from bentod.emg.live.alignment import aligned, labelled
from bentod.emg.live.carrying_out import carried_out, session_arrays, session_of
from bentod.emg.live.lessons import Lessons
from bentod.emg.live.orders import ORDER, Keep, Learn, written
from bentod.emg.live.training_file import add, saved
from bentod.errors import InputFileError, Refused
from tests.emg.live.signals import FILTERS, LABELS, RATE_HZ, SETTING, TABLE, session


def keep(folder: Path, more: bool = True) -> Keep:
    saved(folder / "raw.npz", session_arrays(session()))
    return Keep(
        session=str(folder / "raw.npz"),
        data=str(folder / "training.npz"),
        filters=FILTERS,
        add=more,
        condition="sitting",
    )


def learn(folder: Path) -> Learn:
    return Learn(
        data=str(folder / "training.npz"), out=str(folder / "model.model"), table=TABLE, filters=FILTERS
    )


def test_orders_come_back_as_they_were_given(tmp_path: Path) -> None:
    for order in (keep(tmp_path), learn(tmp_path)):
        assert ORDER.validate_json(written(order)) == order


def test_a_session_is_handed_over_bit_for_bit() -> None:
    found = session_of(session_arrays(session()))
    assert found.prompts == session().prompts
    assert found.rate_hz == RATE_HZ
    assert np.array_equal(found.samples, session().samples)


def test_what_is_kept_and_trained_recognises_repetitions_that_it_was_not_trained_on(tmp_path: Path) -> None:
    kept = carried_out(keep(tmp_path))
    assert kept["sessions"] == 1
    told = carried_out(learn(tmp_path))
    assert isinstance(told["accuracy"], float)
    assert told["accuracy"] > 0.9
    model = model_file.read(tmp_path / "model.model")
    assert model.labels == tuple(sorted(("rest", *LABELS)))
    assert model.differences(SETTING) == []
    assert model.training["accuracy"] == told["accuracy"]


def test_new_repetitions_are_numbered_after_the_old_and_prompts_stay_beside_labels(tmp_path: Path) -> None:
    assert carried_out(keep(tmp_path))["sessions"] == 1
    assert carried_out(keep(tmp_path))["sessions"] == 2
    found = read(tmp_path / "training.npz")
    assert [sorted(set(piece.repetitions.tolist())) for piece in found.pieces] == [[0, 1, 2], [3, 4, 5]]
    assert set(found.pieces[0].conditions) == {"sitting"}
    with np.load(tmp_path / "training.npz", allow_pickle=False) as file:
        assert (file["prompted"] != file["labels"]).any()
        assert set(file["prompted"]) == {"rest", *LABELS}
    assert carried_out(keep(tmp_path, more=False))["sessions"] == 1


def test_the_oldest_sessions_go_when_there_is_no_room(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("bentod.emg.live.training_file.MOST_VALUES", int(1.5 * session().samples.size))
    carried_out(keep(tmp_path))
    told = carried_out(keep(tmp_path))
    assert told["sessions"] == 1
    assert told["warnings"] == ["The oldest sessions had to go for want of room: 1."]


def test_sessions_of_other_channels_or_rates_do_not_mix(tmp_path: Path) -> None:
    carried_out(keep(tmp_path))
    piece, prompted = labelled(session(), aligned(session(), FILTERS), "")
    with pytest.raises(InputFileError, match="holds 8 channels at 1000 Hz; here there are 8 at 500 Hz"):
        add(tmp_path / "training.npz", piece, prompted, 500.0, keep=True)


@pytest.mark.real_time
async def test_a_process_of_its_own_carries_out_orders_and_tells_what_is_wrong(tmp_path: Path) -> None:
    lessons = Lessons(tmp_path, TABLE, FILTERS)
    with pytest.raises(Refused, match="nothing has been collected"):
        await lessons.train("model")
    kept = await asyncio.gather(lessons.keep(session(), True, ""), lessons.keep(session(), True, ""))
    assert sorted(str(told["sessions"]) for told in kept) == ["1", "2"]  # what was made is never refused
    assert [path.name for path in tmp_path.iterdir()] == ["training.npz"]
    trained, busy = await asyncio.gather(
        lessons.train("model"), lessons.train("model"), return_exceptions=True
    )
    assert isinstance(trained, dict)
    assert trained["sessions"] == 2
    assert isinstance(busy, Refused)
    assert (await lessons.load("model")).kind == "lda"
    (tmp_path / "training.npz").write_bytes(b"garbage")
    with pytest.raises(Refused, match=r"training\.npz"):
        await lessons.train("model")
    assert lessons.models() == ["model"]


@pytest.mark.real_time
async def test_a_session_whose_process_dies_is_not_lost(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(workshop, "WORKER", "bentod.nowhere")
    with pytest.raises(Refused, match="raw session is in"):
        await Lessons(tmp_path, TABLE, FILTERS).keep(session(), True, "")
    (left,) = tmp_path.iterdir()
    with np.load(left) as file:
        assert np.array_equal(file["emg"], session().samples, equal_nan=True)


def test_a_folder_that_cannot_be_is_told_before_anything_is_collected(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(Refused, match="nothing can be kept"):
        Lessons(tmp_path / "file" / "muscles", TABLE, FILTERS).prepare()


@pytest.mark.real_time
async def test_whoever_waits_no_longer_leaves_no_process_behind(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    started: list[asyncio.subprocess.Process] = []
    start = asyncio.create_subprocess_exec

    async def noticed(*args: str, stdin: int, stdout: int, stderr: int) -> asyncio.subprocess.Process:
        started.append(await start(*args, stdin=stdin, stdout=stdout, stderr=stderr))
        return started[-1]

    monkeypatch.setattr(asyncio, "create_subprocess_exec", noticed)
    task = asyncio.create_task(workshop.in_a_process(keep(tmp_path)))
    while not started:  # noqa: ASYNC110 -- there is no event for a process that starts
        await asyncio.sleep(0.01)
    task.cancel()
    with pytest.raises(asyncio.CancelledError):
        await task
    assert started[0].returncode is not None
