"""What waits for a client is bounded, and what is lost is counted."""

import pytest

from bentod.serve.outbox import Outbox, StateSlot


def due(rate_hz: float, ticks_hz: float, seconds: float = 10.0) -> int:
    slot = StateSlot()
    slot.start(rate_hz)
    start = 1000.0
    return sum(slot.is_due(start + tick / ticks_hz) for tick in range(round(seconds * ticks_hz)))


@pytest.mark.parametrize(
    ("rate_hz", "ticks_hz", "frames"),
    [
        (10, 30, 100),
        (30, 30, 300),
        (20, 30, 200),
        (100, 30, 300),
        (7, 30, 70),
        (500, 500, 5000),
        (0.5, 30, 5),
    ],
)
def test_frames_come_at_the_chosen_rate_or_every_tick(rate_hz: float, ticks_hz: float, frames: int) -> None:
    assert due(rate_hz, ticks_hz) == pytest.approx(frames, abs=1)


def test_after_a_pause_of_the_ticks_frames_are_not_made_up_for() -> None:
    slot = StateSlot()
    slot.start(10)
    assert slot.is_due(0.0)
    assert slot.is_due(5.0)
    assert not slot.is_due(5.05)


def test_without_a_subscription_nothing_is_due() -> None:
    slot = StateSlot()
    assert not slot.is_due(1.0)
    slot.start(10)
    slot.stop()
    assert not slot.is_due(1.0)


def test_only_the_newest_frame_waits() -> None:
    outbox = Outbox(2)
    outbox.put_state(b"old")
    outbox.put_state(b"new")
    assert (outbox.take(), outbox.take(), outbox.state.replaced) == (b"new", None, 1)


def test_the_oldest_notice_is_dropped_and_counted() -> None:
    outbox = Outbox(2)
    for notice in (b"1", b"2", b"3"):
        outbox.put_notice(notice)
    assert (outbox.take(), outbox.take(), outbox.take(), outbox.dropped) == (b"2", b"3", None, 1)


def test_notices_go_before_state() -> None:
    outbox = Outbox(2)
    outbox.put_state(b"state")
    outbox.put_notice(b"notice")
    assert (outbox.take(), outbox.take()) == (b"notice", b"state")
