"""What is refused when nobody knows how old it is."""

import pytest

from bentod.control.recency import DEAF, HELD_UP, Recency
from bentod.errors import Refused


def ticked(*times: float) -> Recency:
    recency = Recency()
    for time in times:
        recency.begin(time)
    return recency


def test_what_waited_while_the_daemon_was_held_up_is_refused() -> None:
    with pytest.raises(Refused, match=r"held up for 2\.00 s"):
        ticked(1.0, 3.0).require()
    with pytest.raises(Refused, match="ask again"):
        ticked(1.0, 3.0, 3.0 + DEAF / 2).require()


@pytest.mark.parametrize("times", [(1.0,), (1.0, 1.0 + HELD_UP * 0.9), (1.0, 3.0, 3.0 + DEAF * 1.01)])
def test_requests_are_taken_at_the_start_between_ticks_and_again_after_a_while(
    times: tuple[float, ...],
) -> None:
    ticked(*times).require()


def test_what_waited_while_the_machine_slept_is_refused_although_no_time_seems_to_have_passed() -> None:
    recency = ticked(1.0, 1.03)
    recency.slept(3600.0)
    with pytest.raises(Refused, match=r"held up for 3600\.00 s"):
        recency.require()
