from bentod.frames import JointSpec, Position, Stop, Velocity
from drivers.can.codec import Estimate, Go, Rest, Spin
from drivers.can.motion import PATIENCE, TURN, JointMotion, Sample
from drivers.can.options import Hardware, Options

SPEC = JointSpec("wrist", -1.0, 1.0, 2.0, 0.0, {})
PERIOD = 1 / 30


def motion(**hardware: float | bool) -> JointMotion:
    """Of a joint whose motor turns ten times as far, the other way round."""
    made = Hardware.model_validate({"node": 1, "gear_ratio": -10.0, "offset_rad": 0.5, **hardware})
    return JointMotion(SPEC, made, Options(), PERIOD)


def test_the_motor_turns_as_the_gear_says_and_against_the_joint() -> None:
    gear = motion().gear
    assert gear.turns(0.5) == 0.0
    assert round(gear.turns(0.5 + TURN), 9) == -10.0
    assert gear.sample(Estimate(-10.0, -10.0), 3.0) == Sample(0.5 + TURN, TURN, 3.0)
    assert gear.bounds.velocity == 3.0 * 10 / TURN


def test_a_velocity_far_from_the_limit_is_a_velocity() -> None:
    assert motion().command(Velocity(1.0), Sample(0.0, 1.0, 0.0), 0.0) == Spin(-10 / TURN)


def test_a_velocity_near_the_limit_becomes_a_move_to_it() -> None:
    moving = motion()
    limit = Go(moving.gear.turns(1.0), 10 / TURN)
    assert moving.command(Velocity(1.0), Sample(0.9, 1.0, 0.0), 0.0) == limit
    assert moving.command(Velocity(1.0), Sample(1.2, 0.0, 0.0), 0.0) == limit
    assert isinstance(moving.command(Velocity(-1.0), Sample(0.9, 1.0, 0.0), 0.0), Spin)


def test_a_joint_that_is_faster_than_it_was_asked_is_braked_sooner() -> None:
    assert isinstance(motion().command(Velocity(0.1), Sample(0.5, 0.1, 0.0), 0.0), Spin)
    assert isinstance(motion().command(Velocity(0.1), Sample(0.5, 3.0, 0.0), 0.0), Go)


def test_a_bounded_joint_always_moves_to_its_limit() -> None:
    moving = motion(bounded=True)
    assert moving.command(Velocity(-1.0), Sample(0.0, 0.0, 0.0), 0.0) == Go(
        moving.gear.turns(-1.0), 10 / TURN
    )


def test_a_position_is_a_move_at_its_speed() -> None:
    moving = motion()
    told = moving.command(Position(0.3, 0.25), Sample(0, 0, 0), 0.0)
    assert told == Go(moving.gear.turns(0.3), 2.5 / TURN)


def test_a_stop_is_velocity_zero_until_the_joint_rests_and_then_its_place() -> None:
    moving = motion()
    moving.command(Velocity(1.0), Sample(0.0, 1.0, 0.9), 1.0)
    assert moving.command(Stop(), Sample(0.1, 1.0, 1.0), 1.0) == Spin(0.0)
    assert moving.command(Stop(), Sample(0.2, 0.5, 1.1), 1.1) == Spin(0.0)
    rest = Rest(moving.gear.turns(0.25))
    assert moving.command(Stop(), Sample(0.25, 0.01, 1.2), 1.2) == rest
    assert moving.command(Stop(), Sample(0.35, 0.9, 1.3), 1.3) == rest


def test_a_reading_from_before_the_stop_does_not_show_that_the_joint_rests() -> None:
    moving = motion()
    standing = Sample(0.0, 0.0, 0.99)
    assert moving.command(Stop(), standing, 1.0) == Spin(0.0)
    assert moving.command(Stop(), standing, 1.1) == Spin(0.0)
    assert moving.command(Stop(), Sample(0.0, 0.0, 1.05), 1.1) == Rest(moving.gear.turns(0.0))


def test_a_joint_that_never_rests_is_held_where_it_is_in_the_end() -> None:
    moving = motion()
    moving.command(Stop(), Sample(0.0, 0.5, 0.0), 0.0)
    late = Sample(0.4, 0.5, PATIENCE + 0.1)
    assert moving.command(Stop(), late, PATIENCE + 0.1) == Rest(moving.gear.turns(0.4))


def test_a_joint_is_not_held_outside_its_limits() -> None:
    moving = motion()
    moving.command(Stop(), Sample(1.1, 0.0, 0.0), 0.0)
    assert moving.command(Stop(), Sample(1.1, 0.0, 0.1), 0.1) == Rest(moving.gear.turns(1.0))


def test_the_report_of_a_stop_tells_the_way_and_how_much_of_it_was_given_back() -> None:
    moving = motion()
    for time, position, velocity in ((0.0, 0.2, -1.0), (0.1, 0.1, -0.5), (0.2, 0.08, 0.01), (0.5, 0.09, 0.0)):
        sample = Sample(position, velocity, time)
        moving.watch(sample)
        moving.command(Stop(), sample, time)
    report = moving.stopped
    assert report is not None
    assert (report.rule, report.time) == ("velocity", 0.0)
    assert (round(report.travel, 6), round(report.bounce, 6)) == (0.11, 0.01)


def test_standing_still_is_not_reported_as_a_stop() -> None:
    moving = motion()
    for time in (0.0, 0.1, 0.2, 0.6):
        moving.watch(Sample(0.0, 0.0, time))
        moving.command(Stop(), Sample(0.0, 0.0, time), time)
    assert moving.stopped is None
