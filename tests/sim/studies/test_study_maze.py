"""The study of the maze, on very short sessions: what is played, claimed, tabled and drawn."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from bentod.errors import BadRequest
from sim.people.traits import AUTHOR, NAIVE
from sim.studies import study_maze, study_waypoints
from sim.studies.figures import draw_chart
from sim.studies.maze import Maze
from sim.studies.maze_charts import charts
from sim.studies.maze_claims import claims, first_is_slow, recovery
from sim.studies.maze_people import WAYS, Helped, Order, Person, chosen, everybody, play
from sim.studies.maze_table import HEAD, THESIS
from sim.studies.stage import CircuitResult, Condition
from sim.studies.study import People

pytest.importorskip("matplotlib")


@pytest.fixture(scope="module")
def person() -> Person:
    """Somebody like the author: a circuit alone, and one with the assist that knows the maze."""
    return play(Order(AUTHOR, 1, ("oracle",), 1, 1))


def circuits(condition: Condition, *costs: tuple[float, int, int]) -> list[CircuitResult]:
    """Of seconds, toggles and contacts each."""
    return [CircuitResult(i, condition, *cost, distance=1.3) for i, cost in enumerate(costs, 1)]


def invented(name: str, helped: Sequence[tuple[float, int, int]]) -> Person:
    """With the same circuits however they are helped."""
    solo = circuits("solo", (20.0, 10, 0), (21.0, 10, 0), (22.0, 10, 0))
    one = Helped(circuits("assisted", *helped), rmse=(0.01, 0.02))
    return Person(name, solo, {"thesis 10": one, "thesis 20": one, "confident": one})


def test_each_assist_begins_with_the_learners_of_the_circuits_alone(person: Person) -> None:
    track = person.helped["oracle"].track
    assert track is not None
    missed = np.abs(track.predictions()[1] - track.positions()[1])
    unlearned = np.abs([low for low, _ in Maze().limits] - track.positions()[1])
    assert missed[0] < unlearned[0] / 4
    assert track["visits"][1] > 1000


def test_a_rest_at_the_green_barrier_begins_every_session(person: Person) -> None:
    for helped in person.helped.values():
        assert helped.track is not None
        resting = helped.track["resting"] > 0
        assert resting[:140].all()
        assert helped.results[0].time > 10


def test_helped_circuits_are_counted_apart_and_from_one(person: Person) -> None:
    assert [result.condition for result in person.circuits("oracle")] == ["solo", "assisted"]
    assert person.helped["oracle"].results[0].number == 1


def test_whoever_knows_the_maze_spares_toggles(person: Person) -> None:
    assert person.helped["oracle"].results[0].toggles < person.solo[0].toggles


def test_every_figure_of_the_thesis_has_its_counterpart_and_can_be_drawn(person: Person) -> None:
    found = charts([person])
    kinds = {chart.name.removesuffix("-oracle") for chart in found}
    assert kinds == {"5-9", "5-10", "5-11", "5-12a", "5-12b"}
    for chart in found:
        drawn = draw_chart(chart)
        assert len([axes for axes in drawn.figure.axes if axes.lines]) == len(chart.plots)


def test_the_table_has_the_columns_of_the_thesis_and_contacts(person: Person) -> None:
    head, *rows = study_maze._table([person])
    assert tuple(head[: len(HEAD)]) == HEAD
    assert len(rows) == len(THESIS) + len(person.helped)
    assert {len(row) for row in rows} == {len(HEAD) + 2}
    assert rows[-1][0] == "author, oracle"


def test_as_many_processes_as_one_likes_find_the_same() -> None:
    orders = [Order(NAIVE, seed, (), 1, 0, tracked=False) for seed in (1, 2)]
    first, second = everybody(orders, jobs=2)
    assert second.solo == play(orders[1]).solo
    assert first.solo != second.solo


def test_thesis_means_its_three_timescales_and_an_unknown_assist_is_refused() -> None:
    assert chosen(["thesis", "oracle"]) == ("thesis 10", "thesis 15", "thesis 20", "oracle")
    assert set(chosen(["thesis", "confident", "frozen", "shuffled", "oracle"])) == set(WAYS)
    with pytest.raises(BadRequest, match="no assist 'thesys'; did you mean 'thesis'"):
        chosen(["thesys"])


def test_a_first_circuit_is_slow_above_the_mean_and_a_deviation() -> None:
    assert first_is_slow(invented("naive 1", [(22.1, 5, 0)]), "confident")
    assert not first_is_slow(invented("naive 1", [(21.9, 5, 0), (40.0, 5, 0)]), "confident")


def test_claims_hold_for_whom_they_should_and_fail_for_others() -> None:
    good = [invented("author 1", [(17.0, 3, 0)]), invented("naive 2", [(17.0, 3, 0)])]
    found = {claim.text: claim for claim in claims(good)}
    assert found["like the author, 10 steps: toggles, share"].holds
    assert found["like the author, 10 steps: toggles, share"].value == pytest.approx(-0.7)
    assert not found["naive, DPCC at 20 steps: share whose first circuit is slow"].holds
    worse = {claim.text: claim for claim in claims([invented("author 1", [(25.0, 9, 0)])])}
    assert not worse["like the author, 10 steps: toggles, share"].holds
    assert not worse["dpcc_confident: worst operator, time over solo, less 1"].holds


def test_recovery_is_the_first_circuit_that_is_about_as_before() -> None:
    before = circuits("assisted", (16.0, 3, 0), (16.0, 3, 0))
    after = circuits("assisted", (30.0, 9, 2), (17.0, 6, 0), (17.0, 3, 0))
    one = Helped(before, after)
    person = Person("naive 1", [], {"confident": one, "thesis 20": replace(one, changed=after[:2])})
    assert recovery(person, "confident") == 3
    assert recovery(person, "thesis 20") == 3


def test_a_circuit_of_way_points_alone_and_one_helped_make_a_report() -> None:
    found = study_waypoints.run(1, People(circuits=1))
    assert [chart.name for chart in found.charts] == ["5-4", "5-5", "5-6", "5-7"]
    assert [row[1] for row in found.comparison[1:]] == ["1", "1", "1", "1"]
    claims_of = {claim.text: claim for claim in found.claims}
    assert claims_of["circuits that were given up"].holds
    for chart in found.charts:
        draw_chart(chart)
