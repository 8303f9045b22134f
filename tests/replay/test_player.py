import asyncio
from collections.abc import Iterator
from dataclasses import dataclass, field, replace

import pytest

from bentod.errors import BadRequest
from bentod.frames import Event, Frame
from bentod.replay.player import FASTEST, Player, Span
from sim.clock import VirtualClock
from tests.serve.helpers import frame

ENTRIES: list[object] = [
    entry
    for number in range(300)
    for entry in (
        replace(frame(number), time=100 + number / 30),
        Event(100 + number / 30, "group", "toggled", {}),
    )
]
SPAN = Span(100.0, 100.0 + 299 / 30)


class Tape:
    def entries(self, start: float | None = None) -> Iterator[object]:
        return (e for e in ENTRIES if start is None or (isinstance(e, Frame | Event) and e.time >= start))


@dataclass
class Screen:
    """What was played, and when (s of the clock since it was made)."""

    shown: list[tuple[float, object]] = field(default_factory=list)
    clock: VirtualClock = field(default_factory=VirtualClock)

    def __post_init__(self) -> None:
        self.began = self.clock.now()

    def show(self, entry: object) -> None:
        self.shown.append((self.clock.now() - self.began, entry))

    def ticks(self) -> list[int]:
        return [entry.tick for _, entry in self.shown if isinstance(entry, Frame)]

    def player(self, speed: float = 1.0, loop: bool = False) -> Player:
        return Player(Tape(), SPAN, self.clock, self.show, speed, loop)


async def test_every_entry_is_played_once_in_order_and_frames_at_their_times() -> None:
    screen = Screen()
    await screen.player().run()
    assert [entry for _, entry in screen.shown] == ENTRIES
    for time, entry in screen.shown:
        if isinstance(entry, Frame):
            assert time == pytest.approx(entry.time - 100, abs=1e-6)


@pytest.mark.parametrize(("speed", "seconds"), [(2.0, 299 / 60), (0.5, 299 / 15), (FASTEST, 0.0)])
async def test_a_recording_takes_its_time_divided_by_the_speed(speed: float, seconds: float) -> None:
    screen = Screen()
    await screen.player(speed).run()
    assert screen.clock.now() - screen.began == pytest.approx(seconds, abs=1e-3)


async def test_nothing_is_played_while_it_is_paused_and_nothing_is_lost() -> None:
    screen = Screen()
    player = screen.player()
    task = asyncio.create_task(player.run())
    await asyncio.sleep(1.01)
    player.pause(True)
    await asyncio.sleep(0.1)
    until = len(screen.shown)
    await asyncio.sleep(5)
    assert len(screen.shown) == until
    player.pause(False)
    await task
    assert screen.ticks() == list(range(300))
    assert screen.clock.now() - screen.began == pytest.approx(299 / 30 + 5.1, abs=0.05)


async def test_seeking_forth_and_back_goes_on_from_there_even_while_paused() -> None:
    screen = Screen()
    player = screen.player()
    task = asyncio.create_task(player.run())
    await asyncio.sleep(0.5)
    player.seek(9.0)
    await asyncio.sleep(0.01)
    assert screen.ticks()[-1] == 270
    player.pause(True)
    player.seek(3.0)
    await asyncio.sleep(1)
    assert screen.ticks()[-1] == 90
    player.pause(False)
    assert player.position == pytest.approx(3.0)
    await task
    assert screen.ticks()[-1] == 299


async def test_a_loop_begins_again_until_it_is_switched_off() -> None:
    screen = Screen()
    player = screen.player(loop=True)
    task = asyncio.create_task(player.run())
    await asyncio.sleep(15)
    player.loop = False
    await task
    assert screen.ticks() == [*range(300), *range(300)]


async def test_a_player_that_stays_waits_at_the_end_for_another_place() -> None:
    screen = Screen()
    player = screen.player(FASTEST)
    player.stay = True
    task = asyncio.create_task(player.run())
    await asyncio.sleep(1)
    assert not task.done()
    player.seek(9.9)
    await asyncio.sleep(1)
    assert screen.ticks()[300:] == [297, 298, 299]
    player.stay = False
    player.seek(9.9)
    await task


async def test_a_new_speed_holds_from_the_moment_it_is_asked_for() -> None:
    screen = Screen()
    player = screen.player(0.1)
    task = asyncio.create_task(player.run())
    await asyncio.sleep(1.0)
    player.set_speed(10.0)
    await task
    assert screen.clock.now() - screen.began == pytest.approx(1.0 + (299 / 30 - 0.1) / 10, abs=0.05)


async def test_places_and_speeds_that_cannot_be_are_refused() -> None:
    player = Screen().player()
    with pytest.raises(BadRequest, match="outside the recording"):
        player.seek(11.0)
    with pytest.raises(BadRequest, match="above 0"):
        player.set_speed(0.0)
    with pytest.raises(BadRequest, match="above 0"):
        player.set_speed(float("nan"))
