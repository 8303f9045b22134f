"""When garbage is collected, and when not, with a clock of the tests' own."""

import gc
from collections.abc import Iterator, Mapping

import pytest

from bentod.collector import DUE, OVERDUE, STUCK, SlackCollector

AMPLE = 1e9


class Stopwatch:
    """A clock on which a collection takes as long as it is told to."""

    def __init__(self) -> None:
        self.time = 0.0

    def now(self) -> float:
        return self.time

    def wall(self) -> float:
        return self.time

    async def sleep_until(self, deadline: float) -> None:
        raise NotImplementedError


class Heap:
    """Stands for Python's collector: counts what it is given, and takes its time."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.objects = 0
        self.clock = Stopwatch()
        self.takes = [0.0001, 0.001, 0.004]  # s, by generation
        self.collected: list[int] = []
        self.collector = SlackCollector(self.clock)
        monkeypatch.setattr(gc, "get_count", lambda: (self.objects, 0, 0))
        monkeypatch.setattr(gc, "collect", self._collect)

    def _collect(self, generation: int) -> None:
        self.collected.append(generation)
        self.clock.time += self.takes[generation] * (self.objects / DUE[0] if generation == 0 else 1)
        self.objects = 0

    def tick(self, objects: int = DUE[0], slack: float = AMPLE) -> list[int]:
        """A tick that leaves so many objects and so much time (s); what is collected."""
        self.objects += objects
        before = len(self.collected)
        self.collector.collect(self.clock.time + slack)
        return self.collected[before:]


@pytest.fixture
def heap(monkeypatch: pytest.MonkeyPatch) -> Heap:
    return Heap(monkeypatch)


def test_few_objects_are_left_alone(heap: Heap) -> None:
    assert heap.tick(DUE[0] - 1) == []
    assert heap.tick(1) == [0]


def test_the_young_generation_is_collected_often_the_older_ones_rarely(heap: Heap) -> None:
    for _ in range(1000):
        heap.tick()
    counts = [heap.collected.count(generation) for generation in range(3)]
    assert counts[2] == 3
    assert counts[1] == pytest.approx(1000 / 11, abs=4)
    assert sum(counts) == 1000


def test_a_collection_that_took_longer_than_is_left_of_the_period_waits(heap: Heap) -> None:
    heap.takes[0] = 0.010  # for as many objects as are due
    assert heap.tick() == [0]
    assert heap.tick(slack=0.015) == []
    assert heap.tick(slack=0.035) == []
    assert heap.tick(slack=0.065) == [0]


def test_one_collection_that_was_held_up_does_not_put_off_those_after_it(heap: Heap) -> None:
    for _ in range(3):
        assert heap.tick(slack=0.001) == [0]
    heap.takes[0] = 1.0
    assert heap.tick(slack=0.001) == [0]
    heap.takes[0] = 0.0001
    for _ in range(3):
        assert heap.tick(slack=0.001) == [0]


def test_an_old_generation_that_does_not_fit_leaves_its_time_to_the_young_one(heap: Heap) -> None:
    heap.takes[1] = 0.010
    while 1 not in heap.collected:
        heap.tick()
    for _ in range(20):
        assert heap.tick(slack=0.005) == [0]
    assert heap.tick() == [1]


def test_without_any_slack_memory_still_has_a_bound(heap: Heap) -> None:
    piled: list[int] = []
    for _ in range(100_000):
        heap.tick(slack=-1.0)
        piled.append(heap.objects)
    assert max(piled) < OVERDUE[0] + DUE[0]
    assert heap.collected.count(0) == pytest.approx(100_000 * DUE[0] / OVERDUE[0], rel=0.02)


def test_the_oldest_generation_is_collected_at_last_even_if_it_never_fits(heap: Heap) -> None:
    heap.takes[2] = 1.0
    while 2 not in heap.collected:
        heap.tick()
    heap.collected.clear()
    for _ in range(2 * DUE[1] * OVERDUE[2]):
        heap.tick(slack=0.030)
    assert heap.collected.count(2) == 1
    assert heap.collected.count(1) > DUE[1] * DUE[2]


@pytest.fixture
def collector() -> Iterator[SlackCollector]:
    collector = SlackCollector(Stopwatch())
    before = gc.get_threshold()
    assert gc.isenabled()
    yield collector
    assert gc.isenabled()
    assert gc.get_threshold() == before


def litter(circles: int) -> list[int]:
    """Leave so many pieces of garbage; the generations that Python collects meanwhile by itself."""
    collected: list[int] = []

    def note(phase: str, info: Mapping[str, int]) -> None:
        if phase == "start":
            collected.append(info["generation"])

    gc.callbacks.append(note)
    try:
        for _ in range(circles):
            circle: list[object] = []
            circle.append(circle)
    finally:
        gc.callbacks.remove(note)
    return collected


def test_between_two_ticks_python_collects_nothing_by_itself(collector: SlackCollector) -> None:
    with collector:
        for _ in range(20):
            assert litter(OVERDUE[0]) == []
            collector.collect(-AMPLE)
            assert gc.get_count()[0] < OVERDUE[0]


def test_where_ticks_have_ceased_python_collects_by_itself(collector: SlackCollector) -> None:
    with collector:
        collected = litter(12 * STUCK[0])
        assert len(collected) >= 11
        assert gc.get_count()[0] <= STUCK[0]
    assert litter(12 * STUCK[0]) != collected


def test_what_has_been_built_is_not_looked_through_again(collector: SlackCollector) -> None:
    frozen = gc.get_freeze_count()
    with collector:
        assert gc.get_freeze_count() > frozen + 1000
    assert gc.get_freeze_count() == 0


def test_a_process_that_had_it_switched_off_finds_it_switched_off(collector: SlackCollector) -> None:
    gc.disable()
    try:
        with collector:
            pass
        assert not gc.isenabled()
    finally:
        gc.enable()


def test_garbage_in_a_circle_is_found_in_the_slack(collector: SlackCollector) -> None:
    with collector:
        gone: list[list[object]] = [[] for _ in range(2 * DUE[0])]
        for circle in gone:
            circle.append(circle)
        before = gc.get_count()[0]
        del gone, circle
        collector.collect(AMPLE)
        assert gc.get_count()[0] < before - DUE[0]
