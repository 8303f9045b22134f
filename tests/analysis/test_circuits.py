"""Trials as the thesis counts them: time, toggles, contacts."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pytest

from bentod.analysis.circuits import Circuit, circuits
from bentod.frames import Event, Frame, GroupFrame, Trial, Value
from bentod.record.reader import Recording
from bentod.record.session import Entry
from tests.analysis.helpers import CONDITIONS, PERIOD, TRIAL_S, frames, record, recorded, session, ticks

START = 100.0


def found(folder: Path, entries: Sequence[Entry]) -> list[Circuit]:
    ordered = sorted(entries, key=lambda entry: entry.time)
    with Recording(record(folder, ordered)) as recording:
        return circuits(recording)


def in_trial(frame: Frame, number: int = 1, condition: str = "dpcc", meta: Value = None) -> Frame:
    return replace(frame, trial=Trial(number, "maze", condition, frame.time), meta=meta)


def trial(first: int, last: int, count: int, number: int = 1) -> list[Frame]:
    """`count` ticks, of which those from `first` to `last` are in a trial."""
    started = Trial(number, "maze", "dpcc", START + first * PERIOD)
    return [replace(f, trial=started) if first <= f.tick <= last else f for f in ticks(count, START)]


def switch(tick: float, joint: str, group: str = "arm") -> Event:
    return Event(
        START + tick * PERIOD, "group", f"somebody switched {group}", {"group": group, "active": joint}
    )


def marked(tick: float, what: str) -> Event:
    return Event(START + tick * PERIOD, "trial", f"marked {what}", {"mark": what})


def test_a_trial_lasts_from_its_first_tick_to_the_first_after_it(tmp_path: Path) -> None:
    (circuit,) = found(tmp_path, trial(10, 39, 60))
    assert circuit.time == pytest.approx(30 * PERIOD)
    assert circuit.start == pytest.approx(START + 10 * PERIOD)
    assert circuit.whole
    assert (circuit.condition, circuit.name, circuit.trial) == ("dpcc", "maze", 1)


def test_toggles_are_changes_of_the_active_joint_within_the_trial(tmp_path: Path) -> None:
    group = (GroupFrame("arm", ("shoulder_rotation", "elbow_flexion"), "shoulder_rotation", 0.0, ""),)
    events = [
        switch(5, "elbow_flexion"),  # before the trial
        switch(9.9, "shoulder_rotation"),
        switch(12, "elbow_flexion"),
        switch(12.1, "elbow_flexion"),  # activated once more: no change
        switch(20, "shoulder_rotation"),
        switch(39.9, "elbow_flexion"),
        switch(40.1, "shoulder_rotation"),  # after it
    ]
    entries = [replace(frame, groups=group) for frame in trial(10, 39, 60)]
    assert found(tmp_path, [*entries, *events])[0].toggles == 3


def test_selecting_all_joints_at_once_and_leaving_them_are_toggles(tmp_path: Path) -> None:
    group = (GroupFrame("arm", ("shoulder_rotation", "elbow_flexion"), "elbow_flexion", 0.0, ""),)
    entries = [replace(frame, groups=group) for frame in trial(10, 39, 60)]
    told = [(12, True), (20, True), (30, False)]
    events = [
        replace(event, data={**event.data, "together": together})
        for tick, together in told
        for event in [switch(tick, "elbow_flexion")]
    ]
    assert found(tmp_path, [*entries, *events])[0].toggles == 2


def test_activating_the_joint_that_was_active_from_the_start_is_no_toggle(tmp_path: Path) -> None:
    group = (GroupFrame("arm", ("shoulder_rotation", "elbow_flexion"), "elbow_flexion", 0.0, ""),)
    entries = [replace(frame, groups=group) for frame in trial(10, 39, 60)]
    assert found(tmp_path, [*entries, switch(20, "elbow_flexion")])[0].toggles == 0


def test_contacts_that_nobody_marks_are_unknown_and_not_none(tmp_path: Path) -> None:
    (circuit,) = found(tmp_path, trial(10, 39, 60))
    assert circuit.contacts is None


def test_contacts_are_marks_and_a_trial_without_any_then_has_none(tmp_path: Path) -> None:
    first = trial(10, 39, 60)
    second = [in_trial(f, 2) if 45 <= f.tick < 55 else f for f in first]
    second = [
        replace(f, trial=replace(f.trial, started=START + 45 * PERIOD))
        if f.trial and f.trial.number == 2
        else f
        for f in second
    ]
    entries: list[Entry] = [*second, marked(15, "contact wall"), marked(16, "contact"), marked(17, "sneezed")]
    assert [circuit.contacts for circuit in found(tmp_path, entries)] == [2, 0]


def test_marks_divide_a_trial_into_circuits_and_the_rest_is_none(tmp_path: Path) -> None:
    entries: list[Entry] = [
        *trial(10, 59, 80),
        marked(20, "circuit"),
        marked(45, "circuit"),
        switch(30, "elbow_flexion"),
    ]
    one, two = found(tmp_path, entries)
    assert [one.time, two.time] == pytest.approx([10 * PERIOD, 25 * PERIOD])
    assert (one.number, two.number, one.toggles, two.toggles) == (1, 2, 0, 1)


def test_a_task_that_is_given_up_in_its_first_circuit_has_no_whole_one(tmp_path: Path) -> None:
    (circuit,) = found(tmp_path, [*trial(10, 39, 60), marked(10, "task waypoints")])
    assert (circuit.whole, circuit.contacts) == (False, 0)


def test_a_circuit_in_which_the_arm_was_paused_counts_and_says_so(tmp_path: Path) -> None:
    entries: list[Entry] = [
        *trial(10, 59, 80),
        marked(10, "task maze"),
        *(marked(tick, "paused") for tick in (12, 14)),
        marked(20, "circuit"),
        marked(21, "unseen"),
        marked(45, "circuit"),
    ]
    assert [circuit.remark for circuit in found(tmp_path, entries)] == ["paused", "unseen"]


def test_a_trial_that_never_ends_is_shown_and_not_counted(tmp_path: Path) -> None:
    (circuit,) = found(tmp_path, trial(10, 60, 60))
    assert not circuit.whole
    assert circuit.remark == "has no end, not counted"


def test_a_fault_and_missing_ticks_are_remarked(tmp_path: Path) -> None:
    entries: list[Entry] = [frame for frame in trial(10, 39, 60) if frame.tick not in (20, 21, 22)]
    entries.append(Event(START + 25 * PERIOD, "fault", "the cable is out", {}))
    (circuit,) = found(tmp_path, entries)
    assert circuit.remark == "fault, 3 ticks missing"


def test_the_participant_is_whom_the_metadata_names_at_that_time(tmp_path: Path) -> None:
    entries = [
        in_trial(f, 1 + f.tick // 20, meta={"participant" if f.tick < 20 else "subject": f"P{f.tick // 20}"})
        for f in ticks(60, START)
    ]
    started = [
        replace(f, trial=Trial(f.trial.number, "", "", START + (f.trial.number - 1) * 20 * PERIOD))
        for f in entries
        if f.trial
    ]
    assert [circuit.participant for circuit in found(tmp_path, started)] == ["P0", "P1", "P2"]


def test_without_a_participant_the_session_stands_for_one(tmp_path: Path) -> None:
    (circuit,) = found(tmp_path, trial(10, 39, 60))
    assert circuit.participant == circuit.session


def test_a_session_of_the_daemon_has_its_trials(tmp_path_factory: pytest.TempPathFactory) -> None:
    with Recording(recorded(tmp_path_factory.getbasetemp())) as recording:
        seen = circuits(recording)
    assert [circuit.condition for circuit in seen] == list(CONDITIONS)
    assert [circuit.time for circuit in seen] == pytest.approx([TRIAL_S] * 6, abs=PERIOD * 1.01)
    assert {circuit.participant for circuit in seen} == {"P7"}
    assert {circuit.timescale for circuit in seen} == {20.0}
    for circuit in seen:  # by the counter of the muscles, which alone toggle here
        inside = [f.emg.toggles for f in frames(session()) if f.trial and f.trial.number == circuit.trial]
        assert abs(circuit.toggles - (inside[-1] - inside[0])) <= 1
    assert sum(circuit.toggles for circuit in seen) > 6
