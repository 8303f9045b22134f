"""What several arms have learned becomes one snapshot, in which each speaks of what it has seen."""

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from bentod.cli.learn import learn
from bentod.contracts import Vector
from bentod.errors import SnapshotError
from bentod.learn.merge import merge
from bentod.learn.snapshot import Snapshot, read, taken
from tests.learn.advisers import kept, learned
from tests.learn.predictors import live, new_predictor

WEIGHTS, COUNTS = "units/1/pupils/weights", "representations/arm/visits/counts"
TIDBD = {"name": "t", "cumulant": "elbow.velocity", "timescale": 20, "algorithm": "tidbd"}


def snapshot(first: int = 0, ticks: int = 200, **learn: object) -> Snapshot:
    return taken(learned(ticks, first, **learn), f"arm at {first}", float(first), ticks)


def array(told: Snapshot, name: str) -> Vector:
    return told.arrays[name].astype(np.float64)


def merged(*snapshots: Snapshot, weights: tuple[float, ...] = (1.0, 1.0)) -> Snapshot:
    return merge(snapshots, weights, ["A", "B", "C"][: len(snapshots)])


def test_each_feature_is_averaged_by_how_often_each_arm_saw_it() -> None:
    one, other = snapshot(0, 60), snapshot(3000, 150)
    both = array(merged(one, other, weights=(2.0, 1.0)), WEIGHTS)
    mine, theirs = 2 * array(one, COUNTS), array(other, COUNTS)
    assert (mine == 0).any()
    for feature in range(65):
        n, m = mine[feature], theirs[feature]
        if n + m:
            expected = (n * array(one, WEIGHTS)[feature] + m * array(other, WEIGHTS)[feature]) / (n + m)
            np.testing.assert_allclose(both[feature], expected, atol=1e-12)


def test_an_arm_has_no_say_about_what_it_has_never_seen() -> None:
    one, other = snapshot(0, 60), snapshot(3000, 150)
    alone = (array(one, COUNTS) == 0) & (array(other, COUNTS) > 0)
    assert alone.any()
    both = merged(one, other).arrays[WEIGHTS]
    np.testing.assert_array_equal(both[alone], other.arrays[WEIGHTS][alone])


def test_visits_are_added_up() -> None:
    one, other = snapshot(0, 60), snapshot(3000, 150)
    both = merged(one, other)
    for name in (COUNTS, "representations/arm/visits/ticks"):
        np.testing.assert_array_equal(array(both, name), array(one, name) + array(other, name))


def test_an_arm_merged_with_itself_goes_on_as_it_was() -> None:
    one = snapshot(0, 300, gvfs=[TIDBD])
    again, whole = new_predictor(gvfs=[TIDBD]), new_predictor(gvfs=[TIDBD])
    assert merged(one, one).give(again) == []
    assert one.give(whole) == []
    told, expected = live(again, 300, 330), live(whole, 300, 330)
    for one_tick, other_tick in zip(told, expected, strict=True):
        assert one_tick == pytest.approx(other_tick, abs=1e-9)


def test_the_header_says_of_whom_it_is_and_how_much_each_counts() -> None:
    told = merged(snapshot(0, 30), snapshot(3000, 30), weights=(1.0, 3.0)).header["merged"]
    assert isinstance(told, list)
    assert [part["weight"] for part in told if isinstance(part, dict)] == [1.0, 3.0]
    assert [part["arm"] for part in told if isinstance(part, dict)] == ["arm at 0", "arm at 3000"]


@pytest.mark.parametrize(
    ("changes", "why"),
    [
        ({"tilings": 4}, "representation arm: tiles.0.tilings 8 in A, 4 in B"),
        ({"timescales": (5.0, 21.0)}, "the question shoulder.position@20 is only in A"),
        ({"step_size": 0.1}, "is asked with step size 0.3 in A, 0.1 in B"),
    ],
)
def test_arms_that_learned_otherwise_are_refused_with_the_difference(
    changes: dict[str, object], why: str
) -> None:
    with pytest.raises(SnapshotError) as caught:
        merged(snapshot(0, 5), snapshot(0, 5, **changes))
    assert str(caught.value).startswith("A and B cannot be merged: ")
    assert why in str(caught.value)


@pytest.mark.parametrize("weights", [(1.0,), (1.0, 0.0), (1.0, float("nan"))])
def test_weights_must_be_one_for_each_and_above_0(weights: tuple[float, ...]) -> None:
    with pytest.raises(SnapshotError, match="weight"):
        merged(snapshot(0, 5), snapshot(0, 5), weights=weights)


def test_the_command_writes_what_they_know_together_and_never_over_a_file(tmp_path: Path) -> None:
    paths = [tmp_path / f"{name}.snapshot" for name in "ab"]
    for path in paths:
        kept(learned(30), path)
    out = tmp_path / "c.snapshot"
    words = ["merge", *map(str, paths), "--weights", "2,1", "--out", str(out)]
    first = CliRunner().invoke(learn, words)
    assert first.exit_code == 0, first.output
    assert read(out).header["merged"]
    again = CliRunner().invoke(learn, words)
    assert (again.exit_code, "exists already" in again.output) == (2, True)
