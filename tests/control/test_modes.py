import pytest

from bentod.control.modes import Modes
from bentod.errors import Refused
from bentod.frames import Mode


def _active(torque: tuple[bool, ...] = (True, True)) -> Modes:
    modes = Modes(["shoulder", "elbow"], torque)
    modes.pause([i for i, on in enumerate(torque) if on], False)
    return modes


def test_a_joint_found_with_torque_holds_and_one_without_is_limp() -> None:
    modes = Modes(["shoulder", "elbow"], [True, False])
    assert (modes.of(0), modes.of(1)) == (Mode.HOLDING, Mode.LIMP)
    assert modes.arm is Mode.HOLDING


def test_only_a_release_makes_a_holding_joint_active() -> None:
    modes = Modes(["shoulder"], [True])
    modes.pause([0], False)
    assert modes.of(0) is Mode.ACTIVE


def test_a_paused_joint_stays_paused_until_it_is_released() -> None:
    modes = _active()
    modes.pause([0], True)
    assert (modes.of(0), modes.of(1)) == (Mode.PAUSED, Mode.ACTIVE)
    modes.pause([0], False)
    assert modes.of(0) is Mode.ACTIVE


def test_pausing_a_limp_joint_leaves_it_limp() -> None:
    modes = Modes(["shoulder"], [False])
    modes.pause([0], True)
    assert modes.of(0) is Mode.LIMP


def test_a_limp_joint_cannot_be_released_and_nothing_else_is_either() -> None:
    modes = Modes(["shoulder", "elbow"], [True, False])
    with pytest.raises(Refused, match="torque is off on elbow"):
        modes.pause([0, 1], False)
    assert modes.of(0) is Mode.HOLDING


def test_asking_for_torque_pauses_and_only_the_hardware_makes_it_true() -> None:
    modes = _active((True, False))
    modes.ask_torque([1], True)
    assert modes.of(1) is Mode.LIMP
    assert modes.wanted_torque == (True, True)
    modes.confirm_torque([True, True])
    assert modes.of(1) is Mode.HOLDING


def test_switching_torque_of_an_active_joint_pauses_it() -> None:
    modes = _active()
    modes.ask_torque([0], True)
    assert modes.of(0) is Mode.PAUSED


def test_torque_that_the_hardware_refused_is_not_asked_for_again() -> None:
    modes = Modes(["shoulder"], [False])
    modes.ask_torque([0], True)
    modes.confirm_torque([False])
    assert modes.wanted_torque == (False,)
    assert modes.of(0) is Mode.LIMP


def test_a_fault_covers_every_joint_and_its_first_reason_stays() -> None:
    modes = _active()
    assert modes.enter_fault("cable", limp=False)
    assert not modes.enter_fault("another", limp=False)
    assert modes.fault == "cable"
    assert (modes.of(0), modes.of(1), modes.arm) == (Mode.FAULT, Mode.FAULT, Mode.FAULT)


def test_a_fault_keeps_torque_or_drops_it_as_asked() -> None:
    holding, limp = _active(), _active()
    holding.enter_fault("cable", limp=False)
    limp.enter_fault("cable", limp=True)
    assert holding.wanted_torque == (True, True)
    assert limp.wanted_torque == (False, False)


def test_in_a_fault_nothing_is_released_and_no_torque_is_given() -> None:
    modes = _active()
    modes.enter_fault("cable", limp=False)
    with pytest.raises(Refused, match="cable"):
        modes.pause([0], False)
    with pytest.raises(Refused, match="clear_fault first"):
        modes.ask_torque([0], True)
    modes.ask_torque([0], False)
    assert modes.wanted_torque == (False, True)


def test_clearing_a_fault_leaves_joints_holding_not_moving() -> None:
    modes = _active()
    modes.enter_fault("cable", limp=False)
    modes.clear_fault()
    assert (modes.of(0), modes.of(1)) == (Mode.HOLDING, Mode.HOLDING)
