import logging

import pytest

from bentod.frames import Freshness
from drivers.dynamixel.bus import Reply
from drivers.dynamixel.condition import Condition
from drivers.dynamixel.tables import ALARM_SHUTDOWN, HARDWARE_ALERT, MODELS, WATCHDOG
from tests.drivers.dynamixel.arm2 import window2
from tests.drivers.dynamixel.wire import word

TICK = 1 / 30


def reply(position: int, time: float, limit: int = 1023, error: int = 0) -> Reply:
    return Reply(error, bytes((*word(limit), *word(position), 0, 0, 0, 0, 120, 31)), time)


def reply2(time: float, error: int = 0) -> Reply:
    return Reply(error, window2(), time)


@pytest.fixture
def mx() -> Condition:
    return Condition(MODELS["MX-28"], "Servo 1 (wrist)", lost_after=0.5)


@pytest.fixture
def mx2() -> Condition:
    return Condition(MODELS["MX-28(2.0)"], "Servo 1 (wrist)", lost_after=0.5)


def test_the_first_position_is_believed_wherever_it_is(mx: Condition) -> None:
    assert mx.heard(reply(3900, 1.0))
    assert mx.last.position > 2.8


def test_a_position_that_cannot_have_been_reached_is_not_believed(mx: Condition) -> None:
    mx.heard(reply(2048, 1.0))
    assert not mx.heard(reply(3000, 1.0 + TICK))
    assert mx.last.position == 0
    assert mx.state(1.0 + TICK, False, None).age == pytest.approx(TICK)


def test_it_is_believed_when_the_next_reading_agrees_with_it(mx: Condition) -> None:
    mx.heard(reply(2048, 1.0))
    mx.heard(reply(3000, 1.0 + TICK))
    assert mx.heard(reply(3010, 1.0 + 2 * TICK))


def test_two_glitches_that_do_not_agree_are_both_dropped(mx: Condition) -> None:
    mx.heard(reply(2048, 1.0))
    assert not mx.heard(reply(3000, 1.0 + TICK))
    assert not mx.heard(reply(500, 1.0 + 2 * TICK))
    assert mx.heard(reply(2050, 1.0 + 3 * TICK))


def test_after_a_silence_a_joint_may_be_farther_away(mx: Condition) -> None:
    mx.heard(reply(2048, 1.0))
    assert mx.heard(reply(3000, 1.2))


def test_the_fastest_joint_is_always_believed(mx: Condition) -> None:
    for tick in range(5):
        assert mx.heard(reply(2048 + 170 * tick, 1.0 + tick * TICK))  # 7.8 rad/s


def test_a_complaint_is_logged_when_it_comes_and_when_it_goes(
    mx: Condition, caplog: pytest.LogCaptureFixture
) -> None:
    with caplog.at_level(logging.WARNING):
        for tick in range(6):
            mx.heard(reply(2048, tick * TICK, error=1 if tick in (2, 3) else 0))
    assert caplog.messages == [
        "Servo 1 (wrist) reports Input Voltage Error.",
        "Servo 1 (wrist) reports no error any more.",
    ]


def test_a_joint_that_is_silent_goes_stale_and_then_lost(mx: Condition) -> None:
    mx.heard(reply(2048, 1.0))
    assert mx.state(1.0, True, None).freshness is Freshness.FRESH
    assert mx.state(1.5, False, None).freshness is Freshness.STALE
    assert mx.state(1.6, False, None).freshness is Freshness.LOST


def test_a_torque_limit_of_zero_is_a_shutdown(mx: Condition) -> None:
    mx.heard(reply(2048, 1.0, limit=0, error=0x20))
    assert mx.errors == ("Overload Error", ALARM_SHUTDOWN)
    assert mx.shut_down


def test_an_alert_gets_its_name_when_its_cause_is_known(mx2: Condition) -> None:
    mx2.heard(reply2(1.0, error=0x80))
    assert (mx2.errors, mx2.shut_down) == ((HARDWARE_ALERT,), False)
    mx2.note_hardware(0b100)
    assert (mx2.errors, mx2.shut_down) == (("Overheating Error",), True)
    mx2.heard(reply2(1.1))
    assert (mx2.errors, mx2.shut_down) == ((), False)


def test_what_shutdown_does_not_name_is_told_and_is_no_shutdown(mx2: Condition) -> None:
    mx2.heard(reply2(1.0, error=0x80))
    mx2.note_hardware(0b1)
    assert (mx2.errors, mx2.shut_down) == (("Input Voltage Error",), False)


def test_a_tripped_watchdog_is_an_error_and_counts_as_shut_down(mx2: Condition) -> None:
    mx2.heard(reply2(1.0))
    mx2.note_watchdog(0xFF)
    assert (mx2.errors, mx2.shut_down) == ((WATCHDOG,), True)
    mx2.note_watchdog(0)
    assert (mx2.errors, mx2.shut_down) == ((), False)
