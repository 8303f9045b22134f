from collections.abc import Iterable

import pytest

from bentod.control.goals import Goals
from bentod.control.leases import Holder, Lease
from bentod.control.modes import Modes
from bentod.errors import Refused
from bentod.frames import Freshness, GoalFrame, JointSpec, JointState, Mode, Position

SPECS = {i: JointSpec(name, -1.0, 1.0, 0.5, 0.1, {}) for i, name in enumerate(("shoulder", "elbow"))}


def _at(*positions: float) -> list[JointState]:
    return [JointState(p, 0.0, 0.0, 12.0, 30.0, 0.0, Freshness.FRESH) for p in positions]


def _lease(expires: float, session: int = 1, joints: Iterable[int] = SPECS) -> Lease[frozenset[int]]:
    return Lease(Holder(session, "page"), frozenset(joints), expires)


class _Rig:
    def __init__(self, released: bool = True) -> None:
        self.modes = Modes(["shoulder", "elbow"], [True, True])
        if released:
            self.modes.pause([0, 1], False)
        self.told: list[GoalFrame] = []
        self.goals = Goals(self.modes, self.told.append)

    def begin(self, lease: Lease[frozenset[int]] | None = None, now: float = 0.0) -> int:
        return self.goals.begin(SPECS, _at(0.6, -0.9), 0.5, now, lease)

    def advance(self, now: float) -> None:
        self.goals.advance(_at(0.6, -0.9), now)

    @property
    def statuses(self) -> list[str]:
        return [frame.status for frame in self.told]


def test_a_goal_is_accepted_moves_and_is_done() -> None:
    rig = _Rig()
    assert rig.begin() == 1
    assert rig.goals.wishes() == {0: Position(0.1, 0.5), 1: Position(0.1, 0.5)}
    rig.goals.advance(_at(0.3, -0.5), now=0.5)
    rig.goals.advance(_at(0.1, 0.1), now=2.0)
    assert rig.statuses == ["accepted", "moving", "done"]
    assert rig.goals.wishes() == {}
    assert rig.modes.of(0) is Mode.ACTIVE


def test_progress_is_told_in_tenths_not_every_tick() -> None:
    rig = _Rig()
    rig.begin()
    for step in range(100):
        rig.goals.advance(_at(0.1, -0.9 + 0.009 * step), now=0.01 * step)
    assert len(rig.told) <= 12
    assert [frame.progress for frame in rig.told] == sorted(frame.progress for frame in rig.told)


def test_a_goal_that_is_not_reached_in_time_is_cancelled() -> None:
    rig = _Rig()
    rig.begin()
    rig.goals.advance(_at(0.6, -0.9), now=60.0)
    assert rig.told[-1].status == "cancelled"
    assert "not there in time" in rig.told[-1].reason


def test_the_wearer_ends_the_homing_of_released_joints() -> None:
    rig = _Rig()
    rig.begin()
    rig.goals.disturb("the wearer moved")
    assert rig.told[-1].reason == "the wearer moved"


def test_paused_joints_go_home_undisturbed_and_are_paused_again() -> None:
    rig = _Rig(released=False)
    rig.begin()
    assert rig.modes.of(0) is Mode.ACTIVE
    rig.goals.disturb("the wearer moved")
    assert rig.goals.wishes()
    rig.goals.advance(_at(0.1, 0.1), now=1.0)
    assert rig.told[-1].status == "done"
    assert rig.modes.of(0) is Mode.PAUSED


def test_only_what_touches_the_goals_joints_cancels_it() -> None:
    rig = _Rig()
    rig.goals.begin({0: SPECS[0]}, _at(0.6, 0.0), 0.5, now=0.0)
    rig.goals.cancel("elbow moved", [1])
    assert rig.goals.wishes()
    rig.goals.cancel("shoulder moved", [0])
    assert rig.goals.wishes() == {}


def test_a_new_goal_cancels_the_old_one() -> None:
    rig = _Rig(released=False)
    rig.begin()
    rig.begin()
    assert rig.statuses == ["accepted", "cancelled", "accepted"]
    assert rig.modes.of(0) is Mode.ACTIVE


def test_a_limp_arm_does_not_go_home() -> None:
    rig = _Rig()
    rig.modes.confirm_torque([True, False])
    with pytest.raises(Refused, match="torque is off on elbow"):
        rig.begin()
    assert rig.told == []


def test_a_goal_without_a_lease_goes_on_when_its_client_is_silent_or_gone() -> None:
    rig = _Rig()
    rig.begin()
    rig.goals.let_go(1, "its client is gone")
    rig.advance(now=3.0)
    assert rig.goals.running


def test_a_leased_goal_ends_when_its_client_falls_silent() -> None:
    rig = _Rig(released=False)
    rig.begin(_lease(0.15))
    rig.advance(now=0.14)
    assert rig.goals.running
    rig.advance(now=0.15)
    assert rig.told[-1].reason == "its lease ran out"
    assert rig.goals.wishes() == {}
    assert rig.modes.of(0) is Mode.PAUSED


def test_asking_again_renews_a_leased_goal_and_begins_no_other() -> None:
    rig = _Rig()
    goal = rig.begin(_lease(0.15))
    for step in range(1, 20):
        assert rig.goals.renew(_lease(0.1 * step + 0.15)) == goal
        rig.advance(now=0.1 * step)
    assert "cancelled" not in rig.statuses
    assert rig.statuses.count("accepted") == 1


def test_a_leased_goal_ends_with_its_client() -> None:
    rig = _Rig()
    rig.begin(_lease(10.0, session=7))
    rig.goals.let_go(8, "its client is gone")
    assert rig.goals.running
    rig.goals.let_go(7, "its client is gone")
    assert rig.told[-1].reason == "its client is gone"


@pytest.mark.parametrize("session", [1, 2])
def test_only_who_holds_a_goal_of_just_these_joints_renews_it(session: int) -> None:
    rig = _Rig()
    rig.begin(_lease(1.0))
    mine = rig.goals.renew(_lease(1.0, session))
    assert mine == (1 if session == 1 else None)
    assert rig.goals.renew(_lease(1.0, session, joints=[0])) is None


def test_what_was_cancelled_is_not_begun_anew_by_who_still_holds_the_button() -> None:
    rig = _Rig(released=False)
    rig.begin(_lease(0.15))
    rig.goals.cancel("stopped by somebody")
    for step in range(1, 20):
        with pytest.raises(Refused, match="goal 1 was cancelled \\(stopped by somebody\\): let go"):
            rig.goals.renew(_lease(0.1 * step + 0.15))
        rig.advance(now=0.1 * step)
    assert not rig.goals.running
    rig.advance(now=5.0)
    assert rig.goals.renew(_lease(5.15)) is None, "who has let go may begin anew"


def test_who_was_replaced_by_another_goal_does_not_take_the_arm_back_by_renewing() -> None:
    rig = _Rig()
    rig.begin(_lease(1.0, session=1))
    rig.begin(_lease(1.0, session=2))
    with pytest.raises(Refused, match="another goal came"):
        rig.goals.renew(_lease(1.1, session=1))
    assert rig.goals.renew(_lease(1.1, session=2)) == 2


def test_a_goal_that_is_done_may_be_renewed_and_moves_nothing() -> None:
    rig = _Rig()
    rig.begin(_lease(0.15))
    rig.goals.advance(_at(0.1, 0.1), now=0.1)
    assert rig.goals.renew(_lease(0.25)) == 1
    rig.goals.advance(_at(0.1, 0.1), now=0.3)
    assert rig.told[-1].status == "done"
    assert rig.goals.wishes() == {}


def test_a_goal_that_is_renewed_by_its_number_never_begins_another() -> None:
    rig = _Rig()
    number = rig.begin(_lease(0.15))
    assert rig.goals.renew(_lease(0.3), number) == number
    rig.goals.cancel("stopped by somebody")
    rig.advance(0.31)  # silent for one lease
    with pytest.raises(Refused, match="does not begin another"):
        rig.goals.renew(_lease(0.5), number)
    with pytest.raises(Refused, match="does not begin another"):
        rig.goals.renew(_lease(0.5), 99)
    assert rig.statuses[-1] == "cancelled"
