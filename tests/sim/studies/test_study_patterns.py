"""The study of patterns: its data, its scores, its answers, and what it tells."""

import csv
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result

from bentod.emg.classify.kinds import trainer
from bentod.emg.classify.nearest import Nearest
from bentod.emg.recognition import REST
from bentod.errors import InputFileError
from sim.movement_signals import Moving
from sim.movements import LOADS, MOVEMENTS, Prompted
from sim.studies import command, patterns_answers, patterns_people, patterns_sweep, study_patterns
from sim.studies.patterns import (
    CLASSIFIERS,
    RATE_HZ,
    SEGMENTING,
    background,
    generated,
    nearest,
    random_splits,
    repetition_splits,
    whole,
)
from sim.studies.patterns_answers import ANSWERS, BASE, HARDER, Ask
from sim.studies.patterns_people import LEFT_OUT, RANDOM, REPETITIONS, SPREAD, Key, Order
from sim.studies.patterns_real import listing
from sim.studies.patterns_recordings import conditions
from sim.studies.patterns_sets import SETS, SINGLE, TD_AR
from sim.studies.patterns_tables import answer_claims, claims, rank
from sim.studies.study import Trials

SHORT = Prompted(person=3, repetitions=2, hold_s=1.0, rest_s=1.0)
MYO = Path(__file__).parents[4] / "shared" / "data" / "libemg_myo_200hz.npz"


def test_each_window_lies_in_one_thing_and_rest_is_no_more_frequent_than_a_movement() -> None:
    made = Moving(SHORT, RATE_HZ)
    every, fair = whole(made), generated(SHORT)
    assert set(every.labels) == {REST, *MOVEMENTS}
    counts = {label: int(np.sum(fair.labels == label)) for label in (REST, *MOVEMENTS)}
    assert counts[REST] == pytest.approx(np.mean([counts[name] for name in MOVEMENTS]), rel=0.2)
    assert np.sum(every.labels == REST) > 3 * counts[REST]
    inside = sum(max(0, (p.release - p.onset - SEGMENTING.length) // SEGMENTING.step) for p in made.prompts)
    assert np.sum(every.labels != REST) == pytest.approx(inside, abs=len(made.prompts))
    assert set(every.repetitions) == {0, 1}


def test_splits_cover_everything_and_share_nothing() -> None:
    for train, test in random_splits(100, 3, 1):
        assert sorted([*train, *test]) == list(range(100))
        assert len(test) == 20
    repetitions = np.array([0, 1, 0, 2, 1])
    parts = list(repetition_splits(repetitions))
    assert [test.tolist() for _, test in parts] == [[0, 2], [1, 4], [3]]
    assert all(not set(train) & set(test) for train, test in parts)


def test_the_background_is_what_a_channel_has_at_rest() -> None:
    random = np.random.default_rng(0)
    gains = np.where(np.arange(400) % 120 < 60, 0.2, 1.0)
    windows = gains[:, np.newaxis, np.newaxis] * random.standard_normal((400, 2, 150))
    np.testing.assert_allclose(background(windows)[240:], 0.04, rtol=0.25)


def test_neighbours_of_all_rows_at_once_are_those_of_each_row() -> None:
    random = np.random.default_rng(0)
    rows = random.standard_normal((200, 6))
    labels = np.where(rows[:, 0] > 0, "a", "b").tolist()
    found = trainer("knn")(rows, labels, {}, 0)
    assert isinstance(found, Nearest)
    asked = random.standard_normal((50, 6))
    np.testing.assert_array_equal(nearest(found, asked), found.probabilities(asked))


@pytest.fixture(scope="module")
def one() -> Mapping[Key, float]:
    return patterns_people.play(Order(11, 2, 2, (TD_AR, "Ratios"), ("KNN", "LDA")))


def test_a_person_is_told_apart_without_a_load_and_not_with_one(one: Mapping[Key, float]) -> None:
    for which in ("KNN", "LDA"):
        assert one[TD_AR, which, RANDOM] > 0.9
        assert one[TD_AR, which, "15 lb"] < one[TD_AR, which, RANDOM] - 0.2
        assert one[TD_AR, which, REPETITIONS] <= one[TD_AR, which, RANDOM]
    assert (("Ratios", "LDA", REPETITIONS) in one) == ("Ratios" in LEFT_OUT)


def test_a_person_does_the_same_again_whoever_else_takes_part(one: Mapping[Key, float]) -> None:
    order = Order(11, 2, 2, ("Ratios",), ("LDA",))
    alone = patterns_people.everybody(patterns_people.play, [order])[0]
    assert all(one[key] == value for key, value in alone.items())


def test_tonic_contractions_and_robust_features_help_a_person_whom_they_were_not_chosen_for() -> None:
    found = patterns_answers.play(Ask(12345, 2, (BASE, "robust + tonic")))
    gain = [found["robust + tonic", load] - found[BASE, load] for load in LOADS[1:]]
    assert np.mean(gain) > 0.05
    assert found["robust + tonic", "unloaded"] > 0.9


def test_answers_may_normalise_track_the_rest_or_have_another_classifier() -> None:
    names = tuple(
        name for name, one in ANSWERS.items() if one.normalised or one.tracked or one.classifier != "lda"
    )
    found = patterns_answers.play(Ask(5, 1, names, {"unloaded": {}}))
    assert {answer for answer, _ in found} == set(names)
    assert len(names) == 5
    assert all(share > 0.3 for share in found.values())


def test_the_sweep_tries_the_parameters_that_the_thesis_chose() -> None:
    for grid in (patterns_sweep.QUICK, patterns_sweep.WHOLE):
        assert set(grid) == set(SINGLE)
        for name, values in grid.items():
            usual = SINGLE[name]
            assert all(usual.get(key, 1) in chosen for key, chosen in values.items())


def scores(loaded: float) -> dict[Key, float]:
    """Somebody for whom every classifier is right as often, and the ratios a little more often."""
    made: dict[Key, float] = {}
    for name in SETS:
        better = 0.05 if name == "Ratios" else 0.0
        for which in CLASSIFIERS:
            made |= {(name, which, RANDOM): 0.95, (name, which, SPREAD): 0.01}
            made |= {(name, which, load): loaded + better for load in LOADS[1:]}
            made[name, which, "5 lb"] += 0.1
            if name in LEFT_OUT:
                made[name, which, REPETITIONS] = 0.9
    return made


def answered(gain: float) -> dict[tuple[str, str], float]:
    tests = [*LOADS, *HARDER]
    made = {(name, test): 0.5 for name in ANSWERS for test in tests}
    return (
        made
        | {(name, "unloaded"): 0.95 for name in ANSWERS}
        | {("robust + tonic", load): 0.5 + gain for load in LOADS[1:]}
    )


def test_the_pattern_of_the_thesis_holds_every_claim_and_its_absence_does_not() -> None:
    assert [claim.row for claim in claims([scores(0.4)]) if not claim.holds] == []
    assert rank([scores(0.4)]) == 1
    lost = [claim.text for claim in claims([scores(0.93)]) if not claim.holds]
    assert any("15 lb" in text for text in lost)


def test_the_answer_must_bring_ten_points() -> None:
    good, poor = (
        [claim.holds for claim in answer_claims([answered(0.2)], [answered(g)])] for g in (0.15, 0.05)
    )
    assert good == [True, True]
    assert poor == [False, True]


def test_an_answer_that_costs_too_much_without_a_load_is_not_chosen() -> None:
    found = answered(0.2) | {("robust + tonic", "unloaded"): 0.9}
    assert patterns_answers.chosen([answered(0.2)]) == "robust + tonic"
    assert patterns_answers.chosen([found]) != "robust + tonic"


def archive(path: Path, **change: object) -> Path:
    """Two classes on two channels, three repetitions in each of two conditions, 200 Hz."""
    random = np.random.default_rng(1)
    told = [(cls, rep, held) for held in ("free", "held") for rep in range(3) for cls in (0, 1)]
    gains = {0: (1e-4, 1e-5), 1: (1e-5, 1e-4)}
    emg = np.concatenate([random.standard_normal((200, 2)) * gains[cls] for cls, _, _ in told])
    arrays = {
        "emg": emg,
        "fs": 200.0,
        "length": np.full(len(told), 200),
        "cls": np.array([cls for cls, _, _ in told]),
        "rep": np.array([rep for _, rep, _ in told]),
        "condition": np.array([held for _, _, held in told]),
    }
    np.savez(path, **{**arrays, **change})  # type: ignore[arg-type]
    return path


def test_a_recording_is_tried_within_and_across_its_conditions(tmp_path: Path) -> None:
    told = listing(1, archive(tmp_path / "mine.npz"), 2, 1)
    head, *rows = told.rows
    assert [row[:2] for row in rows] == [
        ("free", "the same, 80/20"),
        ("free", "the same, a repetition left out"),
        ("held", "the same, 80/20"),
        ("held", "the same, a repetition left out"),
        ("free", "held"),
        ("held", "free"),
    ]
    assert all(float(cell) > 90 for row in rows for cell in row[2:])
    assert len(head) == len(rows[0])


def test_a_folder_of_intensities_is_read_by_the_names_of_its_files(tmp_path: Path) -> None:
    random = np.random.default_rng(0)
    for condition in ("20P", "80P"):
        for label in (1, 2):
            for repetition in (1, 2):
                name = f"S1_{condition}_C{label}_R{repetition}.csv"
                np.savetxt(tmp_path / name, random.standard_normal((400, 2)), delimiter=",")
    found = conditions(tmp_path)
    assert list(found) == ["20P", "80P"]
    assert set(found["20P"].labels) == {"class_1", "class_2"}
    assert set(found["20P"].repetitions) == {1, 2}
    assert found["20P"].rate_hz == 1000.0


def test_a_folder_without_such_files_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputFileError, match="no file named like"):
        conditions(tmp_path)


@pytest.mark.skipif(not MYO.exists(), reason="the recording is not here")
def test_an_armband_that_was_moved_is_a_ready_recording() -> None:
    found = conditions(MYO)
    (data,) = found.values()
    assert set(data.repetitions) == {0, 1, 2, 3}
    assert len(set(data.labels)) == 5


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """Everything but the work."""
    monkeypatch.setattr(patterns_people, "play", lambda _: scores(0.4))
    monkeypatch.setattr(patterns_answers, "play", lambda _: answered(0.15))
    tried = patterns_sweep.Tried("MAV", {"name": "mav", "segments": 10}, {"KNN": 0.9, "LDA": 0.8})
    monkeypatch.setattr(study_patterns, "sweep", lambda *_: [tried])


def run(*arguments: object) -> Result:
    return CliRunner().invoke(command.study, [str(argument) for argument in arguments])


@pytest.mark.usefixtures("quick")
def test_the_study_tells_its_claims_figures_and_tables_and_that_it_is_no_evidence(tmp_path: Path) -> None:
    recording = archive(tmp_path / "mine.npz")
    result = run("patterns", "--operators", 2, "--recording", recording, "--out", tmp_path / "out")
    assert result.exit_code == 0, result.output
    assert "no evidence about people" in result.stdout
    assert "overlapping windows leak" in result.stdout
    names = {path.name for path in (tmp_path / "out").iterdir()}
    for figure in ("3-4", "3-5a", "3-5b", "3-6"):
        assert f"figure-{figure}.png" in names
    assert {"answers.csv", "harder.csv", "sweep.csv", "recording-1.csv", "comparison.csv"} <= names
    with (tmp_path / "out" / "sweep.csv").open(encoding="utf-8", newline="") as file:
        (row,) = csv.DictReader(file)
    assert row["Table 3.2"] == "yes"
    html = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert "bentod study patterns --seed 1 --operators 2 --recording" in html


def test_people_for_whom_answers_are_chosen_are_not_those_on_whom_they_are_shown(
    monkeypatch: pytest.MonkeyPatch, quick: None
) -> None:
    asked: list[int] = []

    def play(ask: Ask) -> dict[tuple[str, str], float]:
        if len(ask.tests) == len(LOADS):
            asked.append(ask.person)
        return answered(0.15)

    monkeypatch.setattr(patterns_answers, "play", play)
    study_patterns.run(1, Trials(people=3))
    assert len(asked) == len(set(asked)) == 16


def test_what_means_nothing_to_a_study_is_refused(tmp_path: Path) -> None:
    result = run("patterns", "--minutes", 3, "--out", tmp_path / "none")
    assert result.exit_code == 1
    assert "knows neither --minutes" in result.stderr
    result = run("cliffs", "--sweep", "--out", tmp_path / "none")
    assert result.exit_code == 1
    assert "--sweep means nothing" in result.stderr
    assert not (tmp_path / "none").exists()


@pytest.mark.usefixtures("quick")
def test_a_recording_that_is_not_there_is_a_sentence(tmp_path: Path) -> None:
    result = run("patterns", "--recording", tmp_path / "none.npz", "--out", tmp_path / "out")
    assert result.exit_code == 1
    assert "there is no such file" in result.stderr
