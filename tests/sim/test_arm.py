import time
from statistics import median

import pytest

from bentod.contracts import FaultInjector
from bentod.errors import BadRequest
from sim.arm import Arm
from sim.servo import Servo, Setting
from sim.servo_models import MX_28, MX_64, MX_106
from sim.shaft import Link


def an_arm() -> Arm:
    return Arm([Servo(MX_64, Link(), seed="a"), Servo(MX_28, Link(), seed="b")])


def moving(arm: Arm) -> Arm:
    for servo in arm.servos:
        servo.tell(Setting(1.0, speed=0.5, torque_on=True))
    return arm


def positions(arm: Arm) -> list[float]:
    return [servo.position for servo in arm.servos]


def test_an_arm_is_a_fault_injector() -> None:
    injector: FaultInjector = an_arm()
    assert {"cable", "silent", "stuck", "overload", "overheat", "low_voltage"} <= set(injector.faults())


def test_time_passes_in_whole_milliseconds_and_none_is_lost() -> None:
    often, seldom = moving(an_arm()), moving(an_arm())
    for tick in range(1, 601):
        often.advance(tick / 600)
    seldom.advance(1.0)
    assert often.time == pytest.approx(seldom.time)
    assert positions(often) == positions(seldom)


def test_time_never_runs_backwards() -> None:
    arm = moving(an_arm())
    arm.advance(0.5)
    before = positions(arm)
    arm.advance(0.2)
    assert positions(arm) == before


def test_what_is_too_long_ago_passes_without_motion() -> None:
    arm = moving(an_arm())
    arm.catch_up = 0.1
    arm.advance(1e6)
    assert arm.time == pytest.approx(1e6)
    assert positions(arm)[0] < 0.1


@pytest.mark.parametrize("fault", an_arm().faults())
def test_every_fault_comes_and_goes(fault: str) -> None:
    arm = moving(an_arm())
    arm.inject(fault, None, True)
    arm.advance(0.2)
    arm.inject(fault, None, False)
    arm.advance(0.6)
    assert arm.plugged
    assert all(servo.answers and not servo.errors() for servo in arm.servos)


def test_a_fault_of_one_joint_leaves_the_others_alone() -> None:
    arm = moving(an_arm())
    arm.inject("stuck", 0, True)
    arm.advance(1.0)
    assert positions(arm)[0] == 0.0
    assert positions(arm)[1] > 0.3


@pytest.mark.parametrize(
    ("fault", "joint", "complaint"),
    [("sulking", None, "no fault 'sulking'"), ("stuck", 2, "has 2 joints"), ("cable", 0, "takes no joint")],
)
def test_a_fault_that_cannot_be_is_refused(fault: str, joint: int | None, complaint: str) -> None:
    with pytest.raises(BadRequest, match=complaint):
        an_arm().inject(fault, joint, True)


def test_watchers_hear_of_the_cable_once() -> None:
    arm, heard = an_arm(), list[bool]()
    arm.watch_cable(heard.append)
    for on in (True, True, False, False):
        arm.inject("cable", None, on)
    assert heard == [False, True]


def test_a_tick_of_five_servos_costs_well_below_a_millisecond() -> None:
    arm = Arm([Servo(model, Link(0.3, -1.5, 0.01)) for model in (MX_64, MX_106, MX_28, MX_28, MX_28)])
    moving(arm)
    costs = []
    for tick in range(1, 31):
        started = time.perf_counter()
        arm.advance(tick * 0.033)
        costs.append(time.perf_counter() - started)
    assert median(costs) < 0.002  # four times what it takes, for a machine that is busy
