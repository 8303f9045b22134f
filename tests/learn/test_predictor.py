"""What may change while learners run, and what of it the others notice: nothing."""

import math
from dataclasses import replace

import numpy as np
import pytest

from bentod.config_learn import Gvf, Learn
from bentod.errors import BadRequest, ConfigError, SnapshotError
from bentod.learn import predictor as predictor_module
from bentod.learn.lazy_compiled import missing
from bentod.learn.predictor import MOST_WEIGHTS
from bentod.learn.pupils import Together
from tests.learn.predictors import BODY, SMALL, gvf, live, new_predictor, percept, without

KERNELS = ["numpy", *([] if missing() else ["compiled"])]

ADDED = {
    "shares a trace": gvf(name="new"),
    "has a trace of its own": gvf(name="new", timescale=7.0),
    "learns alone": gvf(name="new", algorithm="tidbd"),
    "shares what is remembered": gvf(name="new", cumulant="diff(elbow.position)", variance=True),
}
OLD = [
    gvf(cumulant="diff(elbow.position)"),
    gvf(name="alone", algorithm="swifttd"),
    gvf(name="deep", cumulant='prediction("speed")', timescale=3.0, confidence=False),
]


@pytest.mark.parametrize("kernel", KERNELS)
@pytest.mark.parametrize("new", ADDED.values(), ids=list(ADDED))
def test_who_comes_begins_anew_and_goes_leaves_all_others_as_they_were_to_the_last_bit(
    new: Gvf, kernel: str
) -> None:
    disturbed, undisturbed = (new_predictor(gvfs=OLD, kernel=kernel) for _ in range(2))
    names: tuple[str, ...] = ()
    for tick in range(30):
        if tick == 12:
            names = disturbed.add(new)
        if tick == 17:
            disturbed.reset([names[0]])
        if tick == 22:
            disturbed.remove(names)
        mine, theirs = live(disturbed, tick, tick + 1), live(undisturbed, tick, tick + 1)
        assert without(mine, *names) == theirs
    assert names[0] == "new"
    assert [q.name for q in disturbed.horde.questions] == [q.name for q in undisturbed.horde.questions]


@pytest.mark.parametrize("kernel", KERNELS)
@pytest.mark.parametrize("name", ["speed", "alone", "elbow.position@20", "elbow.position@5"])
def test_who_begins_anew_leaves_all_others_as_they_were_to_the_last_bit(name: str, kernel: str) -> None:
    disturbed, undisturbed = (new_predictor(gvfs=OLD[:2], kernel=kernel) for _ in range(2))
    live(disturbed, 0, 15)
    live(undisturbed, 0, 15)
    disturbed.reset([name])
    mine, theirs = live(disturbed, 15, 25), live(undisturbed, 15, 25)
    assert without(mine, name) == without(theirs, name)
    assert mine[-1][name] != theirs[-1][name]
    assert disturbed.begun_anew() == []


def test_who_comes_late_learns_what_it_would_have_learned_from_then_on() -> None:
    late, fresh = new_predictor(), new_predictor(gvfs=[gvf()])
    live(late, 0, 25)
    late.add(gvf())
    # Over the same features: their history began at the first tick.
    for tick in range(25):
        live(fresh, tick, tick + 1)
        fresh.reset(["speed"])
    for unit in late.horde.units:
        unit.cut()
    for unit in fresh.horde.units:
        unit.cut()
    told, expected = live(late, 25, 60), live(fresh, 25, 60)
    assert [tick["speed"] for tick in told] == pytest.approx([tick["speed"] for tick in expected], abs=1e-9)


def test_who_comes_back_knows_nothing_of_old() -> None:
    predictor = new_predictor(gvfs=[gvf()])
    live(predictor, 0, 40)
    predictor.remove(["speed"])
    predictor.add(gvf())
    assert math.isnan(predictor.newest("speed"))
    units = [unit for unit in predictor.horde.units if predictor.horde.answers.place["speed"] in unit.places]
    (column,) = np.flatnonzero(units[0].places == predictor.horde.answers.place["speed"])
    assert not units[0].pupils.weights()[:, column].any()


def test_a_question_asked_otherwise_under_the_old_name_knows_nothing_of_old() -> None:
    predictor = new_predictor(gvfs=[gvf(initial=0.0)])
    live(predictor, 0, 40)
    predictor.remove(["speed"])
    predictor.add(gvf(cumulant="shoulder.velocity", initial=0.5))
    (told,) = live(predictor, 40, 41)
    assert told["speed"] == pytest.approx(0.5, abs=0.1)


def test_a_family_comes_with_one_table() -> None:
    predictor = new_predictor()
    names = predictor.add(
        gvf(name="{cumulant}@{timescale}", cumulant="*.velocity", timescale_s=(0.5, 2.0), timescale=None)
    )
    assert names == (
        "shoulder.velocity@0.5s",
        "elbow.velocity@0.5s",
        "shoulder.velocity@2s",
        "elbow.velocity@2s",
    )
    (told,) = live(predictor, 0, 1)
    assert set(names) < set(told)
    assert all(math.isfinite(value) for value in told.values())
    predictor.remove(names)
    assert len(predictor.horde.questions) == 4


def test_a_companion_goes_with_the_question_whose_variance_it_learns() -> None:
    predictor = new_predictor()
    names = predictor.add(gvf(variance=True))
    assert names == ("speed", "speed.variance")
    with pytest.raises(BadRequest, match=r"speed\.variance is made from speed: remove it first"):
        predictor.remove(["speed"])
    predictor.remove(names)
    assert "speed" not in predictor.horde.answers.place


@pytest.mark.parametrize(
    ("keys", "sentence"),
    [
        ({"cumulant": "elbow.velocty"}, r"speed: cumulant: column 1 .*'elbow\.velocty'.*'elbow\.velocity'"),
        ({"cumulant": "elbow.velocity >"}, "speed: cumulant: column"),
        ({"cumulant": "*.speed"}, r"gvf\.cumulant: '\*\.speed' stands for no signal"),
        ({"cumulant": 'prediction("elbow.position@21")'}, r"no question 'elbow.*@21'.*'elbow.position@20'"),
        ({"gamma": "bove(elbow.load, 0)", "timescale": None}, "speed: gamma: column 1 .*'bove'.*'above'"),
        ({"gamma": 1.0, "timescale": None}, "gvf.gamma = 1: .*say scaling = 'cumulative'"),
        ({"timescale": None, "timescale_s": 0.01}, r"gvf\.timescale_s = 0\.01: is 0\.3 ticks.*0\.0334 s on"),
        ({"policy": "elbw.load", "algorithm": "gtd"}, "speed: policy: column 1 .*'elbw.load'.*'elbow.load'"),
        ({"policy": "1"}, "speed: policy: true_online learns on policy only"),
        ({"algorithm": "true_onlin"}, "speed: algorithm true_onlin: .*unknown.*'true_online'"),
        ({"algorithm": "gtd", "options": {"eat": 1.0}}, "speed: algorithm gtd: .*no option 'eat'.*'eta'"),
        ({"algorithm": "gtd", "options": {"eta": -1.0}}, "algorithm gtd: The option eta must be 0 to 1000"),
        ({"options": {"eta": 1.0}}, "speed: algorithm true_online: There is no option 'eta'"),
        ({"representation": "amr"}, "speed: there is no representation 'amr'.*'arm'"),
        ({"name": "elbow.position@20"}, "there is a GVF 'elbow.position@20' already"),
        ({"name": "{cumulnt}"}, r"gvf\.name: unknown placeholder '\{cumulnt\}'.*'cumulant'"),
        ({"timescale": (2.0, 3.0)}, r"gvf\.name: needs \{timescale\}, because there are 2 of them"),
        ({"cumulant": 'prediction("speed")'}, "in a circle: speed -> speed"),
    ],
)  # fmt: skip
def test_what_cannot_be_asked_is_refused_with_place_and_nearest_name_and_changes_nothing(
    keys: dict[str, object], sentence: str
) -> None:
    predictor, undisturbed = new_predictor(), new_predictor()
    live(predictor, 0, 10)
    live(undisturbed, 0, 10)
    with pytest.raises(BadRequest, match=sentence) as caught:
        predictor.add(gvf(**keys))
    assert caught.value.field == "gvf"
    assert live(predictor, 10, 20) == live(undisturbed, 10, 20)


def test_a_gvf_that_is_not_there_is_refused_with_the_nearest_and_no_other_goes() -> None:
    predictor = new_predictor(gvfs=[gvf()])
    for change in (predictor.remove, predictor.reset):
        with pytest.raises(BadRequest, match=r"no GVF 'sped'.*'speed'") as caught:
            change(["speed", "sped"])
        assert caught.value.field == "name"
    assert "speed" in predictor.horde.answers.place


def test_the_arms_own_predictions_stay() -> None:
    predictor = new_predictor()
    with pytest.raises(BadRequest, match=r"elbow\.position@20 is the arm's own and stays"):
        predictor.remove(["elbow.position@20"])
    predictor.reset(["elbow.position@20"])


def test_a_config_that_asks_for_more_weights_than_there_is_room_for_is_refused() -> None:
    tiles = {"inputs": ["norm(elbow.position)"], "memory": 1 << 24}
    big = {"name": "big", "bias": False, "tiles": [tiles]}
    many = MOST_WEIGHTS // 2**24
    family = gvf(name="x{timescale}", timescale=[2.0 + i for i in range(many)], representation="big")
    with pytest.raises(ConfigError, match="20 GVFs need 268,435,716 weights; the bound is 268,435,456"):
        new_predictor(representations=[big], gvfs=[family])


def test_weights_are_taken_up_to_the_bound_and_not_beyond(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(predictor_module, "MOST_WEIGHTS", 5 * 65)
    predictor = new_predictor()
    predictor.add(gvf())
    with pytest.raises(BadRequest, match="6 GVFs need 390 weights; the bound is 325"):
        predictor.add(gvf(name="one.more"))
    assert len(predictor.horde.questions) == 5


@pytest.mark.parametrize(("missed", "bridged"), [(0, True), (1, True), (2, True), (3, False), (500, False)])
def test_two_missed_ticks_are_bridged_and_a_longer_hole_is_not(missed: int, bridged: bool) -> None:
    predictor = new_predictor()
    live(predictor, 0, 20)
    live(predictor, 20 + missed, 21 + missed)
    assert np.isfinite(predictor.horde.answers.delta).all() == bridged


def test_after_a_tick_that_broke_nothing_is_learned_across() -> None:
    predictor = new_predictor()
    live(predictor, 0, 20)
    predictor.see(percept(20, gap=True))
    predictor.step(lambda: True)
    assert np.isnan(predictor.horde.answers.delta).all()


def test_time_that_goes_back_is_a_new_beginning() -> None:
    predictor, fresh = new_predictor(), new_predictor()
    live(predictor, 100, 130)
    predictor.reset([question.name for question in predictor.horde.questions])
    told, expected = live(predictor, 0, 20), live(fresh, 0, 20)
    for mine, theirs in zip(told, expected, strict=True):
        assert mine == pytest.approx(theirs, abs=1e-9)


def test_what_a_blind_arm_said_last_stands_with_its_age_but_is_not_fresh() -> None:
    predictor = new_predictor()
    (before,) = live(predictor, 0, 30)[-1:]
    for age in (1.0, 2.0):
        predictor.see(percept(29 + int(age), stale=(0,)))
        predictor.step(lambda: True)
        assert {name: predictor.newest(name) for name in before} == before
        assert all(math.isnan(predictor.fresh(name)) for name in before)
        assert predictor.frame().older == dict.fromkeys(before, age)
    live(predictor, 32, 33)
    assert predictor.frame().older == {}


def test_a_learner_that_diverges_is_told_of_once_and_its_prediction_stays_finite() -> None:
    predictor, undisturbed = new_predictor(), new_predictor()
    live(predictor, 0, 10)
    live(undisturbed, 0, 10)
    spoil(predictor, "elbow.position@20")
    mine, theirs = live(predictor, 10, 11), live(undisturbed, 10, 11)
    assert predictor.begun_anew() == ["elbow.position@20"]
    assert predictor.begun_anew() == []
    assert without(mine, "elbow.position@20") == without(theirs, "elbow.position@20")
    assert mine[0]["elbow.position@20"] == pytest.approx(-1.0, abs=0.2)
    predictor.add(gvf())
    live(predictor, 11, 20)
    assert predictor.begun_anew() == []


def test_nobody_follows_a_learner_that_diverged_until_it_has_learned_again_for_a_while() -> None:
    predictor = new_predictor()
    live(predictor, 0, 10)
    spoil(predictor, "elbow.position@20")
    live(predictor, 10, 11)
    assert math.isnan(predictor.fresh("elbow.position@20"))
    assert math.isfinite(predictor.newest("elbow.position@20"))
    assert math.isfinite(predictor.fresh("shoulder.position@20"))
    live(predictor, 11, 10 + predictor_module.PROBATION)
    assert math.isnan(predictor.fresh("elbow.position@20"))
    live(predictor, 10 + predictor_module.PROBATION, 12 + predictor_module.PROBATION)
    assert math.isfinite(predictor.fresh("elbow.position@20"))


def spoil(predictor: predictor_module.Predictor, name: str) -> None:
    """Let the weights of a question be infinite."""
    place = predictor.horde.answers.place[name]
    unit = next(unit for unit in predictor.horde.units if place in unit.places)
    assert isinstance(unit.pupils, Together)
    unit.pupils.group._lazy.weights[:, unit.places == place] = np.inf


def test_nobody_is_as_sure_of_a_question_as_before_once_it_begins_anew() -> None:
    predictor = new_predictor()
    live(predictor, 0, 150)
    before = predictor.confidence("elbow.position@5")
    predictor.reset(["elbow.position@5"])
    live(predictor, 150, 151)
    assert predictor.confidence("elbow.position@5") < 0.2 < before
    assert math.isnan(predictor.confidence("nobody"))


@pytest.mark.parametrize("algorithm", ["true_online", "td", "swifttd", "gtd"])
def test_a_cumulant_beyond_all_reason_spoils_nothing_but_its_own_question(algorithm: str) -> None:
    wild = gvf(name="wild", cumulant="1e300 * elbow.velocity", algorithm=algorithm, variance=True, interval=2)
    predictor, undisturbed = new_predictor(gvfs=[wild]), new_predictor()
    told, expected = live(predictor, 0, 30), live(undisturbed, 0, 30)
    assert without(told, "wild", "wild.variance") == expected
    assert math.isfinite(predictor.newest("wild"))
    frame = predictor.frame()
    values = (*frame.predictions.values(), *frame.surprise.values(), *frame.error.values())
    assert all(map(math.isfinite, values))


def test_what_was_learned_at_another_rate_is_refused_because_a_tick_is_another_time() -> None:
    learn = Learn.model_validate(SMALL)
    predictor, faster = new_predictor(), predictor_module.Predictor(replace(BODY, rate_hz=60.0), learn)
    live(predictor, 0, 20)
    with pytest.raises(SnapshotError, match=r"learned at 30\.0 Hz, and a tick is another time at 60"):
        faster.recall(predictor.spec(), predictor.memory())
