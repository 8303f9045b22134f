import math

from hypothesis import given
from hypothesis import strategies as st

from bentod.control.limits import limit
from bentod.frames import Command, Freshness, JointSpec, JointState, Position, Stop, Velocity

SPEC = JointSpec("elbow", -0.4, 0.8, 0.5, 0.0, {})


def _at(position: float) -> JointState:
    return JointState(position, 0.0, 0.0, 12.0, 30.0, 0.0, Freshness.FRESH)


def test_a_velocity_is_cut_to_the_joints_maximum() -> None:
    assert limit(Velocity(3.0), SPEC, _at(0.0)) == Velocity(0.5)
    assert limit(Velocity(-3.0), SPEC, _at(0.0)) == Velocity(-0.5)


def test_at_a_limit_only_the_way_back_is_open() -> None:
    assert limit(Velocity(0.2), SPEC, _at(0.8)) == Stop()
    assert limit(Velocity(-0.2), SPEC, _at(0.8)) == Velocity(-0.2)
    assert limit(Velocity(-0.2), SPEC, _at(-0.41)) == Stop()


def test_a_position_is_brought_into_the_limits_and_its_speed_too() -> None:
    assert limit(Position(2.0, 9.0), SPEC, _at(0.0)) == Position(0.8, 0.5)


def test_what_is_no_number_becomes_a_stop() -> None:
    assert limit(Velocity(math.nan), SPEC, _at(0.0)) == Stop()
    assert limit(Velocity(math.inf), SPEC, _at(0.0)) == Stop()
    assert limit(Position(math.nan, 0.1), SPEC, _at(0.0)) == Stop()
    assert limit(Position(0.1, math.nan), SPEC, _at(0.0)) == Stop()
    assert limit(Position(0.1, 0.0), SPEC, _at(0.0)) == Stop()


def test_a_velocity_of_zero_is_a_stop() -> None:
    assert limit(Velocity(0.0), SPEC, _at(0.0)) == Stop()


def test_stops_and_limp_joints_pass_as_they_are() -> None:
    assert limit(Stop(), SPEC, _at(0.0)) == Stop()
    assert limit(None, SPEC, _at(0.0)) is None


@given(
    st.builds(Velocity, st.floats()) | st.builds(Position, st.floats(), st.floats()),
    st.floats(-7, 7),
)
def test_nothing_beyond_the_limits_ever_passes(command: Command, position: float) -> None:
    match limit(command, SPEC, _at(position)):
        case Velocity(velocity=velocity):
            assert 0 < abs(velocity) <= SPEC.max_velocity
            assert not (position >= SPEC.maximum and velocity > 0)
            assert not (position <= SPEC.minimum and velocity < 0)
        case Position(position=goal, speed=speed):
            assert SPEC.minimum <= goal <= SPEC.maximum
            assert 0 < speed <= SPEC.max_velocity
        case passed:
            assert passed == Stop()
