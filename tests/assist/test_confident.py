"""Help that comes when it is sure, goes when it is not wanted, and says why."""

import math
from dataclasses import dataclass, replace
from itertools import pairwise

import pytest

from bentod.assist.confident import ConfidentDpcc
from bentod.assist.confident_options import ConfidentOptions, confident_options
from bentod.assist.fade import Evidence, Fade, Gate
from bentod.assist.trust import Trust
from bentod.contracts_assist import Assistance, AssistSettings, Situation
from bentod.errors import BadRequest
from bentod.frames import JointSpec, JointState, State, Velocity
from tests.fakes import PERIOD, at

SHOULDER, ELBOW = 0, 1
SPECS = tuple(JointSpec(name, -1.5, 1.5, 2.0, 0.0, {}) for name in ("shoulder_rotation", "elbow_flexion"))
STRICT = {"confidence": 0.75, "slope": 2.0, "doubt": 0.4, "recovery": 5.0, "introduction": 0.0, "ground": 0.0}
"""For somebody who knows the arm, and trusts it less than the defaults do; wherever it has been."""
SETTINGS = AssistSettings(k=0.1, options={**STRICT, "fade": 0.5})
OPTIONS = ConfidentOptions(**STRICT)
SURE = Evidence(confidence=0.9, surprise=0.1, familiarity=0.9)


@dataclass(frozen=True)
class Told:
    """What learners say of both joints."""

    expected: tuple[float, float]
    sure: Evidence = SURE
    timescales: tuple[float, ...] = (20.0,)

    def position(self, joint: int, timescale: float) -> float:
        return self.expected[joint]

    def confidence(self, joint: int, timescale: float) -> float:
        return self.sure.confidence

    def surprise(self, joint: int, timescale: float) -> float:
        return self.sure.surprise

    def familiarity(self) -> float:
        return self.sure.familiarity

    def answer(self, name: str) -> float:
        return math.nan


class Arm:
    """A shoulder and an elbow; the assist's wishes come true within the tick."""

    def __init__(self, settings: AssistSettings = SETTINGS) -> None:
        self.assist = ConfidentDpcc(SPECS, 1 / PERIOD, settings)
        self.positions = [0.0, 0.0]
        self.time = 100.0

    def live(
        self,
        seconds: float,
        own: float = 0.3,
        attended: int | None = SHOULDER,
        effort: float | None = None,
        elbow_ahead: float = 0.3,
        own_ahead: float = 0.3,
        sure: Evidence = SURE,
    ) -> list[float]:
        """Speeds that the assist asks of the other joint, while the user moves one at `own` rad/s."""
        other = ELBOW if attended in (SHOULDER, None) else SHOULDER
        asked = []
        for _ in range(round(seconds / PERIOD)):
            self.helped = self.tick(own, attended, effort, elbow_ahead, own_ahead, sure)
            asked.append(speed(self.helped, other))
            self.positions[other] += asked[-1] * PERIOD
            if attended is not None:
                self.positions[attended] += own * PERIOD
            self.time += PERIOD
        return asked

    def tick(
        self,
        own: float,
        attended: int | None,
        effort: float | None,
        elbow_ahead: float,
        own_ahead: float,
        sure: Evidence,
    ) -> Assistance:
        other = ELBOW if attended in (SHOULDER, None) else SHOULDER
        ahead = [own_ahead, own_ahead]
        ahead[other] = elbow_ahead
        first, second = (p + d for p, d in zip(self.positions, ahead, strict=True))
        state = moving(self.positions, attended, own, self.time)
        pushed = math.copysign(0.5, own) if effort is None else effort
        return self.assist.wish(
            Situation(
                time=self.time,
                rate_hz=1 / PERIOD,
                joints=(SHOULDER, ELBOW),
                active=SHOULDER if attended is None else attended,
                attended=attended,
                effort=pushed,
                together=False,
                state=state,
                outlook=Told((first, second), sure),
            )
        )

    def toggle(self) -> None:
        self.assist.toggled(self.time)


def moving(positions: list[float], attended: int | None, own: float, time: float) -> State:
    joints = at(*positions, time=time).joints
    return State(time, tuple(_going(joint, own if i == attended else 0.0) for i, joint in enumerate(joints)))


def _going(joint: JointState, velocity: float) -> JointState:
    return replace(joint, velocity=velocity)


def speed(helped: Assistance, joint: int) -> float:
    wish = helped.wishes.get(joint)
    return wish.velocity if isinstance(wish, Velocity) else 0.0


def test_help_says_what_it_follows_how_far_ahead_and_how_sure_it_is() -> None:
    arm = Arm()
    arm.live(1.0)
    assert arm.helped.engaged
    assert arm.helped.reason == "elbow flexion follows its 0.7 s prediction, confidence 0.90."


def test_help_fades_in_without_a_jump_and_is_out_at_once() -> None:
    arm = Arm()
    asked = arm.live(1.0)
    assert asked[0] < 0.1
    assert all(later - sooner <= OPTIONS.acceleration * PERIOD + 1e-9 for sooner, later in pairwise(asked))
    assert asked[10] < asked[-1] == pytest.approx(0.6)  # twice the shoulder's 0.3 rad/s
    assert arm.live(PERIOD, sure=replace(SURE, confidence=0.3)) == [0.0]


@pytest.mark.parametrize(
    ("sure", "reason"),
    [
        (replace(SURE, familiarity=0.1), "this posture is new"),
        (replace(SURE, surprise=5.0), "things do not go as expected"),
        (replace(SURE, confidence=0.4), "confidence 0.40 is below 0.65"),
        (replace(SURE, confidence=math.nan), "nobody says how sure this prediction is"),
    ],
)
def test_help_withdraws_in_the_tick_in_which_it_is_not_sure_and_says_so(sure: Evidence, reason: str) -> None:
    arm = Arm()
    assert arm.live(1.0)[-1] > 0
    assert arm.live(PERIOD, sure=sure) == [0.0]
    assert (arm.helped.engaged, arm.helped.reason) == (False, f"elbow flexion waits: {reason}.")


def test_help_withdraws_in_the_tick_in_which_its_prediction_is_lost() -> None:
    arm = Arm()
    assert arm.live(1.0)[-1] > 0
    assert arm.live(PERIOD, elbow_ahead=math.nan) == [0.0]
    assert arm.helped.reason == "elbow flexion waits: there is no prediction for it."


def test_help_withdraws_when_the_user_goes_another_way_than_expected() -> None:
    arm = Arm()
    assert arm.live(1.0)[-1] > 0
    assert arm.live(PERIOD, own_ahead=-0.3) == [0.0]
    assert arm.helped.reason == "elbow flexion waits: you go another way than usual."


def test_a_familiarity_or_surprise_that_nobody_estimates_is_no_obstacle() -> None:
    assert Arm().live(1.0, sure=Evidence(0.9, math.nan, math.nan))[-1] > 0


def test_a_gate_that_is_open_stays_open_for_less_than_it_takes_to_open_it() -> None:
    gate = Gate()
    between = Evidence(0.7, 1.5, 0.45)
    assert gate.look(between, OPTIONS)
    assert not gate.look(Evidence(0.8, 0.5, 0.6), OPTIONS)
    assert not gate.look(between, OPTIONS)
    assert gate.look(Evidence(0.6, 0.5, 0.6), OPTIONS)


def test_a_joint_goes_at_most_so_much_as_the_user_accounts_for() -> None:
    slow, fast = Arm(), Arm()
    assert slow.live(2.0, own=0.05)[-1] == pytest.approx(0.1)
    assert fast.live(2.0, own=0.2)[-1] == pytest.approx(0.4)


def test_help_stops_while_the_user_pushes_and_the_joint_does_not_go() -> None:
    arm = Arm()
    arm.live(1.0)
    assert arm.live(PERIOD, own=0.0, effort=0.5) == [0.0]


def test_help_stops_in_the_tick_in_which_the_user_reverses() -> None:
    arm = Arm()
    arm.live(1.0)
    assert arm.live(PERIOD, own=0.3, effort=-0.5, own_ahead=-0.3) == [0.0]


def test_an_unattended_joint_does_not_drift_while_the_user_hesitates() -> None:
    arm = Arm()
    arm.live(1.0)
    before = arm.positions[ELBOW]
    for _ in range(10):
        arm.live(0.5, own=0.0, attended=None)
        arm.live(0.1, own=0.0, effort=0.5)
    assert arm.positions[ELBOW] == before


def correct(arm: Arm, back: float = -0.3) -> None:
    """The user toggles to the elbow that was helped, and moves it."""
    arm.toggle()
    arm.live(0.3, own=back, attended=ELBOW)


def test_who_toggles_and_moves_the_joint_back_is_not_helped_with_it_for_a_while() -> None:
    arm = Arm()
    arm.live(1.0)
    correct(arm)
    arm.toggle()
    assert set(arm.live(1.0)[1:]) == {0.0}
    assert arm.helped.reason == "elbow flexion holds back: you corrected it 1 s ago."
    arm.live(1.0)
    assert 0 < max(arm.live(1.0)) < 0.6


def test_who_moves_the_joint_on_has_corrected_nothing() -> None:
    arm = Arm()
    arm.live(1.0)
    correct(arm, back=0.3)
    assert arm.assist.told()["corrections"] == {"shoulder_rotation": 0, "elbow_flexion": 0}
    assert arm.assist.told()["trust"] == {"shoulder_rotation": 1.0, "elbow_flexion": 1.0}


def test_moving_a_joint_back_after_a_rest_is_a_way_back_and_no_correction() -> None:
    arm = Arm()
    arm.live(1.0)
    arm.toggle()
    arm.live(5.0, own=0.0, attended=None)
    arm.live(0.3, own=-0.3, attended=ELBOW)
    assert arm.assist.told()["corrections"] == {"shoulder_rotation": 0, "elbow_flexion": 0}


def test_trust_that_a_correction_cost_comes_back_with_undisturbed_help() -> None:
    arm = Arm(replace(SETTINGS, options={**STRICT, "recovery": 0.1, "hold_back": 1.0}))
    arm.live(1.0)
    correct(arm)
    assert arm.assist.told()["trust"] == {"shoulder_rotation": 1.0, "elbow_flexion": 0.6}
    arm.toggle()
    arm.live(4.0)
    regained = arm.assist.told()["trust"]
    assert isinstance(regained, dict)
    assert regained["elbow_flexion"] == 1.0


def test_a_toggle_just_after_help_began_costs_a_little_trust_and_a_late_one_none() -> None:
    trust = Trust()
    for number in range(10):
        trust.helped(0.01, 100 + number * PERIOD, PERIOD, OPTIONS)
    late = Trust()
    for number in range(60):
        late.helped(0.01, 100 + number * PERIOD, PERIOD, OPTIONS)
    trust.toggled(100.4, OPTIONS)
    late.toggled(102.0, OPTIONS)
    assert 0.9 < trust.value < late.value == 1.0


def test_a_reward_moves_the_trust_in_what_was_helped_last() -> None:
    arm = Arm()
    arm.live(1.0)
    arm.assist.rewarded(-1.0)
    assert arm.assist.told()["trust"] == {"shoulder_rotation": 1.0, "elbow_flexion": 0.8}
    arm.assist.rewarded(math.nan)
    arm.assist.rewarded(1.0)
    assert arm.assist.told()["trust"] == {"shoulder_rotation": 1.0, "elbow_flexion": 0.84}


def test_after_a_toggle_it_is_manual_and_then_help_begins_from_rest() -> None:
    arm = Arm()
    arm.live(2.0)
    arm.toggle()
    assert set(arm.live(0.45)) == {0.0}
    assert arm.helped.reason == "Manual for 0.5 s after a toggle."
    begins = arm.live(0.3)
    assert max(begins[:3]) <= 3 * OPTIONS.acceleration * PERIOD
    assert begins[-1] > 0


def test_a_joint_that_is_about_where_it_is_expected_rests_and_says_so() -> None:
    arm = Arm()
    assert set(arm.live(1.0, elbow_ahead=0.001)) == {0.0}
    assert arm.helped.reason == "elbow flexion is about where it is expected."


def test_a_velocity_that_turns_round_begins_from_rest() -> None:
    fade = Fade()
    fade.velocity = 0.5
    assert fade.ask(-0.5, 0.1) == -0.1
    assert fade.ask(-0.5, 0.1) == pytest.approx(-0.2)
    assert fade.ask(-0.05, 0.1) == -0.05


@pytest.mark.parametrize(
    ("name", "value"),
    [("confidence", 1.5), ("surprise", 0.0), ("slope", 0.0), ("fade", math.nan), ("recovery", 601.0)],
)
def test_an_option_out_of_its_bounds_is_refused_by_name_and_nothing_changes(name: str, value: float) -> None:
    arm = Arm()
    with pytest.raises(BadRequest, match=f"The assistance's {name} must be") as refusal:
        arm.assist.adjust(replace(SETTINGS, options={name: value}))
    assert refusal.value.field == name
    assert arm.live(1.0) == Arm().live(1.0)


def test_a_misspelt_option_is_told_the_nearest_one() -> None:
    with pytest.raises(BadRequest, match=r"no option 'hold_bak'.*hold_back"):
        confident_options({"hold_bak": 1.0})


def test_who_does_not_know_help_yet_gets_a_little_of_it_first_and_then_all() -> None:
    known, new = (
        Arm(),
        Arm(replace(SETTINGS, options={**STRICT, "fade": 0.0, "first": 0.2, "introduction": 5.0})),
    )
    known.live(1.0)
    first = new.live(0.3)[-1]
    assert 0.2 * 0.3 < first < 0.6 * 0.3
    assert new.live(6.0)[-1] == pytest.approx(known.live(6.0)[-1], abs=0.01)
