import pytest

from bentod.config_learn import Gvf, Learn, RepresentationTable
from bentod.errors import ConfigError
from bentod.frames import JointSpec
from bentod.learn.question import Estimates, Question
from bentod.learn.questions import expand, questions_of
from bentod.learn.signals import Signals

SPECS = (JointSpec("shoulder", -1.0, 1.5, 0.5, 0.0, {}), JointSpec("elbow", 0.25, 2.0, 0.7, 0.5, {}))
SIGNALS = Signals(SPECS)
MINE = RepresentationTable(name="mine", raw=("elbow.load",))


def gvf(**changes: object) -> Gvf:
    table: dict[str, object] = {"name": "push", "cumulant": "elbow.load", "timescale": 20.0}
    return Gvf.model_validate({k: v for k, v in (table | changes).items() if v is not None})


def asked(*tables: Gvf, **changes: object) -> tuple[Question, ...]:
    learn = Learn.model_validate({"joints": ("elbow",), "gvfs": tables, "representations": (MINE,)} | changes)
    return expand(learn, SPECS, SIGNALS, 30.0)


def names(*tables: Gvf) -> list[str]:
    return [question.name for table in tables for question in questions_of(table, SIGNALS, 30.0)]


def test_the_arm_asks_where_its_joints_will_be_as_in_the_thesis() -> None:
    questions = asked(timescales=(5.0, 20.0), trace_lambda=0.9, step_size=0.2)
    assert [question.name for question in questions] == [
        "shoulder.position@5",
        "elbow.position@5",
        "shoulder.position@20",
        "elbow.position@20",
    ]
    assert questions[3] == Question(
        name="elbow.position@20",
        cumulant="elbow.position",
        gamma=0.95,
        scaled=True,
        lam=0.9,
        step_size=0.2,
        algorithm="true_online",
        representation="arm",
        initial=0.25,
        estimates=Estimates(confidence_range=1.75),
    )


def test_only_the_joints_that_are_to_be_predicted_are() -> None:
    assert [question.name for question in asked(predict=("elbow",))] == ["elbow.position@20"]


def test_without_joints_only_the_tables_ask() -> None:
    (question,) = asked(gvf(representation="mine"), joints=())
    assert question.name == "push"


def test_a_table_says_all_that_there_is_to_a_question() -> None:
    table = gvf(
        timescale=None,
        gamma="1 - above(elbow.load, 0.5)",
        scaling="cumulative",
        trace_lambda=0.5,
        step_size=0.1,
        algorithm="gtd",
        options={"beta": 0.01},
        representation="mine",
        policy="below(elbow.load, 0)",
        initial=2.0,
        confidence=False,
        confidence_range=4.0,
        interval=3,
    )
    assert asked(table)[-1] == Question(
        name="push",
        cumulant="elbow.load",
        gamma="1 - above(elbow.load, 0.5)",
        scaled=False,
        lam=0.5,
        step_size=0.1,
        algorithm="gtd",
        representation="mine",
        policy="below(elbow.load, 0)",
        initial=2.0,
        options={"beta": 0.01},
        estimates=Estimates(False, 4.0, 3, False),
    )


def test_a_timescale_in_ticks_or_in_seconds_becomes_a_discount() -> None:
    assert questions_of(gvf(timescale=8.0), SIGNALS, 30.0)[0].gamma == 0.875
    assert questions_of(gvf(timescale=None, timescale_s=0.5), SIGNALS, 20.0)[0].gamma == 0.9
    assert questions_of(gvf(timescale=None, gamma=0.3), SIGNALS, 30.0)[0].gamma == 0.3


def test_a_family_has_one_question_for_each_cumulant_at_each_timescale() -> None:
    several = gvf(
        name="{cumulant}@{timescale}", cumulant=("elbow.load", "shoulder.load"), timescale=(5.0, 20.5)
    )
    assert names(several) == [
        "elbow.load@5",
        "shoulder.load@5",
        "elbow.load@20.5",
        "shoulder.load@20.5",
    ]
    in_seconds = gvf(name="a.{timescale}", timescale=None, timescale_s=(0.5, 2.0))
    assert names(in_seconds) == ["a.0.5s", "a.2s"]


def test_stars_stand_for_all_signals_that_fit() -> None:
    questions = questions_of(gvf(name="next.{cumulant}", cumulant="*.velocity"), SIGNALS, 30.0)
    assert [(question.name, question.cumulant) for question in questions] == [
        ("next.shoulder.velocity", "shoulder.velocity"),
        ("next.elbow.velocity", "elbow.velocity"),
    ]


def test_signals_with_names_of_the_grammar_are_put_in_quotes() -> None:
    signals = Signals([JointSpec("in", 0.0, 1.0, 1.0, 0.0, {})])
    (question,) = questions_of(gvf(name="{cumulant}", cumulant="*.load"), signals, 30.0)
    assert (question.name, question.cumulant) == ("in.load", "'in.load'")


def test_a_definition_gives_a_name_to_what_a_family_predicts() -> None:
    table = gvf(name="{cumulant}", cumulant=("speed", "elbow.load"))
    assert [it.name for it in asked(table, define={"speed": "diff(elbow.position)"})][-2:] == [
        "speed",
        "elbow.load",
    ]


def test_the_companion_learns_the_variance_from_the_squared_error() -> None:
    """γ̄ = (γλ)², cumulant δ² (Sherstan et al. 2018)."""
    table = gvf(variance=True, trace_lambda=0.5, timescale=5.0, initial=3.0, interval=4, step_size=0.1)
    question, companion = questions_of(table, SIGNALS, 30.0)
    assert question.estimates.variance
    assert companion.name == "push.variance"
    assert companion.cumulant == 'delta2("push")'
    assert companion.gamma == pytest.approx((0.8 * 0.5) ** 2)
    assert (companion.scaled, companion.initial, companion.estimates) == (False, 0.0, Estimates(False))
    assert (companion.lam, companion.step_size, companion.representation) == (0.5, 0.1, "arm")
    varying = questions_of(gvf(variance=True, timescale=None, gamma="elbow.load"), SIGNALS, 30.0)[1]
    assert varying.gamma == "square(clip(elbow.load, 0, 1) * 0.95)"


@pytest.mark.parametrize(
    ("changes", "why"),
    [
        ({"cumulant": "elbw.load"}, r"gvfs\.0\.cumulant: column 1 .*did you mean 'elbow\.load'"),
        ({"cumulant": "*.speed"}, r"gvfs\.0\.cumulant: '\*\.speed' stands for no signal"),
        ({"cumulant": "prediction('pus')"}, r"gvfs\.0\.cumulant: .*no question 'pus'; did you mean 'push'"),
        ({"timescale": None, "gamma": "above(1)"}, r"gvfs\.0\.gamma: column 1 .*above takes 2"),
        ({"policy": "elbow"}, r"gvfs\.0\.policy: column 1 .*unknown name 'elbow'"),
        ({"timescale": None, "gamma": 1.0}, r"gvfs\.0\.gamma = 1: .*scaling = 'cumulative'"),
        ({"timescale": None, "timescale_s": 0.02}, r"gvfs\.0\.timescale_s = 0\.02: is 0\.6 ticks at 30 Hz"),
        ({"timescale": (5.0, 6.0)}, r"gvfs\.0\.name: needs \{timescale\}, because there are 2"),
        ({"cumulant": ("elbow.load", "1")}, r"gvfs\.0\.name: needs \{cumulant\}, because there are 2"),
        ({"name": "a{cumlant}"}, r"gvfs\.0\.name: unknown placeholder '\{cumlant\}'; did you mean"),
        ({"name": "a{timescale}", "timescale": None, "gamma": 0.5}, r"stands for nothing, because gamma"),
        ({"name": "a{b"}, r"gvfs\.0\.name: 'a\{b' is no name"),
        ({"name": "{cumulant}", "cumulant": "diff(elbow.load)"}, r"give the cumulant one in learn\.define"),
        ({"name": "elbow.position@20"}, r"gvfs\.0: .*asked twice, first by learn\.timescales"),
        ({"name": "a{timescale}", "timescale": (5.0, 5.0000001)}, r"gvfs\.0: .*'a5' is asked twice"),
        ({"representation": "mien"}, r"gvfs\.0\.representation: there is no 'mien'; did you mean 'mine'"),
    ],
)
def test_a_table_that_cannot_be_asked_is_refused_by_its_place_and_key(
    changes: dict[str, object], why: str
) -> None:
    with pytest.raises(ConfigError, match=rf"^learn\..*{why}"):
        asked(gvf(**changes))


def test_two_tables_may_not_ask_under_one_name() -> None:
    with pytest.raises(
        ConfigError, match=r"learn\.gvfs\.1: .*'push' is asked twice, first by learn\.gvfs\.0"
    ):
        asked(gvf(), gvf(timescale=3.0))
    with pytest.raises(ConfigError, match=r"'push\.variance' is asked twice"):
        asked(gvf(variance=True), gvf(name="push.variance"))


def test_more_questions_than_fit_are_refused() -> None:
    table = gvf(
        name="{cumulant}.{timescale}",
        cumulant=("elbow.load",) * 4000,
        timescale=tuple(map(float, range(2, 22))),
    )
    with pytest.raises(ConfigError, match="80000 questions are more than 65536"):
        asked(table)
