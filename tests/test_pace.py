"""What a tick does with its time, and what is told of ticks that were missed, in virtual time."""

import asyncio
from collections.abc import Mapping, Sequence
from dataclasses import astuple
from itertools import pairwise

import pytest

from bentod.collector import Collector
from bentod.config_learn import Learn
from bentod.control.groups import Groups
from bentod.culprit import GARBAGE, IDLE, Lookout
from bentod.frames import Command, Event, Frame, Stop, Velocity
from bentod.learn.horde import HasTime, unhurried
from bentod.learn.signals import Percept
from bentod.mind import Mind
from bentod.pace import Complaints, Late, Pace
from bentod.realtime import Upkeep
from bentod.tick import Controller
from sim.clock import VirtualClock, VirtualLoop
from tests.fakes import PERIOD, SPECS, Bench


def block(seconds: float) -> None:
    """Hold the loop."""
    loop = asyncio.get_running_loop()
    assert isinstance(loop, VirtualLoop)
    loop.block(seconds)


def learning(*timescales: float, budget: float = 0.6) -> Mind:
    learn = Learn(joints=("shoulder", "elbow"), timescales=timescales, budget=budget)
    return Mind(SPECS, 1 / PERIOD, Groups(SPECS, {}), learn)


def told(bench: Bench) -> list[Event]:
    return [event for event in bench.events if event.kind == "late"]


class SlowBench(Bench):
    """Takes its time in every phase."""

    def __init__(self) -> None:
        super().__init__(_SlowMind())
        self.arm.slow = dict.fromkeys(range(10), 0.010)
        write = self.arm.write

        async def slow_write(commands: Sequence[Command | None]) -> None:
            await asyncio.sleep(0.003)
            await write(commands)

        self.arm.write = slow_write  # type: ignore[method-assign]

    def _publish(self, frame: Frame, events: Sequence[Event], whole: bool) -> None:
        block(0.001)
        super()._publish(frame, events, whole)


class _SlowMind(Mind):
    """Thinks for 2 ms before the write, and for 2 ms after it."""

    def __init__(self) -> None:
        super().__init__(SPECS, 1 / PERIOD, Groups(SPECS, {}))

    def predict(self, percept: Percept, has_time: HasTime = unhurried) -> None:
        block(0.002)

    def learn(self, has_time: HasTime = unhurried) -> None:
        block(0.002)


async def test_a_frame_tells_what_its_phases_took_and_what_publishing_the_one_before_took() -> None:
    bench = SlowBench()
    await bench.controller.run(3)
    costs = [astuple(frame.costs) for frame in bench.frames]
    assert costs[0] == pytest.approx((0.010, 0.004, 0.003, 0.0))
    assert costs[1:] == [pytest.approx((0.010, 0.004, 0.003, 0.001))] * 2


async def test_the_servos_are_written_before_anything_is_learned_that_no_assist_follows() -> None:
    written: list[int] = []

    class Witness(Mind):
        def learn(self, has_time: HasTime = unhurried) -> None:
            written.append(len(bench.arm.sent))

    bench = Bench(Witness(SPECS, 1 / PERIOD, Groups(SPECS, {})))
    await bench.controller.run(3)
    assert written == [1, 2, 3]


async def test_a_tick_whose_time_is_nearly_spent_obeys_and_predicts_but_does_not_learn() -> None:
    bench = Bench(learning(10, 20))
    await bench.set_off()
    bench.arm.slow = {4: 0.59 * PERIOD, 6: 0.61 * PERIOD}
    await bench.controller.run(6)
    assert [frame.shed for frame in bench.frames] == [0, 0, 0, 0, 0, 0, 2, 2, 2]
    assert bench.arm.sent[6] == (Velocity(0.4), Stop())
    assert bench.frames[6].joints[0].predictions.keys() == {"10", "20"}
    assert bench.frames[-1].missed == 0


async def test_lateness_is_taken_from_the_time_for_learning() -> None:
    bench = Bench(learning(20, budget=0.5))
    asyncio.get_running_loop().call_later(2.9 * PERIOD, block, 0.7 * PERIOD)
    await bench.controller.run(5)
    assert [frame.shed for frame in bench.frames] == [0, 0, 1, 1, 1]


async def test_without_learners_nothing_is_shed() -> None:
    bench = Bench()
    bench.arm.slow = {1: 0.9 * PERIOD}
    await bench.controller.run(3)
    assert bench.frames[-1].shed == 0


async def test_ticks_that_were_missed_are_told_at_once_with_the_phase_that_took_long() -> None:
    bench = Bench()
    bench.arm.slow = {4: 3.2 * PERIOD}
    await bench.controller.run(12)
    assert [event.text for event in told(bench)] == [
        "3 ticks were missed: a tick took long to read, 106.7 ms"
    ]
    data = told(bench)[0].data
    assert data["missed"] == 3
    assert isinstance(costs := data["costs"], dict)
    assert costs["read"] == pytest.approx(3.2 * PERIOD)


async def test_a_loop_that_is_held_between_two_ticks_makes_one_begin_late() -> None:
    bench = Bench()
    asyncio.get_running_loop().call_later(5.1 * PERIOD, block, 2.5 * PERIOD)
    await bench.controller.run(12)
    assert [event.text for event in told(bench)] == ["1 tick was missed: a tick began late, by 53.3 ms"]
    assert max(frame.lateness for frame in bench.frames) == pytest.approx(1.6 * PERIOD)


async def test_a_tick_that_is_late_but_done_in_time_is_no_news() -> None:
    bench = Bench()
    asyncio.get_running_loop().call_later(5.1 * PERIOD, block, 1.7 * PERIOD)
    await bench.controller.run(12)
    assert max(frame.lateness for frame in bench.frames) == pytest.approx(0.8 * PERIOD)
    assert (told(bench), bench.frames[-1].missed) == ([], 0)


async def test_an_arm_that_misses_ticks_all_the_time_says_so_every_ten_seconds_and_counts() -> None:
    bench = Bench()
    bench.arm.slow = dict.fromkeys(range(600), 1.5 * PERIOD) | {200: 4.5 * PERIOD}
    await bench.controller.run(600)
    late = told(bench)
    assert [b.time - a.time for a, b in pairwise(late)] == pytest.approx([10.0] * (len(late) - 1), abs=0.1)
    assert len(late) == 4
    assert late[0].text == "1 tick was missed: a tick took long to read, 50.0 ms"
    assert ", at most 4 in a row: a tick took long to read, 150.0 ms" in late[2].text
    counted = [number for event in late if isinstance(number := event.data["missed"], int)]
    assert 0 < bench.frames[-1].missed - sum(counted) <= 150


def test_what_was_missed_while_nothing_was_to_be_said_is_said_later_though_all_is_well_again() -> None:
    complaints = Complaints()
    complaints.add(Late(1, "first", {}))
    assert complaints.due(100.0) == Late(1, "1 tick was missed: first", {"missed": 1})
    for late in (
        Late(2, "second", {"culprit": "x"}),
        Late(5, "third", {"culprit": "y"}),
        Late(1, "last", {}),
    ):
        complaints.add(late)
    assert complaints.due(109.9) is None
    text = "8 ticks were missed, at most 5 in a row: third"
    assert complaints.due(110.0) == Late(8, text, {"missed": 8, "culprit": "y"})
    assert complaints.due(200.0) is None


class FakeLookout(Lookout):
    """Has seen what it is told that it has seen."""

    def __init__(self, **held: float) -> None:
        self.held: Mapping[str, float] = held
        self.asked: list[tuple[float, float, float]] = []

    def watch(self, due: float, now: float, after: float) -> None:
        self.asked.append((due, now, after))

    def seen(self) -> Mapping[str, float]:
        return self.held


@pytest.mark.parametrize(
    ("held", "told"),
    [
        ({"a.py:1 f()": 0.01, "b.py:2 g()": 0.05, IDLE: 0.02}, "b.py:2 g() held the loop for about 50 ms"),
        ({IDLE: 0.06}, "nothing held the loop: it waited, or the machine did not let it run"),
        ({GARBAGE: 0.06}, "garbage was being collected for about 60 ms"),
    ],
)
async def test_whoever_held_the_loop_longest_is_named(
    held: Mapping[str, float], told: str, clock: VirtualClock
) -> None:
    lookout = FakeLookout(**held)
    pace = Pace(clock, PERIOD, PERIOD, lookout)
    pace.begin(clock.now())
    await asyncio.sleep(2 * PERIOD)
    late = pace.end(3 * PERIOD, 2)
    assert late is not None
    assert late.text == f"2 ticks were missed: a tick took long to think, 66.7 ms; {told}"
    assert late.data["culprit"] in held


async def test_the_lookout_begins_where_the_next_tick_would_be_overdue(clock: VirtualClock) -> None:
    lookout, bench = FakeLookout(), Bench()
    upkeep = Upkeep(lookout=lookout)
    controller = Controller(bench.arm, bench.desk, bench.inbox, clock, 30, lambda *_: None, upkeep)
    await controller.run(2)
    assert lookout.asked == [
        pytest.approx((2 * PERIOD, PERIOD, 0.75 * PERIOD)),
        pytest.approx((3 * PERIOD, 2 * PERIOD, 0.75 * PERIOD)),
    ]


async def test_garbage_may_be_collected_after_each_tick_until_the_next_deadline(clock: VirtualClock) -> None:
    class FakeCollector(Collector):
        def collect(self, deadline: float) -> None:
            asked.append((clock.now(), deadline))

    asked: list[tuple[float, float]] = []
    bench = Bench()
    bench.arm.slow = {1: 1.5 * PERIOD}
    upkeep = Upkeep(FakeCollector())
    await Controller(bench.arm, bench.desk, bench.inbox, clock, 30, lambda *_: None, upkeep).run(3)
    assert asked == [
        pytest.approx((PERIOD, 2 * PERIOD)),
        pytest.approx((3.5 * PERIOD, 4 * PERIOD)),
        pytest.approx((4 * PERIOD, 5 * PERIOD)),
    ]
