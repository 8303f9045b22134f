"""Joints that an operator drives by name, beside others who want the same joint."""

from bentod.control.joint_seats import JointSeats
from bentod.control.operators import REST, Asked
from bentod.frames import Velocity, Wishes
from tests.fakes import PERIOD, SPECS

STICK = "joystick"
TOP = SPECS[0].max_velocity


class Alone:
    """A joystick whose axis drives the shoulder by name."""

    def __init__(self) -> None:
        self.seats = JointSeats(SPECS, [STICK])
        self.now = 1.0

    def tick(self, effort: float, taken: bool = False, seconds: float = PERIOD) -> Wishes:
        granted: Wishes = {}
        for _ in range(max(round(seconds / PERIOD), 1)):
            self.now += PERIOD
            asked = {STICK: Asked({"shoulder": effort})}
            granted = self.seats.decide(asked, [0] * taken, self.now)[STICK]
        return granted


def test_an_effort_is_a_share_of_the_joints_speed() -> None:
    assert Alone().tick(-0.5) == {0: Velocity(-0.5 * TOP)}


def test_no_effort_asks_for_nothing() -> None:
    assert Alone().tick(0.0) == {}


def test_who_pushes_a_joint_that_others_move_must_rest_before_they_may() -> None:
    alone = Alone()
    alone.tick(0.5)
    assert alone.tick(0.5, taken=True) == {}
    assert alone.tick(0.5, seconds=1.0) == {}
    alone.tick(0.0)
    assert alone.tick(0.5) == {0: Velocity(0.5 * TOP)}


def test_a_joint_is_driven_until_its_driver_has_been_at_rest_for_a_while() -> None:
    alone = Alone()
    alone.tick(0.5)
    assert alone.seats.driven([0])
    alone.tick(0.0, seconds=1.2 * REST)
    assert not alone.seats.driven([0, 1])


def test_after_a_release_the_stick_must_be_seen_at_rest() -> None:
    alone = Alone()
    alone.tick(0.5)
    alone.seats.suspend([0])
    assert alone.tick(0.5) == {}
    alone.tick(0.0)
    assert alone.tick(0.5)
