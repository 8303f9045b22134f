"""What every assist promises, whatever it is that it helps with."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import pytest

from bentod import registry
from bentod.contracts_assist import Assist, Assistance, AssistSettings, Situation
from bentod.errors import BadRequest
from bentod.frames import JointSpec, Velocity
from tests.fakes import at

pytestmark = pytest.mark.parametrize("mode", sorted(registry.ASSISTS))

RATE_HZ = 30.0
SHOULDER, ELBOW, WRIST = range(3)
SPECS = tuple(JointSpec(name, -1.0, 1.0, 0.5, 0.0, {}) for name in ("shoulder", "elbow", "wrist"))
GROUP = (SHOULDER, ELBOW)
SETTINGS = AssistSettings(k=0.1)


@dataclass(frozen=True)
class Sure:
    """Learners that are sure of everything, but of `unknown` they say nothing."""

    expected: Mapping[int, float]  # rad, by joint
    unknown: frozenset[int] = frozenset()
    answers: float = 0.5  # to any other question
    timescales: tuple[float, ...] = (10.0, 20.0)

    def position(self, joint: int, timescale: float) -> float:
        return math.nan if joint in self.unknown else self.expected[joint]

    def confidence(self, joint: int, timescale: float) -> float:
        return math.nan if joint in self.unknown else 0.97

    def surprise(self, joint: int, timescale: float) -> float:
        return 0.1

    def familiarity(self) -> float:
        return 0.95

    def answer(self, name: str) -> float:
        lost = any(SPECS[joint].name in name for joint in self.unknown)
        return math.nan if lost else self.answers


def new(mode: str) -> Assist:
    return registry.open_assist(mode)(SPECS, RATE_HZ, SETTINGS)


def tick(
    number: int,
    attended: int | None = SHOULDER,
    together: bool = False,
    ahead: float = 0.4,
    unknown: frozenset[int] = frozenset(),
) -> Situation:
    """The shoulder goes up at 0.3 rad/s, or both joints do, and is expected `ahead` (rad) of there."""
    moves = attended is not None or together
    place = 0.01 * number if moves else 0.0
    seen = at(place, place if together else 0.0, 0.0, velocity=0.3 if moves else 0.0, time=number / RATE_HZ)
    expected = {SHOULDER: place + ahead, ELBOW: place + ahead, WRIST: 0.5}
    return Situation(
        time=number / RATE_HZ,
        rate_hz=RATE_HZ,
        joints=GROUP,
        active=SHOULDER,
        attended=None if together else attended,
        effort=0.6 if moves else 0.0,
        together=together,
        state=seen,
        outlook=Sure(expected, unknown, 0.5 if math.isfinite(ahead) else ahead),
        group="arm",
    )


def situations(together: bool) -> Iterator[Situation]:
    """Two seconds of somebody who moves."""
    return (tick(number, together=together) for number in range(60))


def speeds(helped: Assistance) -> dict[int, float]:
    assert all(isinstance(wish, Velocity) for wish in helped.wishes.values())
    return {j: wish.velocity for j, wish in helped.wishes.items() if isinstance(wish, Velocity)}


def under_way(mode: str) -> tuple[Assist, bool]:
    """An assist that moves a joint, and whether that needs all joints together; skips one that never does."""
    for together in (False, True):
        assist = new(mode)
        last = [assist.wish(situation) for situation in situations(together)][-1]
        if last.wishes:
            return assist, together
    pytest.skip(f"{mode} moves nothing")


@pytest.mark.parametrize("together", [False, True])
def test_wishes_are_finite_and_within_the_limits_of_joints_of_the_group(mode: str, together: bool) -> None:
    assist = new(mode)
    for situation in situations(together):
        helped = assist.wish(situation)
        assert set(helped.wishes) <= set(GROUP)
        assert all(abs(speed) <= 0.5 for speed in speeds(helped).values())
        assert helped.reason


def test_the_joint_that_the_user_moves_is_never_wished_for(mode: str) -> None:
    assist = new(mode)
    for number in range(120):
        attended = (SHOULDER, ELBOW)[number // 40 % 2]
        assert attended not in assist.wish(tick(number, attended)).wishes


def test_nothing_moves_while_nobody_moves_anything(mode: str) -> None:
    assist, together = under_way(mode)
    for number in range(60, 120):
        resting = replace(tick(number, attended=None), together=together)
        assert assist.wish(resting).wishes == {}


def test_a_lower_velocity_limit_is_kept(mode: str) -> None:
    _, together = under_way(mode)
    assist = new(mode)
    assist.adjust(replace(SETTINGS, velocity_limit=0.05))
    for situation in situations(together):
        assert all(abs(speed) <= 0.05 for speed in speeds(assist.wish(situation)).values())


def test_the_same_again_is_answered_the_same_to_the_last_bit(mode: str) -> None:
    for together in (False, True):
        one, other = new(mode), new(mode)
        for situation in situations(together):
            assert one.wish(situation) == other.wish(situation)


def test_a_toggle_ends_help_in_its_tick(mode: str) -> None:
    assist, together = under_way(mode)
    assist.toggled(60 / RATE_HZ)
    assert assist.wish(tick(60, together=together)).wishes == {}


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_a_prediction_that_is_not_finite_moves_nothing_in_its_tick(mode: str, value: float) -> None:
    assist, together = under_way(mode)
    assert assist.wish(tick(60, together=together, ahead=value)).wishes == {}


def test_a_joint_of_which_nothing_is_predicted_any_more_is_let_go_in_that_tick(mode: str) -> None:
    assist, together = under_way(mode)
    lost = frozenset(GROUP if together else (ELBOW,))
    assert assist.wish(tick(60, together=together, unknown=lost)).wishes == {}


def test_an_unknown_option_is_refused_by_its_name_and_changes_nothing(mode: str) -> None:
    changed, other = new(mode), new(mode)
    with pytest.raises(BadRequest, match="nonsense"):
        changed.adjust(replace(SETTINGS, options={"nonsense": 1.0}))
    for together in (False, True):
        for situation in situations(together):
            assert changed.wish(situation) == other.wish(situation)


def test_what_was_found_out_can_be_told_at_any_time(mode: str) -> None:
    assist = new(mode)
    assist.told()
    assist.rewarded(1.0)
    assist.rewarded(-1.0)
    assert assist.order(tick(0)) is None or set(assist.order(tick(0)) or ()) >= set(GROUP)
    assert {type(key) for key in assist.told()} <= {str}
