"""What may be asked of the arm between two ticks, and what comes of it."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from bentod.config_learn import Learn
from bentod.contracts import Vector
from bentod.control.groups import Groups
from bentod.control.leases import Holder
from bentod.control.operators import Asked
from bentod.desk import Desk
from bentod.errors import BadRequest, Refused
from bentod.frames import Mode, Position, Value, Velocity
from bentod.learn.group import Group
from bentod.mind import Mind
from tests.fakes import PERIOD, SPECS, at, desk_of
from tests.learn.predictors import NO_EMG

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
    assert desk.describe_groups() == [
        {"name": "arm", "joints": ["shoulder", "elbow"], "active": "elbow", "together": False}
    ]
    with pytest.raises(BadRequest, match="has no joint 'gripper'"):
        desk.activate("arm", "gripper", "ann")
    with pytest.raises(BadRequest, match="there is no group 'leg'"):
        desk.toggle("leg", 1, "ann")


SPEED: dict[str, Value] = {"name": "speed", "cumulant": "elbow.velocity", "timescale": 20}


@pytest.fixture
def learning() -> Desk:
    """A desk whose mind has watched the arm for a while."""
    groups = Groups(SPECS, {"arm": ["shoulder", "elbow"]})
    desk = desk_of(mind=Mind(SPECS, 1 / PERIOD, groups, Learn(joints=("shoulder", "elbow"))))
    for tick in range(5):
        live(desk, tick)
    desk.journal.take()
    return desk


def live(desk: Desk, tick: int) -> None:
    state = at(0.01 * tick, 0.5, time=tick * PERIOD)
    desk.watch(state, tick * PERIOD)
    desk.mind.predict(desk.percept(tick, tick * PERIOD, False, state, NO_EMG))
    desk.learn(lambda: True)


def test_what_is_asked_begun_anew_and_forgotten_is_told_so_that_it_can_be_repeated(learning: Desk) -> None:
    assert learning.add_gvf(SPEED) == ("speed",)
    learning.reset_gvfs(["speed"])
    learning.remove_gvfs(["speed"])
    events = learning.journal.take()
    assert [(event.kind, event.text) for event in events] == [
        ("learn", "GVF added: speed"),
        ("learn", "GVF reset: speed"),
        ("learn", "GVF removed: speed"),
    ]
    assert [event.data for event in events] == [
        {"added": SPEED},
        {"reset": ["speed"]},
        {"removed": ["speed"]},
    ]


def test_where_much_is_asked_the_arm_must_be_paused_before_more_is(learning: Desk) -> None:
    many: dict[str, Value] = {
        "name": "{cumulant}@{timescale}",
        "cumulant": "*",
        "timescale": [2, 3, 4, 5, 6, 7, 8, 9],
    }
    learning.add_gvf(many)
    learning.pause((SHOULDER, ELBOW), False)
    for ask in (lambda: learning.add_gvf(SPEED), lambda: learning.remove_gvfs(["shoulder.load@2"])):
        with pytest.raises(Refused, match="pause the arm first"):
            ask()
    learning.pause(range(2), True)
    learning.add_gvf(SPEED)


def test_of_a_great_family_only_some_are_named(learning: Desk) -> None:
    learning.add_gvf({"name": "{cumulant}", "cumulant": ["shoulder.*", "elbow.*"], "timescale": 5})
    (text,) = told(learning, "learn")
    assert text.startswith("GVF added: shoulder.position, shoulder.velocity, ")
    assert text.endswith("elbow.load and 2 more")


def test_what_is_refused_is_not_told(learning: Desk) -> None:
    for ask, why in (
        (lambda: learning.add_gvf({**SPEED, "cumulant": "nobody"}), "unknown name 'nobody'"),
        (lambda: learning.add_gvf("speed"), "gvf"),
        (lambda: learning.reset_gvfs(["nobody"]), "no GVF 'nobody'"),
        (lambda: learning.remove_gvfs(["elbow.position@20"]), "is the arm's own"),
    ):
        with pytest.raises(BadRequest, match=why):
            ask()
    assert told(learning) == []


def test_without_learners_nothing_can_be_asked(desk: Desk) -> None:
    for ask in (desk.describe_gvfs, lambda: desk.add_gvf(SPEED), lambda: desk.remove_gvfs(["x"])):
        with pytest.raises(Refused, match=r"the config has no \[learn\] table"):
            ask()


def test_after_learning_broke_nothing_can_be_asked_and_the_reason_is_told(
    learning: Desk, monkeypatch: pytest.MonkeyPatch
) -> None:
    def break_down(*_: object) -> None:
        raise ZeroDivisionError("oops")

    with monkeypatch.context() as patch:
        patch.setattr(Group, "step", break_down)
        live(learning, 5)
    for ask in (learning.describe_gvfs, lambda: learning.reset_gvfs(["elbow.position@20"])):
        with pytest.raises(Refused, match="Learning broke and is off: ZeroDivisionError: oops"):
            ask()


def test_learners_that_diverge_are_told_of_once_and_predict_finite_numbers(
    learning: Desk, monkeypatch: pytest.MonkeyPatch
) -> None:
    learning.add_gvf(SPEED)
    learning.journal.take()
    step = Group.step

    def explode(group: Group, *experience: Any) -> Vector:
        group._lazy.weights[:] = np.inf
        return step(group, *experience)

    with monkeypatch.context() as patch:
        patch.setattr(Group, "step", explode)
        for tick in range(5, 20):
            live(learning, tick)
            assert all(np.isfinite(value) for value in learning.mind.frame().predictions.values())
            assert all(np.isfinite(value) for value in learning.mind.predictions(ELBOW).values())
    (event,) = learning.journal.take()
    names = ["shoulder.position@20", "elbow.position@20", "speed"]
    assert (event.kind, event.data) == ("diverged", {"began_anew": names})
    assert event.text == f"diverged, and began anew: {', '.join(names)}"
