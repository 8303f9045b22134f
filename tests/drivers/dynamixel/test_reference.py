import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivers.dynamixel.reference import Course, Flight, Order, coast, follow, lag

AT_REST = Course(0.0, 0.0)


def test_the_lag_has_the_sign_of_the_load_and_shrinks_with_the_gain() -> None:
    assert lag(0.5, 32) == pytest.approx(math.radians(5.665))
    assert lag(-0.5, 64) == pytest.approx(-math.radians(5.665) / 2)


def test_a_servo_without_a_profile_does_not_coast() -> None:
    assert coast(2.0, 0.0) == 0
    assert math.degrees(coast(math.radians(103), math.radians(257))) == pytest.approx(20.6, abs=0.1)
    assert coast(-1.0, 1.0) == -0.5


def test_a_reference_goes_at_moving_speed_and_stands_at_the_goal() -> None:
    order = Order(0.0, goal=-0.3, speed=0.5)
    assert follow(AT_REST, order, 0.2, 0.0) == Course(-0.1, -0.5)
    assert follow(AT_REST, order, 0.7, 0.0) == Course(-0.3, 0.0)


def test_a_reference_with_acceleration_ramps_up_and_down() -> None:
    # 0.5 rad/s at 2 rad/s²: 0.25 s up (0.0625 rad), then 0.375 s for 0.1875 rad, 0.25 s down: 0.3125 rad.
    order = Order(0.0, goal=0.3125, speed=0.5)
    half = follow(AT_REST, order, 0.25, 2.0)
    assert half.place == pytest.approx(0.0625, abs=1e-3)
    assert half.rate == pytest.approx(0.5, abs=0.01)
    end = follow(AT_REST, order, 0.875, 2.0)
    assert end.place == pytest.approx(0.3125, abs=1e-3)
    assert end.rate == pytest.approx(0.0, abs=0.06)


@given(
    place=st.floats(-3, 3),
    goal=st.floats(-3, 3),
    speed=st.floats(0.01, 5),
    seconds=st.floats(0, 1),
)
def test_a_reference_never_passes_its_goal(place: float, goal: float, speed: float, seconds: float) -> None:
    end = follow(Course(place, 0.0), Order(0.0, goal, speed), seconds, 0.0).place
    assert min(place, goal) - 1e-9 <= end <= max(place, goal) + 1e-9


def test_each_order_is_obeyed_in_its_own_time() -> None:
    flight = Flight()
    flight.note(Order(-math.inf, 0.0, 0.1))
    flight.note(Order(1.0, 2.0, 0.5))
    flight.note(Order(1.1, 2.0, 1.0))
    # Sampled at 1.0, 0.05 s of dead time: rest until 1.05, 0.5 rad/s until 1.15, 1 rad/s until 1.17.
    course = flight.carry(AT_REST, 1.0, 1.17, 0.05, 0.0)
    assert course.place == pytest.approx(0.05 + 0.02)
    assert course.rate == 1.0


def test_a_steady_motion_goes_on_by_its_speed_times_all_delays() -> None:
    flight = Flight()
    flight.note(Order(0.0, 2.0, 0.5))
    # T_age 4 ms + T_bus 2 ms + T_cmd 17 ms: the formula v (T_age + T_bus + T_cmd).
    course = flight.carry(Course(0.3, 0.5), 1.0, 1.0 + 0.004 + 0.002 + 0.017, 0.017, 0.0)
    assert course.place == pytest.approx(0.3 + 0.5 * 0.023)


def test_a_reversal_that_is_underway_is_foreseen() -> None:
    flight = Flight()
    flight.note(Order(0.0, 2.0, 0.5))
    flight.note(Order(1.0, -2.0, 0.5))
    course = flight.carry(AT_REST, 1.0, 1.08, 0.05, 0.0)  # 50 ms forth, 30 ms back
    assert course.place == pytest.approx(0.01)
    assert course.rate == -0.5


def test_what_is_long_past_is_forgotten() -> None:
    flight = Flight()
    assert not flight
    for tick in range(1000):
        flight.note(Order(tick * 0.01, tick * 0.001, 0.5))
    assert len(flight) <= 102
