"""How far ahead an assist looks: found by reward, where it is known what is best (thesis 6.3)."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bentod import registry
from bentod.assist.help import Help
from bentod.assist.timescales.actor_critic import ActorCritic
from bentod.assist.timescales.choice import Choice, varying
from bentod.assist.timescales.decisions import Decisions
from bentod.assist.timescales.dice import Dice
from bentod.assist.timescales.gaussian import weights
from bentod.assist.timescales.sarsa import Sarsa
from bentod.contracts_assist import AssistSettings
from bentod.errors import BadRequest
from bentod.frames import Velocity
from bentod.learn.expression_nodes import PURE
from tests.assist.timescale_world import (
    ELBOW,
    PLACES,
    RATE,
    SHOULDER,
    SPECS,
    TIMESCALES,
    Told,
    choice,
    followed,
    live,
    situation,
)

LEARNED = ("sarsa", "blend")
ALL = (*LEARNED, "state")
STATES = {varying("elbow"): 0.3}


def test_the_gaussian_of_figure_6_1_has_the_mean_0_4_and_the_standard_deviation_0_3() -> None:
    gammas = [0.0, 0.25, 0.5, 0.75, 1.0]
    density = np.exp(-np.square((np.array(gammas) - 0.4) / 0.3) / 2) / (0.3 * math.sqrt(2 * math.pi))
    assert density.round(2).tolist() == [0.55, 1.17, 1.26, 0.67, 0.18]
    share = weights(gammas, 0.4, 0.3)
    assert round(float(share[1]), 2) == 0.31
    assert share == pytest.approx(density / density.sum())


@given(st.floats(-1, 2), st.floats(1e-9, 10))
def test_the_shares_of_a_blend_are_1_in_all_however_narrow_the_gaussian(mean: float, sd: float) -> None:
    share = weights([0.9, 0.95, 0.975], mean, sd)
    assert share.sum() == pytest.approx(1)
    assert (share >= 0).all()


def punish(chooser: Choice, by: str) -> Callable[[float, float], None]:
    """A wearer who corrects with a toggle, or says how far it was from the best."""

    def reply(expected: float, best: float) -> None:
        if by == "sarsa" and expected != pytest.approx(best):
            chooser.toggled()
        if by == "blend":
            chooser.rewarded(-6 * abs(expected - best))

    return reply


@pytest.mark.parametrize(("by", "motions"), [("sarsa", 60), ("blend", 330)])
def test_the_best_timescale_of_each_place_is_found(by: str, motions: int) -> None:
    chooser = choice(by)
    wrong: list[float] = []
    reply = punish(chooser, by)

    def watch(expected: float, best: float) -> None:
        wrong.append(abs(expected - best))
        reply(expected, best)

    live(chooser, motions, watch)
    assert np.mean(wrong[-40:]) < 0.5 * np.mean(wrong[:40])
    low, high = (followed(chooser, elbow) for elbow in PLACES)
    assert low < 0.12
    assert high > 0.3


@pytest.mark.parametrize("by", LEARNED)
def test_without_reward_nothing_is_learned_and_nothing_tried(by: str) -> None:
    chooser = choice(by)
    before = chooser.memory()
    seen = {elbow: followed(chooser, elbow) for elbow in PLACES}
    live(chooser, 30, lambda expected, best: None)
    assert {elbow: followed(chooser, elbow) for elbow in PLACES} == seen
    for name, array in chooser.memory().items():
        assert name.endswith("state") or np.array_equal(array, before[name]), name


def test_sarsa_follows_the_timescale_of_the_settings_until_it_knows_better() -> None:
    assert followed(choice("sarsa"), 0.5) == 0.1


@pytest.mark.parametrize("by", ALL)
def test_what_is_followed_never_jumps(by: str) -> None:
    chooser, told = choice(by), Told(answers=STATES)
    expected = []
    for tick in range(600):
        if tick % 37 == 0:
            chooser.toggled()
        chooser.rewarded(-10.0 if tick % 50 == 49 else 0.0)
        seen = chooser.look(situation(math.sin(tick / 20), moves=tick % 37 > 3, told=told))
        expected.append(seen.outlook.position(ELBOW, 10.0))
    span = (TIMESCALES[-1] - TIMESCALES[0]) / 100
    assert np.abs(np.diff(expected)).max() <= span / 10 + 1e-12
    assert len(set(expected)) > 3


@pytest.mark.parametrize("by", LEARNED)
def test_a_choice_holds_for_half_a_second_of_motion_and_a_rest_changes_nothing(by: str) -> None:
    decisions = Decisions(RATE)
    assert decisions.due(True)
    decisions.take()
    moving = [True, False] * 9
    assert not any(decisions.due(moves) for moves in moving)
    assert not any(decisions.due(False) for _ in range(1000))
    found = [decisions.due(moves) for moves in (True, False, True)]
    assert found == [False, False, True]


def test_after_a_toggle_it_is_chosen_anew_as_soon_as_the_wearer_moves() -> None:
    decisions = Decisions(RATE)
    decisions.due(True)
    decisions.take()
    decisions.toggled()
    decisions.rewarded(-1.0)
    assert [decisions.due(moves) for moves in (False, False, True)] == [False, False, True]
    earned, discount = decisions.take()
    assert earned == -1.0
    assert 0 < discount < 1


def test_a_motion_without_end_is_chosen_for_anew_after_three_seconds() -> None:
    decisions = Decisions(RATE)
    assert decisions.due(True)
    decisions.take()
    found = [decisions.due(True) for _ in range(80)]
    assert found.index(True) == 60


@pytest.mark.parametrize("by", ALL)
def test_predictions_at_other_timescales_are_left_as_they_are(by: str) -> None:
    seen = choice(by).look(situation(0.2, told=Told(answers=STATES))).outlook
    assert [seen.position(ELBOW, t) for t in (5.0, 40.0)] == [0.05, 0.4]
    assert seen.answer(varying("elbow")) == 0.3
    assert seen.timescales == TIMESCALES


def test_a_blend_is_as_sure_as_what_it_is_made_of_and_unknown_where_that_is() -> None:
    chooser = choice("blend")
    followed(chooser, 0.0)
    seen = chooser.look(situation(0.0)).outlook
    shares = chooser.told()
    mixed = sum(t * float(str(shares[f"{t:g}"])) for t in TIMESCALES)
    assert seen.surprise(ELBOW, 10.0) == pytest.approx(mixed)
    assert seen.confidence(ELBOW, 10.0) == pytest.approx(0.9)
    assert math.isnan(chooser.look(situation(0.0, told=Told(sure=math.nan))).outlook.confidence(ELBOW, 10.0))


def walk(chooser: Choice, seconds: float, told: Told) -> float:
    """What is followed after moving for a while."""
    expected = math.nan
    for _ in range(round(seconds * RATE)):
        expected = chooser.look(situation(0.0, told=told)).outlook.position(ELBOW, 10.0)
    return expected


def test_a_varying_timescale_starts_short_lengthens_with_confidence_and_retreats_when_punished() -> None:
    chooser, sure, unsure = choice("state"), Told(0.9, STATES), Told(0.1, STATES)
    assert walk(chooser, 0.1, sure) == pytest.approx(0.05, abs=0.005)
    assert walk(chooser, 12.0, sure) == pytest.approx(0.3)
    chooser.rewarded(-1.0)
    assert walk(chooser, 0.5, sure) == pytest.approx(0.175 + 0.0125, abs=1e-6)
    assert walk(chooser, 2.0, unsure) == 0.05
    assert walk(chooser, 12.0, Told(math.nan, STATES)) == 0.05


def test_a_varying_timescale_says_nothing_that_no_constant_one_says() -> None:
    for answer, expected in ((-9.0, 0.05), (9.0, 0.4), (math.nan, 0.05), (math.inf, 0.05)):
        chooser = choice("state")
        assert walk(chooser, 12.0, Told(0.9, {varying("elbow"): answer})) == expected


def test_a_varying_timescale_asks_for_what_it_is_made_of() -> None:
    worth, *positions = choice("state").asks()
    assert (worth["name"], worth["cumulant"]) == ("arm.worth", "arm.reward")
    assert [table["name"] for table in positions] == [varying("shoulder"), varying("elbow")]
    assert 'logistic(prediction("arm.worth"), 2.0, 0)' in str(positions[0]["gamma"])
    assert choice("sarsa").asks() == ()


@pytest.mark.parametrize("by", ALL)
def test_nothing_can_be_chosen_from_one_timescale(by: str) -> None:
    with pytest.raises(BadRequest, match="needs at least 2 timescales that are predicted, not 1") as caught:
        choice(by, timescales=(10.0,))
    assert caught.value.field == "timescale_by"


def test_an_unknown_way_is_refused_by_name() -> None:
    with pytest.raises(BadRequest, match="one of fixed, sarsa, blend, state, not luck"):
        AssistSettings(timescale_by="luck")


@pytest.mark.parametrize("by", LEARNED)
def test_a_joint_that_was_not_read_is_not_learned_from(by: str) -> None:
    chooser = choice(by)
    live(chooser, 3, lambda expected, best: chooser.rewarded(-1.0))
    before = chooser.memory()
    for _ in range(100):
        chooser.toggled()
        chooser.look(situation(0.0, stale=True))
    after = chooser.memory()
    assert all(np.array_equal(after[name], before[name]) for name in before)


@pytest.mark.parametrize("by", LEARNED)
def test_what_was_learned_is_gone_on_with_to_the_last_bit(by: str) -> None:
    one = choice(by)
    live(one, 20, punish(one, by))
    one.off()
    other = choice(by)
    other.recall(one.memory())
    for chooser in (one, other):
        chooser.look(situation(0.0, moves=False))
        chooser.off()
    seen = [[followed(chooser, elbow) for elbow in (-0.6, 0.1, 0.6) * 5] for chooser in (one, other)]
    assert seen[0][1:] == seen[1][1:]
    assert all(np.array_equal(array, other.memory()[name]) for name, array in one.memory().items())


def test_a_way_that_is_chosen_later_goes_on_with_what_was_learned_of_it() -> None:
    one = choice("sarsa")
    live(one, 20, punish(one, "sarsa"))
    other = choice("blend")
    other.recall(one.memory())
    other.adjust(AssistSettings(timescale=10.0, timescale_by="sarsa"))
    assert np.array_equal(other.memory()["sarsa/w"], one.memory()["sarsa/w"])


@pytest.mark.parametrize("by", LEARNED)
def test_a_memory_that_does_not_fit_is_told_of_and_left_out(
    by: str, caplog: pytest.LogCaptureFixture
) -> None:
    chooser = choice(by)
    live(chooser, 3, lambda expected, best: chooser.rewarded(-1.0))
    bad = {name: np.append(array, math.nan) for name, array in chooser.memory().items()}
    fresh = choice(by)
    fresh.recall(bad)
    assert "is learned anew" in caplog.text
    assert all(not array.any() for name, array in fresh.memory().items())


REWARDS = st.lists(st.floats(allow_nan=True, allow_infinity=True), max_size=40)


@settings(max_examples=25, deadline=None)
@given(REWARDS, st.sampled_from(ALL))
def test_whatever_is_rewarded_all_stays_finite(rewards: list[float], by: str) -> None:
    chooser = choice(by)
    for reward in rewards:
        chooser.rewarded(reward)
        expected = followed(chooser, 0.5)
        assert 0.05 <= expected <= 0.4 + 1e-12
    assert all(np.isfinite(array).all() for array in chooser.memory().values())


@pytest.mark.parametrize("reward", [math.inf, -1e300, 1e300])
def test_learners_bound_a_reward_of_any_size(reward: float) -> None:
    x = np.array([0, 3])
    sarsa = Sarsa(4, 2, 3, 1, seed=1)
    actor = ActorCritic(4, 2, (0.5, 0.5), seed=1)
    for _ in range(200):
        sarsa.step(x, reward, 0.9)
        assert ((actor.step(x, reward, 0.9) >= 0) & (actor.policy(x)[0] <= 1)).all()
    assert np.abs(sarsa.w).max() <= 1e3
    assert np.abs(actor.u).max() <= 0.75
    assert np.isfinite(actor.v).all()


def test_sarsa_updates_as_its_equations_say() -> None:
    """Written out for two features that are never active together, and one action."""
    sarsa = Sarsa(2, 1, 1, 0, seed=1)
    one, two = np.array([0]), np.array([1])
    sarsa.step(one, 0.0, 1.0)
    sarsa.step(two, -1.0, 0.9)  # δ = −1
    assert sarsa.w.tolist() == [[pytest.approx(-0.3), 0.0]]
    sarsa.step(one, -1.0, 0.8)  # δ = −1 + 0.8·(−0.3) − 0; the first's trace is 0.9·0.7
    delta = -1 - 0.8 * 0.3
    assert sarsa.w.tolist() == [[pytest.approx(-0.3 + 0.3 * delta * 0.63), pytest.approx(0.3 * delta)]]


@dataclass
class Blind(Told):
    """Nothing is predicted at one of the timescales."""

    def position(self, joint: int, timescale: float) -> float:
        return math.nan if timescale == TIMESCALES[0] else 0.9


@pytest.mark.parametrize("by", ALL)
def test_an_assist_withdraws_in_the_tick_in_which_what_it_follows_is_lost(by: str) -> None:
    chooser = choice(by)
    help_ = Help("arm", SPECS, RATE, AssistSettings(timescale=10.0), registry.open_assist, chooser)
    help_.change({"mode": "dpcc", "timescale_by": by, "k": 0.5, "velocity_limit_rad_s": 0.1})
    for _ in range(30):
        wishes, _ = help_.wish(situation(-0.9))
        assert wishes == {ELBOW: Velocity(0.1)}
    assert help_.wish(situation(-0.9, moves=False))[0] == {}
    if by == "sarsa":  # follows 10 ticks, of which it loses sight here
        assert help_.wish(situation(-0.9, told=Told(lost=True)))[0] == {}
    else:
        assert help_.wish(situation(-0.9, told=Blind()))[0] == {}


@given(st.floats(allow_nan=True), st.floats(-1e3, 1e3), st.floats(-1e3, 1e3))
def test_the_logistic_function_lies_between_0_and_1_whatever_it_is_given(
    x: float, k: float, x0: float
) -> None:
    value = PURE["logistic"](x, k, x0)
    assert 0 <= value <= 1 or math.isnan(x * k)
    assert PURE["logistic"](x0, k, x0) == 0.5
    assert PURE["logistic"](1.0, 2.0, 0.0) == pytest.approx(1 / (1 + math.exp(-2)))


def test_dice_are_fair_and_go_on_where_they_were() -> None:
    dice = Dice(7)
    thrown = np.array([dice.normal() for _ in range(4000)])
    assert abs(thrown.mean()) < 0.05
    assert thrown.std() == pytest.approx(1, abs=0.05)
    again = Dice(7)
    again.recall(dice.thrown)
    assert [dice.uniform() for _ in range(5)] == [again.uniform() for _ in range(5)]
    with pytest.raises(ValueError, match="not a count"):
        again.recall(-1.0)


def test_while_the_assist_is_off_rewards_are_nobodys() -> None:
    chooser = choice("sarsa")
    live(chooser, 2, lambda expected, best: None)
    chooser.off()
    chooser.rewarded(-5.0)
    chooser.toggled()
    live(chooser, 2, lambda expected, best: None)
    assert not chooser.memory()["sarsa/w"].any()


def test_selecting_another_joint_is_another_state() -> None:
    chooser = choice("sarsa")
    live(chooser, 40, punish(chooser, "sarsa"))
    for _ in range(12):
        seen = chooser.look(replace(situation(0.6), active=ELBOW, attended=ELBOW))
    assert seen.outlook.position(SHOULDER, 10.0) != 0.4
