import math
from collections.abc import Callable
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bentod.assist.dpcc import Assistance, Dpcc, DpccSettings, dpcc_velocity
from bentod.errors import BadRequest
from bentod.frames import JointSpec, Velocity, Wishes

SHOULDER, ELBOW, WRIST, HAND = range(4)
GROUP = (SHOULDER, ELBOW, WRIST)
ON = DpccSettings(enabled=True, k=0.1)
STILL = [0.0, 0.0, 0.0, 0.0]


def joint(name: str) -> JointSpec:
    return JointSpec(name, minimum=-1.5, maximum=1.5, max_velocity=2.0, home=0.0, hardware={})


def dpcc(settings: DpccSettings = ON) -> Dpcc:
    return Dpcc([joint(name) for name in ("shoulder", "elbow", "wrist", "hand")], 30.0, settings)


def ask(
    assist: Dpcc,
    predictions: dict[int, float],
    now: float = 100.0,
    moving: int | None = SHOULDER,
    positions: list[float] = STILL,
) -> Assistance:
    return assist.wish(now, moving, GROUP, positions, predictions)


def velocities(wishes: Wishes) -> dict[int, float]:
    return {j: command.velocity for j, command in wishes.items() if isinstance(command, Velocity)}


@given(st.floats(-3, 3), st.floats(-3, 3), st.floats(0.01, 0.99))
def test_the_velocity_covers_the_share_k_of_the_way_in_one_tick(p: float, theta: float, k: float) -> None:
    travelled = dpcc_velocity(p, theta, 30.0, k) / 30.0
    assert travelled == pytest.approx(k * (p - theta), abs=1e-12)


def test_unattended_joints_go_where_they_are_expected_while_the_operator_moves() -> None:
    answer = ask(dpcc(), {SHOULDER: 1.0, ELBOW: 0.3, WRIST: -0.1})
    assert velocities(answer.wishes) == pytest.approx({ELBOW: 0.9, WRIST: -0.3})
    assert answer.frame.engaged
    assert answer.frame.mode == "dpcc"
    assert answer.frame.reason == "Moves elbow, wrist to where the operator usually has it."


def test_joints_of_other_groups_are_left_alone() -> None:
    assert set(ask(dpcc(), {ELBOW: 0.3, HAND: 1.0}).wishes) == {ELBOW}


@pytest.mark.parametrize("moving", [None, HAND])
def test_nothing_moves_unless_the_operator_moves_a_joint_of_the_group(moving: int | None) -> None:
    answer = ask(dpcc(), {ELBOW: 0.3}, moving=moving)
    assert answer.wishes == {}
    assert not answer.frame.engaged
    assert answer.frame.reason == "The operator is not moving a joint of this group."


def test_nothing_moves_while_assistance_is_off() -> None:
    answer = ask(dpcc(DpccSettings()), {ELBOW: 0.3})
    assert answer.wishes == {}
    assert (answer.frame.mode, answer.frame.engaged) == ("off", False)
    assert answer.frame.reason == "Assistance is switched off."


def test_after_a_toggle_it_is_manual_for_half_a_second() -> None:
    assist = dpcc()
    assist.toggled(100.0)
    for now in (100.0, 100.2, 100.499):
        answer = ask(assist, {ELBOW: 0.3}, now=now)
        assert answer.wishes == {}
        assert answer.frame.reason == "Manual for 0.5 s after a toggle."
    assert set(ask(assist, {ELBOW: 0.3}, now=100.5).wishes) == {ELBOW}


def test_each_toggle_starts_the_manual_time_anew() -> None:
    assist = dpcc()
    assist.toggled(100.0)
    assist.toggled(100.4)
    assert not ask(assist, {ELBOW: 0.3}, now=100.8).frame.engaged
    assert ask(assist, {ELBOW: 0.3}, now=100.9).frame.engaged


def test_no_joint_goes_faster_than_its_maximum() -> None:
    assert velocities(ask(dpcc(), {ELBOW: 1.5, WRIST: -1.5}).wishes) == {ELBOW: 2.0, WRIST: -2.0}


def test_a_lower_limit_can_be_set_for_a_joint_but_not_a_higher_one() -> None:
    settings = replace(ON, velocity_limits={ELBOW: 0.2, WRIST: 50.0})
    assert velocities(ask(dpcc(settings), {ELBOW: 1.5, WRIST: 1.5}).wishes) == {ELBOW: 0.2, WRIST: 2.0}


def test_a_prediction_outside_the_limits_of_a_joint_leads_to_the_limit() -> None:
    positions = [0.0, 1.45, 0.0, 0.0]
    answer = ask(dpcc(), {ELBOW: 40.0}, positions=positions)
    assert velocities(answer.wishes) == pytest.approx({ELBOW: 0.15})


def test_a_joint_that_is_where_it_is_expected_is_not_moved() -> None:
    answer = ask(dpcc(), {ELBOW: 0.0, WRIST: 0.001})
    assert answer.wishes == {}
    assert answer.frame.engaged
    assert answer.frame.reason == "Every unattended joint is about where it is expected."


def test_noise_around_the_dead_band_does_not_switch_a_joint_on_and_off() -> None:
    assist = dpcc(replace(ON, dead_band=0.03))
    above, below = 0.0145, 0.0055  # V is 0.0435 and 0.0165 rad/s, around the dead band
    resting = [bool(ask(assist, {ELBOW: p}).wishes) for p in (above, below, above)]
    assert resting == [False, False, False]
    moving = [bool(ask(assist, {ELBOW: p}).wishes) for p in (0.05, above, above, below, above)]
    assert moving == [True, True, True, False, False]


def test_a_joint_turns_round_only_for_a_velocity_that_is_worth_it() -> None:
    assist = dpcc(replace(ON, dead_band=0.03))
    wished = [velocities(ask(assist, {ELBOW: p}).wishes).get(ELBOW) for p in (0.05, -0.0145, -0.05)]
    assert wished == [pytest.approx(0.15), None, pytest.approx(-0.15)]


def test_without_a_dead_band_a_velocity_of_0_is_still_not_wished() -> None:
    assert ask(dpcc(replace(ON, dead_band=0.0)), {ELBOW: 0.0}).wishes == {}


def test_a_joint_without_a_prediction_is_held() -> None:
    answer = ask(dpcc(), {SHOULDER: 0.4})
    assert answer.wishes == {}
    assert not answer.frame.engaged
    assert answer.frame.reason == "No unattended joint has a prediction at 20 steps."


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_nothing_is_wished_from_a_number_that_is_not_finite(value: float) -> None:
    assert ask(dpcc(), {ELBOW: value}).wishes == {}
    assert ask(dpcc(), {ELBOW: 0.3}, positions=[0.0, value, 0.0, 0.0]).wishes == {}


def test_settings_can_be_replaced_while_the_arm_is_in_use() -> None:
    assist = dpcc()
    assist.settings = replace(ON, k=0.2)
    assert velocities(ask(assist, {ELBOW: 0.3}).wishes) == pytest.approx({ELBOW: 1.8})
    assist.settings = replace(assist.settings, enabled=False)
    assert ask(assist, {ELBOW: 0.3}).wishes == {}


def test_an_assisted_joint_settles_where_it_is_expected_and_never_overshoots() -> None:
    assist = dpcc()
    elbow = 0.0
    for _ in range(120):
        wish = velocities(ask(assist, {ELBOW: 0.3}, positions=[0.0, elbow, 0.0, 0.0]).wishes)
        elbow += wish.get(ELBOW, 0.0) / 30
        assert elbow <= 0.3
    assert elbow == pytest.approx(0.3, abs=ON.dead_band / (30 * ON.k))


@pytest.mark.parametrize(
    ("name", "build"),
    [
        ("k", lambda: DpccSettings(k=0.0)),
        ("k", lambda: DpccSettings(k=1.0)),
        ("k", lambda: DpccSettings(k=math.nan)),
        ("timescale", lambda: DpccSettings(timescale=0.5)),
        ("dead_band", lambda: DpccSettings(dead_band=-0.1)),
        ("manual", lambda: DpccSettings(manual=-1.0)),
        ("velocity_limits", lambda: DpccSettings(velocity_limits={ELBOW: 0.0})),
    ],
)
def test_a_setting_out_of_bounds_is_refused_by_name(name: str, build: Callable[[], DpccSettings]) -> None:
    with pytest.raises(BadRequest, match=f"The assistance's {name} must be") as refusal:
        build()
    assert refusal.value.field == name
