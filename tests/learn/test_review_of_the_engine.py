"""What would go wrong unseen: followed predictions, missed ticks, hostile snapshots, greedy requests."""

import math
from collections.abc import Callable, Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
from numpy.typing import NDArray

from bentod.config_learn import Gvf, Learn
from bentod.contracts import Clock
from bentod.control.groups import Groups
from bentod.desk import Desk
from bentod.errors import BadRequest, Refused, SnapshotError
from bentod.frames import Value
from bentod.inquiry import LONGEST_ERROR, MOST_ENTRIES, gvf_of
from bentod.known import Known
from bentod.learn.horde import Horde, unhurried
from bentod.learn.keeper import Keeper
from bentod.learn.predictor import PROBATION
from bentod.learn.pupils import Pupils
from bentod.learn.snapshot import Snapshot, taken
from bentod.learned import Learned
from bentod.mind import Mind
from tests.fakes import PERIOD, SPECS, at, desk_of
from tests.learn.predictors import NO_EMG, gvf, live, new_predictor, percept

SECOND_LAYER = (
    gvf(name="near", timescale=5),
    gvf(name="far", timescale=50),
    gvf(name="of_near", cumulant='prediction("near")', timescale=9),
    gvf(name="of_far", cumulant='prediction("far")', timescale=9),
)
"""The last two share a trace, and are made from two that do not."""

Arrays = dict[str, NDArray[np.float64]]


def test_who_shares_a_trace_with_what_is_followed_learns_all_the_same() -> None:
    hurried, patient = new_predictor(gvfs=SECOND_LAYER), new_predictor(gvfs=SECOND_LAYER)
    for tick in range(60):
        hurried.see(percept(tick))
        hurried.step(unhurried, ["of_near"])
        hurried.step(unhurried)
    told = live(patient, 0, 60)
    assert hurried.newest("of_far") == told[-1]["of_far"] != 0


@pytest.mark.parametrize("ticks", [1, 2, 3])
def test_the_squared_error_of_several_ticks_counts_once(ticks: int, monkeypatch: pytest.MonkeyPatch) -> None:
    predictor = new_predictor(gvfs=[gvf(variance=True)])
    answers = predictor.horde.answers
    place = answers.place["speed.variance"]
    (companion,) = [unit for unit in predictor.horde.units if place in unit.places]
    rewards: list[float] = []
    monkeypatch.setattr(companion.pupils, "step", _noting(rewards, companion.pupils))
    squared: list[float] = []
    for tick in range(0, 20 * ticks, ticks):
        live(predictor, tick, tick + 1)
        squared.append(answers.squared_error("speed"))
    assert rewards[1:] == squared[1:]
    assert min(squared[1:]) > 0


def _noting(rewards: list[float], pupils: Pupils) -> Callable[..., NDArray[np.float64]]:
    """The step of `pupils`, which notes what it is to learn from."""
    step: Callable[..., NDArray[np.float64]] = pupils.step

    def noting(encoder: object, told: NDArray[np.float64], *rest: object) -> NDArray[np.float64]:
        rewards.append(float(told[0]))
        return step(encoder, told, *rest)

    return noting


def test_nothing_follows_what_was_just_told_to_begin_anew() -> None:
    predictor = new_predictor()
    live(predictor, 0, 40)
    assert math.isfinite(predictor.fresh("elbow.position@20"))
    predictor.reset(["elbow.position@20"])
    live(predictor, 40, 42)
    assert math.isnan(predictor.fresh("elbow.position@20"))
    assert math.isfinite(predictor.newest("elbow.position@20"))
    assert math.isfinite(predictor.fresh("elbow.position@5"))
    live(predictor, 42, 40 + PROBATION)
    assert math.isfinite(predictor.fresh("elbow.position@20"))


def test_of_a_tick_that_saw_nothing_there_is_no_confidence() -> None:
    predictor = new_predictor()
    live(predictor, 0, 40)
    assert math.isfinite(predictor.confidence("elbow.position@20") + predictor.surprise("elbow.position@20"))
    predictor.see(percept(40, stale=[0]))
    predictor.step(unhurried)
    assert math.isnan(predictor.confidence("elbow.position@20"))
    assert math.isnan(predictor.surprise("elbow.position@20"))


def test_nobody_gives_the_arm_expectations_of_its_own() -> None:
    predictor = new_predictor(predict=("shoulder",))
    with pytest.raises(BadRequest, match=r"assists take 'elbow\.position@20' for the arm's own"):
        predictor.add(gvf(name="elbow.position@20", cumulant="99", timescale=20))
    live(predictor, 0, 3)
    assert math.isnan(predictor.fresh("elbow.position@20"))


def test_questions_are_described_once_a_tick_however_many_ask() -> None:
    predictor = new_predictor(gvfs=[gvf()])
    live(predictor, 0, 5)
    first = predictor.describe()
    assert predictor.describe() is first
    predictor.reset(["speed"])
    assert predictor.describe() is not first
    again = predictor.describe()
    live(predictor, 5, 6)
    assert predictor.describe() is not again


@pytest.mark.parametrize(
    "table",
    [
        {"name": "x", "cumulant": ["*"] * (MOST_ENTRIES + 1), "timescale": 5},
        {"name": "x", "cumulant": "a", "timescale": [0] * 8000},
        {f"key{number}": 0 for number in range(1600)},
        [0] * 8000,
    ],
)
def test_nonsense_is_refused_before_it_takes_time(table: dict[str, object] | list[int]) -> None:
    with pytest.raises(BadRequest, match="entries are more than 256"):
        gvf_of(table)  # type: ignore[arg-type]


def test_many_mistakes_are_told_of_in_a_sentence_that_ends() -> None:
    with pytest.raises(BadRequest) as refused:
        gvf_of({"name": "x", "cumulant": [""] * 60, "timescale": [0] * 60})
    assert len(str(refused.value)) <= LONGEST_ERROR


@pytest.mark.parametrize(
    "table",
    [
        gvf(name="{cumulant}@{timescale}", cumulant="*", timescale=(2, 3, 4, 5)),
        gvf(name="{cumulant}", cumulant=("elbow.velocity",) * 21),
    ],
)
def test_a_family_may_be_kept_small(table: Gvf) -> None:
    with pytest.raises(BadRequest, match="are more than 20"):
        new_predictor().add(table, most=20)


def test_an_interval_takes_two_at_least() -> None:
    with pytest.raises(ValueError, match="interval: it takes 2 past weight vectors"):
        gvf(interval=1)


def test_past_weights_count_as_weights() -> None:
    with pytest.raises(BadRequest, match="weights; the bound is"):
        new_predictor(memory=1 << 20, tilings=1).add(
            gvf(name="t{timescale}", timescale=(2, 3, 4, 5), interval=100, confidence=False)
        )


Spoil = Callable[[Arrays, list[list[str]]], None]


def _narrower(arrays: Arrays, units: list[list[str]]) -> None:
    for name in [name for name in arrays if name.endswith("/weights")]:
        arrays[name] = arrays[name][:, :-1]


def _more_names(arrays: Arrays, units: list[list[str]]) -> None:
    for names in units:
        names.reverse()
        names[:0] = ["nobody"]


def _endless(arrays: Arrays, units: list[list[str]]) -> None:
    for name in [name for name in arrays if name.endswith("/reach")]:
        arrays[name] = np.full_like(arrays[name], np.inf)


def _uncountable(arrays: Arrays, units: list[list[str]]) -> None:
    arrays["representations/arm/visits/counts"] += np.inf


def _timeless(arrays: Arrays, units: list[list[str]]) -> None:
    arrays["units/0/doubts/error/ticks"][:] = np.nan


@pytest.mark.parametrize("spoil", [_narrower, _more_names, _endless, _uncountable, _timeless])
def test_a_snapshot_that_contradicts_itself_is_refused(spoil: Spoil) -> None:
    predictor = new_predictor(gvfs=[gvf()])
    live(predictor, 0, 10)
    whole = taken(predictor, "arm", 0.0, 10)
    arrays = {name: cast("NDArray[np.float64]", array) for name, array in whole.arrays.items()}
    units = [list(map(str, names)) for names in cast("Sequence[Sequence[str]]", whole.spec["units"])]
    spoil(arrays, units)
    spoilt = Snapshot({**whole.header, "spec": {**whole.spec, "units": list(map(list, units))}}, arrays)
    other = new_predictor(gvfs=[gvf()])
    with pytest.raises(SnapshotError, match="does not hold what it says"):
        spoilt.give(other)
    assert live(other, 0, 3) == live(new_predictor(gvfs=[gvf()]), 0, 3)


def test_a_learner_that_cannot_be_copied_ends_neither_the_tick_nor_what_was_kept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    predictor = new_predictor()
    live(predictor, 0, 10)
    mind = cast("Mind", SimpleNamespace(broken=""))
    path = tmp_path / "kept"
    with Keeper(path, 5.0) as keeper:
        kept = Learned(
            mind, Known(predictor, ()), keeper, "arm", cast("Clock", SimpleNamespace(wall=lambda: 0.0))
        )
        monkeypatch.setattr(Horde, "memories", _breaks)
        for now in (0.0, 10.0, 10.1, 10.2, 20.0, 20.1):
            kept.chore(now)
        kept.close()
    assert not path.exists()
    assert caplog.text.count("What was learned cannot be copied, and so is not kept.") == 1


def _breaks(horde: Horde) -> Arrays:
    raise TypeError("a learner from outside")


def test_while_the_arm_may_move_few_questions_come_and_not_twice_in_a_tick() -> None:
    groups = Groups(SPECS, {"arm": ["shoulder", "elbow"]})
    desk = desk_of(mind=Mind(SPECS, 1 / PERIOD, groups, Learn(joints=("shoulder", "elbow"), tilings=8)))
    _tick(desk, 0)
    desk.pause((0, 1), False)
    family: dict[str, Value] = {"name": "x{timescale}", "cumulant": "1", "timescale": list(range(2, 130))}
    with pytest.raises(BadRequest, match="128 questions are more than 98"):
        desk.add_gvf(family)
    speed: dict[str, Value] = {"name": "speed", "cumulant": "elbow.velocity", "timescale": 5}
    desk.add_gvf(speed)
    with pytest.raises(Refused, match="came or went in this tick already"):
        desk.remove_gvfs(["speed"])
    _tick(desk, 1)
    desk.remove_gvfs(["speed"])


def _tick(desk: Desk, tick: int) -> None:
    state = at(0.0, 0.5, time=tick * PERIOD)
    desk.watch(state, tick * PERIOD)
    desk.mind.predict(desk.percept(tick, tick * PERIOD, False, state, NO_EMG))
    desk.learn(unhurried)
