"""The limits of all joints together, with the time between ticks and the age of readings."""

import pytest

from bentod.control.arbiter import Decision
from bentod.control.limiter import Limiter
from bentod.frames import Command, State, Stop, Velocity
from tests.fakes import LADDER, PERIOD, SPECS, at

LONGEST = 3 * PERIOD
STEP = SPECS[0].bounds.acceleration * PERIOD


def limited(limiter: Limiter, state: State, *commands: Command | None) -> list[Command | None]:
    return limiter.limit([Decision(command, "client") for command in commands], state, LONGEST)


def velocities(sent: list[Command | None]) -> list[float]:
    """Rad/s, 0 for what is no velocity."""
    return [command.velocity if isinstance(command, Velocity) else 0.0 for command in sent]


@pytest.fixture
def limiter() -> Limiter:
    """Has been ticking, at rest."""
    limiter = Limiter(SPECS, LADDER)
    limited(limiter, at(0.0, 0.0, time=5.0), Stop(), Stop())
    return limiter


def test_velocities_rise_with_the_time_between_two_readings(limiter: Limiter) -> None:
    sent = limited(limiter, at(0.0, 0.0, time=5.0 + PERIOD), Velocity(0.5), Stop())
    assert velocities(sent) == pytest.approx([STEP, 0.0])
    assert limiter.limited == ("acceleration", "")


def test_a_long_pause_is_no_run_up() -> None:
    limiter = Limiter(SPECS, LADDER)
    limited(limiter, at(0.0, 0.0, time=5.0), Velocity(-0.5), None)
    limited(limiter, at(0.0, 0.0, time=9.0), Velocity(-0.5), None)
    sent = limited(limiter, at(0.0, 0.0, time=19.0), Velocity(9.0), None)
    assert velocities(sent) == pytest.approx([-0.5 + 3 * STEP, 0.0])


def test_time_that_runs_backwards_is_no_time(limiter: Limiter) -> None:
    assert limited(limiter, at(0.0, 0.0, time=1.0), Velocity(0.5), None) == [Stop(), None]


def test_a_joint_whose_reading_is_too_old_is_stopped_at_once_and_only_that_one(limiter: Limiter) -> None:
    for tick in (1, 2, 3):
        limited(limiter, at(0.0, 0.0, time=5 + tick * PERIOD), Velocity(0.5), Velocity(0.5))
    sent = limited(limiter, at(0.0, 0.0, stale=[1], time=5 + 4 * PERIOD), Velocity(0.5), Velocity(0.5))
    assert sent == [Velocity(0.5), Stop()]
    assert limiter.limited == ("", "stale")
    again = limited(limiter, at(0.0, 0.0, time=5 + 5 * PERIOD), Velocity(0.5), Velocity(0.5))
    assert velocities(again) == pytest.approx([0.5, STEP])


def test_a_stale_joint_that_is_limp_or_stopped_is_left_as_it_is(limiter: Limiter) -> None:
    assert limited(limiter, at(0.0, 0.0, stale=[0, 1], time=5.1), Stop(), None) == [Stop(), None]
    assert limiter.limited == ("", "")


def test_after_a_stop_by_other_means_a_joint_sets_off_from_rest(limiter: Limiter) -> None:
    for tick in (1, 2, 3):
        limited(limiter, at(0.0, 0.0, time=5 + tick * PERIOD), Velocity(0.5), None)
    limiter.reset()
    sent = limited(limiter, at(0.0, 0.0, time=5 + 4 * PERIOD), Velocity(0.5), None)
    assert velocities(sent) == pytest.approx([STEP, 0.0])
