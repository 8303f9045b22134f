"""One encoded frame for all browsers; slow ones get fewer frames, never old ones."""

from dataclasses import dataclass, field

import aiohttp
import pytest
from aiohttp.http_websocket import WSMsgType

from bentod.dashboard.audience import AHEAD, Audience, websocket_frame


@dataclass(eq=False)
class Browser:
    """Takes in frames only when it is told to."""

    got: list[bytes] = field(default_factory=list)
    waiting: list[int] = field(default_factory=list)
    left_out: int = 0

    @property
    def ahead(self) -> int:
        return len(self.waiting)

    def send(self, frame: bytes) -> None:
        self.got.append(frame)

    def skipped(self) -> None:
        self.left_out += 1

    def sent(self, number: int) -> None:
        self.waiting.append(number)


@pytest.mark.parametrize(
    ("size", "head"),
    [(5, "8205"), (125, "827d"), (126, "827e007e"), (65535, "827effff"), (65536, "827f0000000000010000")],
)
def test_a_frame_has_the_head_that_the_standard_wants(size: int, head: str) -> None:
    frame = websocket_frame(b"x" * size)
    assert frame[: len(head) // 2].hex() == head
    assert len(frame) == len(head) // 2 + size
    assert aiohttp.WSMsgType.BINARY is WSMsgType.BINARY


def test_all_browsers_get_the_same_bytes() -> None:
    audience = Audience(lambda: 0.0)
    one, other = Browser(), Browser()
    audience.listeners = {one, other}
    audience.show(audience.next_number(), b"frame")
    assert one.got[0] is other.got[0]


def test_a_browser_that_takes_nothing_in_gets_no_more_and_then_only_the_newest() -> None:
    audience = Audience(lambda: 0.0)
    slow, quick = Browser(), Browser()
    audience.listeners = {slow, quick}
    for number in range(1, 101):
        assert audience.next_number() == number
        audience.show(number, b"%d" % number)
        quick.waiting.clear()
    assert (len(slow.got), slow.left_out, len(quick.got)) == (AHEAD, 100 - AHEAD, 100)
    slow.waiting.clear()
    audience.show(audience.next_number(), b"101")
    assert slow.got[-1] == websocket_frame(b"101")


def test_what_must_not_be_missed_goes_to_slow_browsers_too() -> None:
    audience = Audience(lambda: 0.0)
    slow = Browser(waiting=list(range(100)))
    audience.listeners = {slow}
    audience.tell(b"event")
    assert slow.got == [websocket_frame(b"event")]


def test_the_age_of_a_frame_is_known_until_it_is_long_past() -> None:
    now = 0.0
    audience = Audience(lambda: now)
    first = audience.next_number()
    now = 0.2
    assert audience.age(first) == pytest.approx(0.2)
    for _ in range(300):
        audience.next_number()
    assert audience.age(first) == audience.age(0) == audience.age(10**6) == float("inf")
