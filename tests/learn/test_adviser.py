"""What was learned elsewhere answers here, is asked for in expressions, and is where learning may begin."""

import math
from pathlib import Path

import numpy as np
import pytest

from bentod.errors import BadRequest, ConfigError
from bentod.learn.expression import Expression, Vocabulary
from bentod.learn.horde import unhurried
from bentod.learn.returns import ideal_predictions
from tests.learn.advisers import advised, advised_without_groups, kept, learned, missed
from tests.learn.predictors import angles, gvf, live, new_predictor, percept

ELBOW = "elbow.position@20"
ECHO = {"name": "echo", "cumulant": f'advice("old", "{ELBOW}")', "gamma": 0, "scaling": "cumulative"}
"""Learns what the adviser says at the moment, and nothing else."""


@pytest.fixture(scope="module")
def old(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("old") / "old.snapshot"
    kept(learned(), path)
    return path


def said(path: Path, *ticks: int) -> list[float]:
    """What the adviser says about the elbow in these ticks."""
    predictor = advised(path)
    place = predictor.advice.advice("old", ELBOW)[0]
    return [float(predictor.advice.read(percept(tick), 1)[place]) for tick in ticks]


def test_an_adviser_answers_with_the_weights_that_it_had(old: Path) -> None:
    knowing = learned()
    knowing.see(percept(900))
    weights = knowing.horde.memory()["units/1/pupils/weights"][:, 1]
    encoder = knowing.horde.encoders["arm"]
    assert knowing.horde.units[1].places.tolist() == [2, 3]  # shoulder and elbow at 20 ticks
    knowing.step(unhurried)
    ours = advised(old)
    place = ours.advice.advice("old", ELBOW)[0]
    for tick in range(901):  # so that the traces of the angles are what they are there
        answer = ours.advice.read(percept(tick), 1)[place]
    assert answer == pytest.approx(weights[encoder.features].sum(), abs=1e-9)


def test_an_adviser_never_learns(old: Path) -> None:
    assert said(old, *range(400))[-1] == said(old, *range(400))[-1]
    adviser = advised(old)
    place = adviser.advice.advice("old", ELBOW)[0]
    first = adviser.advice.read(percept(7), 1)[place]
    live(adviser, 8, 300)
    adviser.restart()
    assert adviser.advice.read(percept(7), 1)[place] == first


def test_what_is_not_read_is_not_advised_on(old: Path) -> None:
    predictor = advised(old)
    place = predictor.advice.advice("old", ELBOW)[0]
    assert math.isnan(predictor.advice.read(percept(3, stale=(0,)), 1)[place])


def test_advice_is_a_number_like_any_other_in_expressions(old: Path) -> None:
    predictor = advised(old, gvfs=[ECHO | {"step_size": 1.0, "trace_lambda": 0}])
    live(predictor, 0, 50)
    assert math.isfinite(predictor.newest("echo"))


def test_a_representation_may_be_made_from_advice_and_says_from_which(old: Path) -> None:
    tiles = {"inputs": [f'norm(advice("old", "{ELBOW}"), -1, 1)'], "memory": 0}
    predictor = advised(old, representations=[{"name": "heard", "tiles": [tiles]}], representation="heard")
    told = live(predictor, 0, 300)
    text = str(predictor.spec()["representations"])
    digest = predictor.advice.digests["old"]
    assert f"advice('old', 'elbow.position@20', '{digest[:12]}')" in text
    assert predictor.horde.encoders["heard"].coding.size == 17
    assert told[-1][ELBOW] > told[0][ELBOW] == pytest.approx(-1)


def test_written_out_advice_is_read_again_and_means_the_same(old: Path) -> None:
    words = Vocabulary(advised(old).advice)
    text = f'advice("old", "{ELBOW}")'
    one = Expression.parse(text, words)
    assert Expression.parse(str(one), words) == one
    with pytest.raises(ConfigError, match="is of the snapshot"):
        Expression.parse(f'advice("old", "{ELBOW}", "0123")', words)


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ('advice("older", "x")', "there is no adviser 'older'; did you mean 'old'?"),
        ('advice("old", "elbow.position@2")', "does not know 'elbow.position@2'"),
        ("advice(old, elbow)", "needs names in quotes"),
        ('advice("old")', "takes 2 to 3 arguments"),
    ],
)
def test_advice_that_nobody_can_give_is_refused_with_a_sentence(old: Path, text: str, why: str) -> None:
    with pytest.raises(BadRequest) as caught:
        advised(old).add(gvf(name="q", cumulant=text))
    assert why in str(caught.value)


def test_without_advisers_there_is_no_advice() -> None:
    with pytest.raises(ConfigError, match="there is no adviser 'old'"):
        new_predictor(gvfs=[ECHO])


def test_a_learner_that_is_advised_begins_with_what_the_adviser_says(old: Path) -> None:
    adviser_says = said(old, 0)
    predictor = advised(old, adviser="old")
    assert live(predictor, 0, 1)[0][ELBOW] == pytest.approx(adviser_says[0], abs=1e-9)


def test_an_arm_that_is_advised_predicts_better_at_the_start_and_no_worse_later(old: Path) -> None:
    elbow = np.array([[angles(tick)[1]] for tick in range(1000)])
    ideal = ideal_predictions(elbow, 20)[:600, 0]
    told = {
        name: [it[ELBOW] for it in live(predictor, 0, 600)]
        for name, predictor in (("alone", new_predictor()), ("advised", advised(old, adviser="old")))
    }
    errors = {name: np.abs(np.array(values) - ideal) for name, values in told.items()}
    assert errors["advised"][:60].mean() < 0.7 * errors["alone"][:60].mean()
    assert errors["advised"][400:].mean() < 1.1 * errors["alone"][400:].mean()


def test_an_adviser_that_knows_nothing_changes_nothing(tmp_path: Path) -> None:
    path = tmp_path / "fresh.snapshot"
    kept(new_predictor(), path)
    told = live(advised(path, adviser="old"), 0, 200)
    assert missed(told, live(new_predictor(), 0, 200), ELBOW) == pytest.approx(0, abs=1e-9)


def test_questions_of_ones_own_may_begin_with_the_advice_of_the_same_name(old: Path) -> None:
    predictor = advised(old, joints=(), representations=[{"name": "r", "raw": ["elbow.velocity"]}],
                        gvfs=[{"name": ELBOW, "cumulant": "elbow.position", "timescale": 20,
                               "representation": "r", "adviser": "old"}])  # fmt: skip
    assert live(predictor, 0, 1)[0][ELBOW] == pytest.approx(said(old, 0)[0], abs=1e-9)


def test_a_question_that_is_added_later_leaves_the_guesses_of_others_undisturbed(old: Path) -> None:
    undisturbed, disturbed = advised(old, adviser="old"), advised(old, adviser="old")
    live(undisturbed, 0, 100)
    live(disturbed, 0, 100)
    disturbed.add(gvf(name="more", cumulant=f'advice("old", "{ELBOW}")'))
    told = [live(it, 100, 200) for it in (undisturbed, disturbed)]
    assert [tick[ELBOW] for tick in told[0]] == [tick[ELBOW] for tick in told[1]]


def test_another_snapshot_than_was_meant_is_refused(old: Path) -> None:
    with pytest.raises(ConfigError, match="is another snapshot than that which was used"):
        advised(old, digest="0" * 64)


def test_a_snapshot_that_is_not_there_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"learn.advisers.old.snapshot: .*gone: cannot be read"):
        advised(tmp_path / "gone")


def test_what_was_learned_on_top_of_one_adviser_is_not_gone_on_with_on_top_of_another(
    old: Path, tmp_path: Path
) -> None:
    other = tmp_path / "other.snapshot"
    kept(learned(300), other)
    predictor = advised(old, adviser="old")
    live(predictor, 0, 50)
    successor = advised(other, adviser="old")
    begun_anew = successor.recall(predictor.spec(), predictor.memory())
    assert ELBOW in begun_anew
    same = advised(old, adviser="old")
    assert same.recall(predictor.spec(), predictor.memory()) == []


def test_who_was_advised_itself_can_be_asked_only_for_what_is_its_own(old: Path, tmp_path: Path) -> None:
    path = tmp_path / "second.snapshot"
    mine = {"name": "mine", "cumulant": "elbow.velocity", "timescale": 20}
    predictor = advised(old, adviser="old", gvfs=[mine])
    live(predictor, 0, 50)
    kept(predictor, path)
    third = advised(path)
    assert third.advice.advice("old", "mine")
    with pytest.raises(ConfigError, match="adds to what an adviser of its own said"):
        third.advice.advice("old", ELBOW)


def test_layers_of_an_adviser_are_answered_in_order(tmp_path: Path) -> None:
    tiles = {"inputs": [f'norm(prediction("{ELBOW}"), -1, 1)'], "memory": 0}
    layered: dict[str, object] = {
        "representations": [{"name": "deep", "tiles": [tiles]}],
        "gvfs": [{"name": "deep", "cumulant": "elbow.position", "timescale": 10, "representation": "deep"}],
    }
    knowing = learned(600, 0, **layered)
    path = tmp_path / "layers.snapshot"
    kept(knowing, path)
    predictor = advised(path)
    place = predictor.advice.advice("old", "deep")[0]
    for tick in range(600):
        answer = predictor.advice.read(percept(tick), 1)[place]
    assert answer == pytest.approx(knowing.newest("deep"), abs=0.1)


def test_an_adviser_that_looks_at_signals_which_this_arm_lacks_says_so_when_asked(tmp_path: Path) -> None:
    tiles = {"inputs": ["arm.active.elbow"], "memory": 0}
    knowing = learned(
        20,
        representations=[{"name": "more", "tiles": [tiles]}],
        gvfs=[{"name": "g", "cumulant": "1", "timescale": 10, "representation": "more"}],
    )
    path = tmp_path / "more.snapshot"
    snapshot = kept(knowing, path)
    from_others = advised_without_groups(path)
    assert snapshot.digest
    assert from_others.advice.advice("old", ELBOW)
    with pytest.raises(ConfigError, match=r"cannot be made here: .*unknown name 'arm.active.elbow'"):
        from_others.advice.advice("old", "g")
