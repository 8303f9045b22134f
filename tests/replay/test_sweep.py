"""Every combination once, in order, whatever happens to those who think it through."""

import csv
import math
import os
from collections.abc import Callable
from pathlib import Path

import pytest

from bentod.analysis.sweep_figure import draw
from bentod.errors import BadRequest, ConfigError
from bentod.frames import Value
from bentod.replay import sweep_pool
from bentod.replay.sweep import Measure, Outcome, Point, best, points
from bentod.replay.sweep_table import WIDEST, as_csv, sentences, table
from bentod.replay.sweep_thought import check, thought
from tests.replay.test_altered import SIM

GRID: dict[str, list[Value]] = {"learn.step_size": [0.1, 0.3], "learn.algorithm": ["td", "true_online"]}


def outcome(point: Point, *ratios: float, failed: str = "") -> Outcome:
    """One whose errors are these times those live."""
    measures = tuple(Measure(f"q{i}", 0.5, 0.5 * ratio) for i, ratio in enumerate(ratios))
    return Outcome(point, measures, 100, 40, failed)


def test_all_combinations_are_tried_the_last_key_changing_fastest() -> None:
    assert [str(point) for point in points(GRID)] == [
        "learn.step_size=0.1, learn.algorithm=td",
        "learn.step_size=0.1, learn.algorithm=true_online",
        "learn.step_size=0.3, learn.algorithm=td",
        "learn.step_size=0.3, learn.algorithm=true_online",
    ]
    assert [point.place for point in points(GRID)] == [0, 1, 2, 3]


@pytest.mark.parametrize("grid", [{}, {"a.b": []}, {"a.b": [1] * 200, "a.c": [1] * 200}])
def test_a_sweep_over_nothing_or_over_too_much_is_refused(grid: dict[str, list[Value]]) -> None:
    with pytest.raises(BadRequest, match="a sweep tries 1 to 10000 combinations"):
        points(grid)


def test_a_combination_that_no_config_allows_is_told_before_anything_runs() -> None:
    check(SIM, points({"learn.step_size": [0.1, 1.0]}))
    with pytest.raises(ConfigError, match="step_size"):
        check(SIM, points({"learn.step_size": [0.1, 2.0]}))


def test_what_goes_wrong_with_one_combination_is_its_outcome(tmp_path: Path) -> None:
    (point,) = points({"learn.step_size": [0.1]})
    assert "does not exist" in thought(tmp_path / "none.mcap", point).failed


def test_the_relative_error_is_the_geometric_mean_over_functions_of_any_unit() -> None:
    tried = points(GRID)
    assert outcome(tried[0], 0.5, 2.0).relative == pytest.approx(1.0)
    assert outcome(tried[0], 0.5, 0.5, 0.25).relative == pytest.approx(0.5 * 0.5 ** (1 / 3))
    assert math.isnan(outcome(tried[0]).relative)
    assert best(
        [outcome(tried[0], 1.0), outcome(tried[1], 0.9), outcome(tried[2], 0.9), outcome(tried[3])]
    ) == (outcome(tried[1], 0.9))
    assert best([]) is None


def test_the_table_and_the_csv_tell_of_every_combination_and_of_what_failed() -> None:
    tried = points(GRID)
    many = [1 + i / 10 for i in range(WIDEST + 2)]
    found = [outcome(tried[0], *many), outcome(tried[1], 0.1 + 0.2), outcome(tried[2], failed="it died")]
    head, *rows = table(found)
    assert head == ["learn.step_size", "learn.algorithm", "of live", *(f"q{i}" for i in range(WIDEST))]
    assert rows[1] == ["0.1", "true_online", "0.3000", "0.15", *"–" * (WIDEST - 1)]
    assert rows[2][:3] == ["0.3", "td", "failed: it died"]
    told = "\n".join(sentences(found))
    assert "2 functions more are in the CSV" in told
    assert "1 of 3 combinations failed." in told
    assert "The best is learn.step_size=0.1, learn.algorithm=true_online: 0.3000 of the errors live." in told
    lines = list(csv.DictReader(as_csv(found).splitlines()))
    assert len(lines) == len(many) + 2
    assert float(lines[len(many)]["rmse"]) == found[1].measures[0].again
    assert lines[-1]["failed"] == "it died"
    assert "no error to compare" in sentences([outcome(tried[0])])[-1]


@pytest.mark.parametrize(
    "grid",
    [
        {"learn.step_size": [0.01, 0.1, 1.0], "learn.trace_lambda": [0.8, 0.9]},
        {"learn.algorithm": ["td", "true_online"]},
    ],
)
def test_the_figure_is_the_same_each_time(tmp_path: Path, grid: dict[str, list[Value]]) -> None:
    found = [outcome(point, 1 + point.place / 3) for point in points(grid)]
    found[-1] = outcome(found[-1].point, failed="it died")
    draw(found, tmp_path / "one.png")
    draw(found, tmp_path / "two.png")
    assert (tmp_path / "one.png").read_bytes() == (tmp_path / "two.png").read_bytes()


def deadly() -> Callable[[Point], Outcome]:
    """Work that kills its process for one combination, and else tells which process it is."""

    def work(point: Point) -> Outcome:
        if point.changes["a.b"] == "poison":
            os.kill(os.getpid(), 9)
        return Outcome(point, (Measure("q", 1.0, float(os.getpid())),))

    return work


@pytest.mark.real_time
def test_a_process_that_dies_is_told_with_its_parameters_and_the_others_results_stay() -> None:
    tried = points({"a.b": [1, "poison", 2, 3]})
    told: list[Outcome] = []
    found = sweep_pool.run(2, deadly(), tried, told.append)
    assert [one.point for one in found] == tried
    assert ["its process died" in one.failed for one in found] == [False, True, False, False]
    assert sorted(told, key=lambda one: one.point.place) == found
    assert os.getpid() not in {one.measures[0].again for one in found if one.measures}
