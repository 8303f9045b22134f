"""The numbers behind the figures, by hand and against slow versions."""

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bentod.analysis import numbers
from bentod.analysis.material import Material, gather
from bentod.analysis.setup import setup
from bentod.analysis.stream import UnfitRecording
from bentod.frames import EmgBlock, Frame, JointFrame
from bentod.learn.returns import ideal_predictions
from bentod.record.reader import Recording
from bentod.record.session import Entry
from tests.analysis.helpers import PERIOD, record, ticks


def material(folder: Path, entries: Sequence[Entry]) -> Material:
    with Recording(record(folder, entries)) as recording:
        return gather(recording)


def elbow(frame: Frame, **changes: object) -> Frame:
    joint: JointFrame = replace(frame.joints[1], **changes)  # type: ignore[arg-type]
    return replace(frame, joints=(frame.joints[0], joint, *frame.joints[2:]))


def path(positions: Sequence[float], holders: Sequence[str] = (), scale: str = "20") -> list[Frame]:
    told = [*holders, *[""] * (len(positions) - len(holders))]
    return [
        elbow(frame, position=position, holder=holder, predictions={scale: 0.0})
        for frame, position, holder in zip(ticks(len(positions)), positions, told, strict=True)
    ]


def test_the_way_from_one_tick_to_the_next_is_his_who_won_in_the_first(tmp_path: Path) -> None:
    found = material(tmp_path, path([0.0, 0.5, 0.25, 0.25, 1.25], ["emg", "assist", "emg", "client:joy"]))
    ways = numbers.way_by_holder(found)["elbow_flexion"]
    assert ways == pytest.approx({"emg": 0.5, "assist": 0.25, "client:joy": 1.0})


def test_a_way_across_missing_ticks_is_nobodys(tmp_path: Path) -> None:
    frames = path([0.0, 0.5, 2.5, 2.75], ["emg"] * 4)
    late = [replace(frame, tick=frame.tick + 7, time=frame.time + 7 * PERIOD) for frame in frames[2:]]
    ways = numbers.way_by_holder(material(tmp_path, [*frames[:2], *late]))["elbow_flexion"]
    assert ways == pytest.approx({"emg": 0.75, numbers.UNKNOWN: 2.0})


def test_the_ideal_is_the_return_and_unknown_near_the_end(tmp_path: Path) -> None:
    positions = np.sin(np.arange(80) / 9)
    found = material(tmp_path, path(positions.tolist(), scale="4"))
    ideal = numbers.ideal(found, "elbow_flexion", 4.0)
    assert ideal[:60] == pytest.approx(ideal_predictions(positions, 4.0)[:60])
    assert np.isnan(ideal[60:]).all()
    error = numbers.prediction_errors(found)["elbow_flexion"]["4"]
    assert error == pytest.approx(math.sqrt(np.mean(ideal[:60] ** 2)))


def test_no_return_reaches_across_missing_ticks(tmp_path: Path) -> None:
    frames = path([0.0] * 40 + [1.0] * 40, scale="2")
    late = [replace(frame, tick=frame.tick + 1) for frame in frames[40:]]
    ideal = numbers.ideal(material(tmp_path, [*frames[:40], *late]), "elbow_flexion", 2.0)
    assert np.nanmax(ideal[:40]) == 0.0
    assert np.isnan(ideal[30:40]).all()


def test_a_thinned_curve_keeps_its_peaks_and_its_order() -> None:
    x = np.arange(100_000.0)
    y = np.sin(x / 5000)
    y[77_777], y[123] = 40.0, -40.0
    thin_x, thin_y = numbers.thin(x, y, 500)
    assert len(thin_x) <= 502
    assert (np.diff(thin_x) > 0).all()
    assert (thin_y.max(), thin_y.min()) == (40.0, -40.0)
    assert (thin_y == y[thin_x.astype(int)]).all()


def test_a_short_curve_is_left_alone() -> None:
    x = np.arange(10.0)
    assert numbers.thin(x, x, 500)[1].tolist() == x.tolist()


def test_where_nothing_is_a_number_a_thinned_curve_breaks() -> None:
    y = np.arange(1000.0)
    y[400:600] = np.nan
    assert np.isnan(numbers.thin(np.arange(1000.0), y, 20)[1]).any()


def test_equal_values_are_one_stretch() -> None:
    found = numbers.stretches(np.array([0.0, 1.0, 2.0, 3.0]), [5, 5, 7, 7])
    assert found == [(0.0, 2.0, 5), (2.0, 3.0, 7)]
    assert numbers.stretches(np.array([]), []) == []


def test_a_level_is_the_mean_absolute_value_that_the_controller_weighs(tmp_path: Path) -> None:
    blocks = [
        EmgBlock(10 * n, 100 + n * 0.05, np.full((10, 3), (-1) ** n * 2e-5, dtype=np.float32))
        for n in range(20)
    ]
    levels = material(tmp_path, [*blocks, *ticks(30)]).levels
    assert levels is not None
    assert levels.volts[1:] == pytest.approx(np.full((19, 3), 2e-5))
    assert levels.time == pytest.approx([100 + n * 0.05 for n in range(20)])


def test_levels_do_not_reach_across_missing_samples(tmp_path: Path) -> None:
    loud = EmgBlock(0, 100.0, np.full((10, 3), 1.0, dtype=np.float32))
    after = EmgBlock(5000, 125.0, np.full((4, 3), 0.0, dtype=np.float32), 4990)
    levels = material(tmp_path, [loud, after, *ticks(30)]).levels
    assert levels is not None
    assert np.isnan(levels.volts[-1]).all()  # four samples of ten are no window yet


def test_a_recording_without_ticks_has_nothing_to_show(tmp_path: Path) -> None:
    block = EmgBlock(0, 100.0, np.zeros((10, 3), dtype=np.float32))
    with pytest.raises(UnfitRecording, match="holds no tick"):
        material(tmp_path, [block])


def test_a_config_that_cannot_be_read_says_nothing() -> None:
    assert setup("[emg").sites == ()
    assert setup("emg = 3\n[learn]\njoints = 7\n[assist]\ntimescale = 'x'").assist_timescale == 20.0
    assert setup("[emg]\nrate_hz = 1000\n[[emg.sites]]\nname = 'a'\nchannel = 2").sites[0].channel == 2
