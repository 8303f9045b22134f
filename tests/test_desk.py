"""What may be asked of the arm between two ticks, and what comes of it."""

from collections.abc import Callable
from dataclasses import replace

import pytest

from bentod.control.leases import Holder
from bentod.control.operators import Asked
from bentod.desk import Desk
from bentod.errors import BadRequest, Refused
from bentod.frames import Mode, Position, Velocity
from tests.fakes import at, desk_of

SHOULDER, ELBOW = 0, 1
ANN, BOB = Holder(1, "ann"), Holder(2, "bob")


@pytest.fixture
def desk() -> Desk:
    """Both joints released at 0.5 rad, and nothing to tell."""
    desk = desk_of()
    desk.watch(at(0.5, 0.5), 0.0)
    desk.pause((SHOULDER, ELBOW), False)
    desk.operate({"emg": Asked({"arm": 0.0})})
    desk.journal.take()
    return desk


def told(desk: Desk, kind: str = "") -> list[str]:
    """Texts of the events since the last look."""
    return [event.text for event in desk.journal.take() if kind in ("", event.kind)]


def pull_cable(desk: Desk, now: float = 1.0) -> None:
    silent = tuple(replace(joint, age=0.6) for joint in at(0.5, 0.5).joints)
    desk.watch(replace(at(time=now), joints=silent, problem="The cable is pulled."), now)


def test_all_joints_are_meant_by_none_and_one_by_its_name(desk: Desk) -> None:
    assert desk.select(None) == (SHOULDER, ELBOW)
    assert desk.select("elbow") == (ELBOW,)
    assert desk.select(["elbow", "shoulder"]) == (ELBOW, SHOULDER)
    with pytest.raises(BadRequest, match="did you mean 'elbow'"):
        desk.select(["shoulder", "ellbow"])


def test_each_verb_is_told_once_with_the_joints_it_meant(desk: Desk) -> None:
    desk.pause((ELBOW,), True)
    desk.pause((SHOULDER, ELBOW), False)
    desk.torque((SHOULDER,), False)
    desk.set_meta({"trial": 3})
    desk.pause_muscles(True)
    assert told(desk) == [
        "elbow paused",
        "the arm released",
        "torque off asked for shoulder",
        "meta set",
        "EMG paused",
    ]
    assert told(desk) == []


def test_events_carry_the_time_of_the_last_reading(desk: Desk) -> None:
    desk.watch(at(0.5, 0.5), 12.5)
    desk.set_meta("x")
    assert [(event.time, event.kind, event.data) for event in desk.journal.take()] == [
        (12.5, "meta", {"meta": "x"})
    ]


def test_a_wish_ends_with_its_lease_or_when_it_is_renewed_later(desk: Desk) -> None:
    desk.move(SHOULDER, Velocity(0.2), ANN, 0.5)
    desk.watch(at(0.5, 0.5), 0.4)
    assert desk.clients.wishes() == {SHOULDER: Velocity(0.2)}
    desk.move(SHOULDER, Velocity(0.3), ANN, 0.5)
    desk.watch(at(0.5, 0.5), 0.8)
    assert desk.clients.wishes() == {SHOULDER: Velocity(0.3)}
    desk.watch(at(0.5, 0.5), 0.91)
    assert desk.clients.wishes() == {}


def test_no_lease_is_longer_than_the_config_allows(desk: Desk) -> None:
    desk.move(SHOULDER, Velocity(0.2), ANN, 10.0)
    desk.watch(at(0.5, 0.5), 2.01)
    assert desk.clients.wishes() == {}


def test_a_joint_or_group_that_one_client_holds_is_refused_to_another(desk: Desk) -> None:
    desk.move(SHOULDER, Velocity(0.2), ANN, 1.0)
    with pytest.raises(Refused, match="'ann' holds it"):
        desk.move(SHOULDER, Velocity(-0.2), BOB, 1.0)
    with pytest.raises(Refused, match="'ann' holds it"):
        desk.group_command("arm", -0.5, BOB, 1.0)


def test_of_one_clients_wishes_for_a_joint_the_last_one_holds(desk: Desk) -> None:
    desk.group_command("arm", 1.0, BOB, 1.0)
    assert (desk.clients.wishes(), desk.clients.holder(SHOULDER)) == ({SHOULDER: Velocity(0.5)}, BOB)
    desk.move(SHOULDER, Velocity(-0.1), BOB, 1.0)
    assert (desk.clients.wishes(), desk.clients.holder(SHOULDER)) == ({SHOULDER: Velocity(-0.1)}, BOB)


def test_all_wishes_of_a_client_go_with_it_and_nobody_elses(desk: Desk) -> None:
    desk.move(SHOULDER, Velocity(0.2), ANN, 1.0)
    desk.move(ELBOW, Velocity(0.2), BOB, 1.0)
    desk.group_command("arm", 0.5, ANN, 1.0)
    desk.clients.vanish(ANN.session)
    assert desk.clients.wishes() == {ELBOW: Velocity(0.2)}
    assert desk.clients.holder(SHOULDER) is None


def test_a_groups_wish_ends_with_a_toggle(desk: Desk) -> None:
    desk.group_command("arm", 1.0, ANN, 1.0)
    desk.toggle("arm", 1, "ann")
    assert desk.clients.wishes() == {}
    assert told(desk, "group") == ["ann switched arm to elbow"]


@pytest.mark.parametrize(
    ("restrain", "remedy"),
    [
        (lambda desk: desk.pause((SHOULDER,), True), r"shoulder is paused: release it \(pause off\) first"),
        (lambda desk: desk.torque_confirmed((False, True)), "shoulder is limp: switch torque on and release"),
        (lambda desk: desk.fault("smoke"), r"shoulder is fault: clear_fault first \(smoke\)"),
    ],
)
def test_a_restrained_joint_refuses_to_move_and_says_what_to_do_first(
    desk: Desk, restrain: Callable[[Desk], None], remedy: str
) -> None:
    restrain(desk)
    for ask in (
        lambda: desk.move(SHOULDER, Velocity(0.1), ANN, 1.0),
        lambda: desk.group_command("arm", 0.1, ANN, 1.0),
    ):
        with pytest.raises(Refused, match=remedy):
            ask()
    assert desk.clients.wishes() == {}


def test_stop_drops_every_wish_and_goal_and_pauses_every_joint(desk: Desk) -> None:
    desk.go_home((ELBOW,))
    desk.move(SHOULDER, Velocity(0.2), ANN, 1.0)
    desk.stop("bob")
    assert (desk.clients.wishes(), desk.goals.wishes()) == ({}, {})
    assert desk.modes.arm is Mode.PAUSED
    assert told(desk, "goal")[-1] == "go_home cancelled, 0%: stopped by bob"
    desk.pause((SHOULDER, ELBOW), False)
    assert desk.clients.wishes() == {}


def test_stop_is_never_refused() -> None:
    limp = desk_of(torque=(False, False))
    limp.stop("ann")
    limp.fault("smoke")
    limp.stop("ann")
    assert limp.modes.fault == "smoke"


def test_a_fault_drops_every_wish_and_tells_only_its_first_reason(desk: Desk) -> None:
    desk.go_home((ELBOW,))
    desk.move(SHOULDER, Velocity(0.2), ANN, 1.0)
    desk.fault("smoke")
    desk.fault("fire")
    assert (desk.clients.wishes(), desk.goals.wishes()) == ({}, {})
    assert told(desk, "fault") == ["smoke"]
    assert desk.modes.fault == "smoke"


def test_a_fault_whose_cause_persists_cannot_be_cleared(desk: Desk) -> None:
    with pytest.raises(Refused, match="there is no fault to clear"):
        desk.clear_fault()
    pull_cable(desk)
    with pytest.raises(Refused, match=r"the cause is still there: no answer .* The cable is pulled\."):
        desk.clear_fault()
    desk.watch(at(0.5, 0.5), 2.0)
    desk.clear_fault()
    assert desk.modes.arm is Mode.HOLDING
    assert told(desk, "fault")[1:] == ["fault cleared; joints stay paused"]


def test_a_cable_that_stays_pulled_is_told_once(desk: Desk) -> None:
    for tick in range(10):
        pull_cable(desk, 1.0 + tick / 30)
    assert len(told(desk, "fault")) == 1


def test_torque_that_failed_is_told_even_in_a_fault(desk: Desk) -> None:
    desk.fault("smoke")
    desk.torque_failed("no reply")
    assert told(desk, "fault") == ["smoke", "torque could not be switched: no reply"]
    assert desk.modes.fault == "smoke"


def test_torque_is_told_when_the_hardware_has_it(desk: Desk) -> None:
    desk.torque((SHOULDER, ELBOW), False)
    assert told(desk) == ["torque off asked for the arm"]
    desk.torque_confirmed((True, False))
    desk.torque_confirmed((True, False))
    assert told(desk) == ["torque is off: elbow"]


def test_a_servo_that_was_reset_is_a_fault_that_names_it(desk: Desk) -> None:
    desk.torque_found((True, False))
    assert desk.modes.fault == "elbow lost torque unasked: power or servo was reset"
    assert not desk.modes.has_torque(ELBOW)
    assert desk.modes.wanted_torque == (True, False)


def test_what_a_servo_complains_of_is_told_when_it_begins_and_ends(desk: Desk) -> None:
    hot = at(0.5, 0.5)
    shoulder = replace(hot.joints[0], errors=("Overheating Error",))
    for _ in range(3):
        desk.watch(replace(hot, joints=(shoulder, hot.joints[1])), 1.0)
    desk.watch(hot, 2.0)
    assert told(desk, "servo") == ["shoulder reports Overheating Error", "shoulder reports no error any more"]


def test_the_arm_is_not_sent_home_before_it_is_known_where_it_is() -> None:
    desk = desk_of()
    with pytest.raises(Refused, match="has not been read yet"):
        desk.go_home((SHOULDER,))


def test_homing_asks_each_joint_to_go_at_the_configured_speed(desk: Desk) -> None:
    assert desk.go_home((SHOULDER, ELBOW)) == 1
    assert desk.goals.wishes() == {SHOULDER: Position(0.0, 0.35), ELBOW: Position(0.0, 0.35)}
    assert [event.data["status"] for event in desk.journal.take() if event.kind == "goal"] == ["accepted"]
    assert desk.go_home((ELBOW,)) == 2


@pytest.mark.parametrize(
    "disturb",
    [
        lambda desk: desk.move(SHOULDER, Velocity(0.1), ANN, 1.0),
        lambda desk: desk.group_command("arm", 0.1, ANN, 1.0),
        lambda desk: desk.operate({"emg": Asked({"arm": 0.1})}),
        lambda desk: desk.operate({"emg": Asked({}, ["arm"])}),
        lambda desk: desk.pause((SHOULDER,), True),
        lambda desk: desk.torque((SHOULDER,), True),
        lambda desk: desk.stop("ann"),
        lambda desk: desk.fault("smoke"),
    ],
)
def test_any_sign_of_an_operator_ends_a_homing(desk: Desk, disturb: Callable[[Desk], object]) -> None:
    desk.go_home((SHOULDER,))
    disturb(desk)
    assert desk.goals.wishes() == {}
    assert told(desk, "goal")[-1].startswith("go_home cancelled, 0%: ")


def test_muscles_at_rest_do_not_end_a_homing(desk: Desk) -> None:
    desk.go_home((SHOULDER,))
    assert desk.operate({"emg": Asked({"arm": 0.0})}) == {"emg": {}}
    assert desk.goals.wishes()


def test_the_wearers_effort_moves_the_joint_that_they_have_just_switched_to(desk: Desk) -> None:
    assert desk.operate({"emg": Asked({"arm": -0.5}, ["arm"])}) == {"emg": {ELBOW: Velocity(-0.25)}}
    assert told(desk) == ["the wearer switched arm to elbow"]


def test_a_client_takes_a_group_from_the_wearer_who_rests_before_driving_it_again(desk: Desk) -> None:
    flexed = {"emg": Asked({"arm": 0.5})}
    group = desk.groups.group("arm")
    assert desk.driver(group) == ("", 0.0)
    desk.operate(flexed)
    assert desk.driver(group) == ("emg", 0.5)
    desk.group_command("arm", -0.4, ANN, 1.0)
    assert desk.operate(flexed) == {"emg": {}}
    assert desk.driver(group) == ("client:ann", -0.4)
    desk.clients.vanish(ANN.session)
    assert desk.operate(flexed) == {"emg": {}}
    assert desk.driver(group) == ("", 0.0)
    desk.operate({"emg": Asked({"arm": 0.0})})
    assert desk.operate(flexed) == {"emg": {SHOULDER: Velocity(0.25)}}


def test_a_move_of_the_active_joint_takes_its_group_and_one_of_another_joint_does_not(desk: Desk) -> None:
    flexed = {"emg": Asked({"arm": 0.5})}
    desk.move(ELBOW, Velocity(0.1), ANN, 1.0)
    assert desk.operate(flexed) == {"emg": {SHOULDER: Velocity(0.25)}}
    desk.move(SHOULDER, Position(0.1, 0.1), ANN, 1.0)
    assert desk.operate(flexed) == {"emg": {}}
    assert desk.driver(desk.groups.group("arm")) == ("client:ann", 0.0)


@pytest.mark.parametrize(
    "switch",
    [lambda desk: desk.toggle("arm", 1, "ann"), lambda desk: desk.activate("arm", "elbow", "ann")],
)
def test_a_joint_that_a_client_switched_to_does_not_start_with_the_wearers_old_effort(
    desk: Desk, switch: Callable[[Desk], object]
) -> None:
    flexed = {"emg": Asked({"arm": 0.5})}
    desk.operate(flexed)
    switch(desk)
    assert desk.operate(flexed) == {"emg": {}}
    desk.operate({"emg": Asked({"arm": 0.0})})
    assert desk.operate(flexed) == {"emg": {ELBOW: Velocity(0.25)}}


def test_the_wearer_toggles_nothing_while_a_client_drives(desk: Desk) -> None:
    desk.group_command("arm", 0.4, ANN, 1.0)
    assert desk.operate({"emg": Asked({"arm": 0.0}, ["arm"])}) == {"emg": {}}
    assert desk.groups.group("arm").active == SHOULDER


def test_groups_are_described_and_their_joints_chosen_by_name(desk: Desk) -> None:
    desk.activate("arm", "elbow", "ann")
    assert desk.describe_groups() == [{"name": "arm", "joints": ["shoulder", "elbow"], "active": "elbow"}]
    with pytest.raises(BadRequest, match="has no joint 'gripper'"):
        desk.activate("arm", "gripper", "ann")
    with pytest.raises(BadRequest, match="there is no group 'leg'"):
        desk.toggle("leg", 1, "ann")
