"""Many questions over the arm: answered as the thesis would, in an order that can be followed, and kept."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from bentod.config_learn import Learn
from bentod.errors import ConfigError, SnapshotError
from bentod.frames import Value
from bentod.learn.horde import Horde
from bentod.learn.lazy_compiled import missing
from bentod.learn.predictor import Predictor
from bentod.learn.pupils import Together
from bentod.learn.representation import arm_coding
from bentod.learn.snapshot import read, taken, write
from bentod.learn.unit import Unit
from tests.fakes import SPECS
from tests.learn import oracles
from tests.learn.oracles import Stream, Vector
from tests.learn.predictors import SMALL, angles, gvf, live, new_predictor, percept

ALPHA = 0.3 / 9
SECOND = {
    "name": "layered",
    "tiles": [{"inputs": ['norm(prediction("elbow.position@5"), -1, 1)', "norm(elbow.position)"]}],
}
"""A representation that is made from a prediction."""

EVERYTHING: dict[str, object] = {
    "timescales": (5.0, 20.0, 60.0),
    "representations": [SECOND, {"name": "bare", "raw": ["elbow.position", "diff(shoulder.position)"]}],
    "gvfs": [
        {"name": "speed", "cumulant": "elbow.velocity", "timescale": 20.0, "variance": True, "interval": 2},
        {"name": "deep", "cumulant": "elbow.velocity", "timescale": 4.0, "representation": "layered"},
        {
            "name": "off",
            "cumulant": "diff(elbow.position)",
            "gamma": 0.9,
            "algorithm": "gtd",
            "policy": "0.5",
        },
        {"name": "until", "cumulant": "1", "gamma": "above(elbow.position, 0)", "scaling": "cumulative"},
        {
            "name": "raw",
            "cumulant": "arm.toggled",
            "timescale": 9,
            "algorithm": "td",
            "representation": "bare",
        },
    ],
}
"""One question of each kind."""


def phis(ticks: int) -> list[Vector]:
    """Features of the arm (thesis 5.3): angles over their limits, and their traces (4.7)."""
    coding = arm_coding(Learn.model_validate(SMALL), SPECS)
    history: NDArray[np.float64] | None = None
    found = []
    for tick in range(ticks):
        now = (np.array(angles(tick)) + 1) / 2
        history = now if history is None else 0.01 * now + 0.99 * history
        found.append(coding.dense(np.concatenate([now, history])))
    return found


def unit_of(horde: Horde, name: str) -> Unit:
    place = horde.answers.place[name]
    return next(unit for unit in horde.units if place in unit.places)


def rank(horde: Horde, name: str) -> int:
    """How many units learn before that of a question."""
    return horde.units.index(unit_of(horde, name))


def group_of(horde: Horde, name: str) -> Together:
    pupils = unit_of(horde, name).pupils
    assert isinstance(pupils, Together)
    return pupils


@pytest.mark.parametrize("timescale", [2.0, 20.0, 120.0])
@pytest.mark.parametrize("joint", [0, 1])
def test_each_question_is_answered_as_the_thesis_would(timescale: float, joint: int) -> None:
    ticks, gamma, name = 80, 1 - 1 / timescale, f"{SPECS[joint].name}.position@{timescale:g}"
    told = live(new_predictor(timescales=(2.0, 20.0, 120.0)), 0, ticks)
    seen = phis(ticks)
    rewards = [(1 - gamma) * angles(tick)[joint] for tick in range(1, ticks)]
    stream = Stream(seen, rewards, [ALPHA] * (ticks - 1))
    ws = oracles.equations_5_2_to_5_4(stream, np.full(len(seen[0]), -1.0 / 9), gamma, 0.95)
    expected = [float(w @ phi) for w, phi in zip(ws, seen, strict=True)]
    assert [tick[name] for tick in told] == pytest.approx(expected, abs=1e-9)


def test_questions_with_the_same_horizon_trace_and_step_size_share_a_trace() -> None:
    horde = new_predictor(gvfs=[gvf(), gvf(name="other", trace_lambda=0.5)]).horde
    shared = group_of(horde, "elbow.position@20")
    assert group_of(horde, "shoulder.position@20") is shared
    assert group_of(horde, "speed") is shared
    assert shared.delta.shape == (3,)
    assert group_of(horde, "other") is not shared
    assert group_of(horde, "elbow.position@5") is not shared


def test_all_questions_over_one_representation_have_their_weights_in_one_array() -> None:
    horde = new_predictor(gvfs=[gvf(trace_lambda=0.5)]).horde
    groups = [unit.pupils for unit in horde.units]
    bases = {id(it.group._lazy.weights.base) for it in groups if isinstance(it, Together)}
    assert len(groups) == 3
    assert len(bases) == 1
    base = group_of(horde, "speed").group._lazy.weights.base
    assert base is not None
    assert base.shape == (65, 5)


def test_the_shortest_horizon_learns_while_there_is_time_and_the_rest_only_predict() -> None:
    hurried, unhurried, ignorant = new_predictor(), new_predictor(), new_predictor()
    for tick in range(60):
        mine = live(hurried, tick, tick + 1, iter([True, False]).__next__)[0]
        theirs = live(unhurried, tick, tick + 1)[0]
        nothing = live(ignorant, tick, tick + 1, lambda: False)[0]
        for joint in ("shoulder", "elbow"):
            assert mine[f"{joint}.position@5"] == theirs[f"{joint}.position@5"]
            assert mine[f"{joint}.position@20"] == nothing[f"{joint}.position@20"]
    assert (hurried.shed, unhurried.shed, ignorant.shed) == (60, 0, 120)
    assert nothing["elbow.position@20"] != theirs["elbow.position@20"]


def test_what_was_not_learned_for_lack_of_time_is_as_if_the_arm_had_just_been_switched_on() -> None:
    hurried, cut = new_predictor(), new_predictor()
    for tick in range(70):
        short = tick % 7 == 3
        mine = live(hurried, tick, tick + 1, lambda short=short: not short)  # type: ignore[misc]
        if short:
            for unit in cut.horde.units:
                unit.cut()
        assert mine == live(cut, tick, tick + 1)
    assert hurried.shed == 2 * 10


def test_what_is_asked_for_first_learns_what_it_learns_among_all() -> None:
    apart, together = new_predictor(gvfs=[gvf()]), new_predictor(gvfs=[gvf()])
    for tick in range(40):
        apart.see(percept(tick))
        apart.step(lambda: True, ["elbow.position@20"])
        assert np.isnan(apart.fresh("elbow.position@5"))
        assert apart.fresh("speed") == apart.newest("speed")
        apart.step(lambda: True)
        (theirs,) = live(together, tick, tick + 1)
        assert {name: apart.fresh(name) for name in theirs} == theirs


def test_a_question_follows_those_whose_predictions_it_is_made_from() -> None:
    above = [
        gvf(name="third", cumulant='prediction("second")', timescale=2.0),
        gvf(name="second", cumulant='prediction("elbow.position@20")', timescale=3.0),
        gvf(name="deep", timescale=1.5, representation="layered"),
    ]
    predictor = new_predictor(gvfs=above, representations=[SECOND])
    horde = predictor.horde
    assert rank(horde, "elbow.position@20") < rank(horde, "second") < rank(horde, "third")
    assert rank(horde, "elbow.position@5") < rank(horde, "deep")
    assert horde.needs("deep") == {"elbow.position@5"}
    predictor.see(percept(0))
    predictor.step(lambda: True, ["third"])
    fresh = {q.name for q in horde.questions if np.isfinite(predictor.fresh(q.name))}
    assert fresh == {"third", "second", "elbow.position@20", "shoulder.position@20"}


def test_a_second_layer_sees_what_the_first_says_in_the_same_tick() -> None:
    copied = gvf(name="copy", cumulant='prediction("elbow.position@5")', gamma=0.0, timescale=None)
    predictor = new_predictor(gvfs=[copied])
    live(predictor, 0, 30)
    learned = unit_of(predictor.horde, "copy")
    before = predictor.newest("copy")
    (told,) = live(predictor, 30, 31)
    # γ = 0: δ is the cumulant less what was said one tick ago
    assert learned.pupils.delta[0] == pytest.approx(told["elbow.position@5"] - before, abs=1e-12)


@pytest.mark.parametrize(
    ("gvfs", "circle"),
    [
        ([gvf(cumulant='prediction("speed")')], "speed -> speed"),
        (
            [
                gvf(cumulant='prediction("b")'),
                gvf(name="b", cumulant="1", policy='prediction("speed")', algorithm="td"),
            ],
            "speed -> b -> speed",
        ),
        (
            [gvf(gamma='prediction("speed.variance")', timescale=None, variance=True)],
            "speed -> speed.variance",
        ),
    ],
)
def test_a_circle_is_refused_by_the_names_in_it(gvfs: list[object], circle: str) -> None:
    with pytest.raises(ConfigError, match=f"in a circle: {circle}"):
        new_predictor(gvfs=gvfs)


def test_a_representation_that_needs_its_own_predictions_is_a_circle() -> None:
    looking = {"name": "inward", "raw": ['prediction("speed")']}
    with pytest.raises(ConfigError, match="in a circle: speed -> speed"):
        new_predictor(gvfs=[gvf(representation="inward")], representations=[looking])


@pytest.mark.skipif(bool(missing()), reason=missing())
def test_both_kernels_predict_the_same_to_the_last_bit() -> None:
    ours, theirs = (new_predictor(kernel=kernel, **EVERYTHING) for kernel in ("numpy", "compiled"))
    assert ours.kernel != theirs.kernel
    for first, end, every in ((0, 30, 1), (30, 45, 3), (60, 80, 1)):
        assert without_nan(live(ours, first, end, every=every)) == without_nan(
            live(theirs, first, end, every=every)
        )
    assert ours.frame() == theirs.frame()


def without_nan(told: list[dict[str, float]]) -> list[dict[str, float]]:
    """What is not known yet is nothing, rather than unequal to itself."""
    return [{name: value for name, value in tick.items() if value == value} for tick in told]


def test_the_same_signals_are_answered_the_same_every_time() -> None:
    ours, theirs = new_predictor(**EVERYTHING), new_predictor(**EVERYTHING)
    assert without_nan(live(ours, 0, 40)) == without_nan(live(theirs, 0, 40))


class Kept:
    """A horde as it is kept: what it holds, and what is asked of it."""

    def __init__(self, horde: Horde) -> None:
        self._horde = horde

    def spec(self) -> Mapping[str, Value]:
        return self._horde.spec()

    def memory(self) -> Mapping[str, NDArray[np.float64]]:
        return self._horde.memory()

    def recall(self, spec: Mapping[str, Value], memory: Mapping[str, NDArray[np.float64]]) -> list[str]:
        return self._horde.recall(spec, memory)


def stored(predictor: Predictor, path: Path) -> Path:
    write(path, taken(Kept(predictor.horde), "Bento", 0.0, 0))
    return path


def test_what_went_through_a_snapshot_goes_on_as_if_nothing_had_happened(tmp_path: Path) -> None:
    undisturbed, other = new_predictor(**EVERYTHING), new_predictor(**EVERYTHING)
    live(undisturbed, 0, 30)
    assert read(stored(undisturbed, tmp_path / "s")).give(Kept(other.horde)) == []
    for memory, expected in zip(
        other.horde.memory().values(), undisturbed.horde.memory().values(), strict=True
    ):
        np.testing.assert_allclose(memory, expected, rtol=1e-9, atol=1e-12)
    other._due = undisturbed._due
    for mine, theirs in zip(live(other, 30, 60), live(undisturbed, 30, 60), strict=True):
        assert mine == pytest.approx(theirs, abs=1e-8, nan_ok=True)


def test_two_that_recall_the_same_predict_the_same_to_the_last_bit(tmp_path: Path) -> None:
    source = new_predictor(**EVERYTHING)
    live(source, 0, 30)
    snapshot = read(stored(source, tmp_path / "s"))
    told = []
    for _ in range(2):
        fresh = new_predictor(**EVERYTHING)
        snapshot.give(Kept(fresh.horde))
        told.append(without_nan(live(fresh, 30, 45)))
    assert told[0] == told[1]


def test_questions_that_a_snapshot_does_not_know_begin_anew_and_all_others_go_on(tmp_path: Path) -> None:
    old, new = new_predictor(gvfs=[gvf()]), new_predictor(gvfs=[gvf(scaling="cumulative"), gvf(name="b")])
    live(old, 0, 100)
    assert read(stored(old, tmp_path / "s")).give(Kept(new.horde)) == ["speed", "b"]
    weights = {name: weights_of(new.horde, name) for name in ("speed", "b", "elbow.position@20")}
    assert not weights["speed"].any()
    assert not weights["b"].any()
    np.testing.assert_array_equal(weights["elbow.position@20"], weights_of(old.horde, "elbow.position@20"))


def weights_of(horde: Horde, name: str) -> NDArray[np.float64]:
    unit = unit_of(horde, name)
    column = unit.places.tolist().index(horde.answers.place[name])
    return unit.pupils.weights()[:, column]


def test_another_representation_is_refused_with_the_difference_and_nothing_half_known_remains(
    tmp_path: Path,
) -> None:
    old, new = new_predictor(tilings=7), new_predictor()
    live(old, 0, 50)
    snapshot = read(stored(old, tmp_path / "s"))
    with pytest.raises(SnapshotError, match=r"tilings 8 here, 7 in the snapshot"):
        new.recall(snapshot.spec, snapshot.arrays)  # type: ignore[arg-type]
    assert without_nan(live(new, 0, 40)) == without_nan(live(new_predictor(), 0, 40))


@pytest.mark.parametrize("part", ["units/0/pupils/weights", "representations/arm/inputs", "units/1/doubts"])
def test_a_memory_that_does_not_hold_what_it_says_leaves_nothing_known_of_any_question(part: str) -> None:
    old, new = new_predictor(), new_predictor()
    live(old, 0, 50)
    memory = {key: array for key, array in old.memory().items() if not key.startswith(part)}
    with pytest.raises(SnapshotError, match="does not hold what it says"):
        new.recall(old.spec(), memory)
    assert without_nan(live(new, 0, 40)) == without_nan(live(new_predictor(), 0, 40))
