"""How a joint stops: bounce and travel of every rule, by simulated servos behind the real driver.

No number here was compared with a real servo. Bounce and travel are taken from the simulated shaft every
millisecond, not from what the driver reads. Every condition makes each of the five joints of the Bento Arm
move at four speeds, in both directions, by four courses (`rigs.stops.MOTIONS`): 160 stops.
"""

import math
import statistics
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from multiprocessing import get_context

import click

from bentod.lateness.histogram import percentile
from tests.benchmarks.harness import BUILD, Row, at_least, at_most, main
from tests.benchmarks.rigs.stops import Condition, Seen, session
from tests.benchmarks.rigs.svg import Panel, Points, figure

RULES = ("full", "creep", "thesis", "last_position")
DEAD_TIMES = (0.005, 0.017, 0.033, 0.05)  # s
WRONG = (0.5, 1.5)
FULL, THESIS = Condition(rule="full"), Condition(rule="thesis")

TROUBLES: Mapping[str, Callable[[Condition], Condition]] = {
    "as it is": lambda c: c,
    "every order up to 10 ms late": lambda c: replace(c, jitter=0.01),
    "load misread by 3 %": lambda c: replace(c, load_offset=0.03),
    "2 % of packets lost, 2 % broken": lambda c: replace(c, loss=0.02),
    "10.5 V instead of 12 V": lambda c: replace(c, supply=10.5),
    "Goal Acceleration 286 deg/s2": lambda c: replace(c, acceleration=math.radians(286)),
    "Goal Acceleration 1146 deg/s2": lambda c: replace(c, acceleration=math.radians(1146)),
    "100 Hz instead of 30 Hz": lambda c: replace(c, rate_hz=100.0),
    "firmware 2": lambda c: replace(c, firmware=2),
}
"""What else may be true of an arm; tried at 33 ms with gravity, learning and dead-man on as by default."""

Results = Mapping[Condition, Sequence[Seen]]


def by_dead_time(condition: Condition, dead_time: float) -> list[Condition]:
    """With and without gravity."""
    return [replace(condition, dead_time=dead_time, gravity=gravity) for gravity in (False, True)]


def variants() -> dict[str, Condition]:
    """What is swept over dead time and gravity, by name."""
    wrong = {f"full, {share:g} of dead time": replace(FULL, believed=share) for share in WRONG}
    learned = {f"{name}, learning": replace(c, learning=True, sessions=2) for name, c in wrong.items()}
    bounded = {"full, dead-man 0.3 s": replace(FULL, dead_man=0.3)}
    return {rule: Condition(rule=rule) for rule in RULES} | wrong | learned | bounded


def troubled(rule: str, trouble: Callable[[Condition], Condition]) -> Condition:
    """`rule` in trouble, as the daemon runs it by default."""
    return trouble(Condition(rule=rule, dead_time=0.033, gravity=True, learning=True, dead_man=0.3))


def conditions() -> list[Condition]:
    """Everything that is run, the longest first."""
    swept = [c for v in variants().values() for dead in DEAD_TIMES for c in by_dead_time(v, dead)]
    odd = [troubled(rule, trouble) for rule in ("full", "thesis") for trouble in TROUBLES.values()]
    return sorted({*swept, *odd}, key=lambda c: (-c.sessions, str(c)))


def degrees(values: Sequence[float]) -> list[float]:
    """From rad."""
    return [math.degrees(value) for value in values]


def bounces(seen: Sequence[Seen]) -> list[float]:
    """In degrees."""
    return degrees([stop.bounce for stop in seen])


def travels(seen: Sequence[Seen]) -> list[float]:
    """In degrees."""
    return degrees([stop.travel for stop in seen])


class Sweep:
    """What was seen of every condition."""

    def __init__(self, results: Results) -> None:
        self._results = results

    def of(self, name: str, dead_time: float) -> list[Seen]:
        """All stops of a variant; of one that learns, those after its first half."""
        found = [s for c in by_dead_time(variants()[name], dead_time) for s in self._results[c]]
        last = max(stop.number for stop in found)
        return [s for s in found if s.number > last // 2] if variants()[name].learning else found

    def everywhere(self, name: str) -> list[Seen]:
        """All stops of a variant, at every dead time."""
        return [stop for dead in DEAD_TIMES for stop in self.of(name, dead)]

    def in_trouble(self, rule: str, trouble: str) -> Sequence[Seen]:
        """All stops of a rule in one kind of trouble."""
        return self._results[troubled(rule, TROUBLES[trouble])]

    def line(self, name: str, take: Callable[[Sequence[Seen]], float]) -> Points:
        """A number of a variant by dead time (ms)."""
        return [(dead * 1e3, take(self.of(name, dead))) for dead in DEAD_TIMES]


def mean_bounce(seen: Sequence[Seen]) -> float:
    """In degrees."""
    return statistics.fmean(bounces(seen))


def worst_bounce(seen: Sequence[Seen]) -> float:
    """In degrees."""
    return max(bounces(seen))


def median_travel(seen: Sequence[Seen]) -> float:
    """In degrees."""
    return statistics.median(travels(seen))


def rows(sweep: Sweep) -> Iterator[Row]:
    """The promises first, then all numbers."""
    full = sweep.everywhere("full")
    yield at_most("full, all dead times: bounce, median", statistics.median(bounces(full)), "deg", 0.3)
    yield at_most("full, all dead times: bounce, worst", worst_bounce(full), "deg", 0.7)
    yield from ratios(sweep, "thesis", "full", (0.05,), 5)
    yield from ratios(sweep, "last_position", "full", (0.05,), 8)
    for share in WRONG:
        yield from ratios(sweep, "thesis", f"full, {share:g} of dead time", DEAD_TIMES, 2)
    yield from kept(sweep)
    for name in variants():
        for dead in DEAD_TIMES:
            yield from numbers(f"{name}, {dead * 1e3:.0f} ms", sweep.of(name, dead))
    for trouble in TROUBLES:
        for rule in ("full", "thesis"):
            yield from numbers(f"{rule}, {trouble}", sweep.in_trouble(rule, trouble))


def ratios(sweep: Sweep, worse: str, better: str, dead_times: Sequence[float], bound: float) -> Iterator[Row]:
    """How many times less one bounces than the other: on average, and at worst. Medians may be 0."""
    for dead in dead_times:
        one, other = sweep.of(worse, dead), sweep.of(better, dead)
        at = f"{worse} / {better}, {dead * 1e3:.0f} ms"
        yield at_least(f"{at}: mean bounce", mean_bounce(one) / mean_bounce(other), "x", bound)
        yield at_least(f"{at}: worst bounce", worst_bounce(one) / worst_bounce(other), "x", bound)


def kept(sweep: Sweep) -> Iterator[Row]:
    """What learning mends, what the dead-man costs, and whether the driver tells the truth."""
    exact, bounded = sweep.everywhere("full"), sweep.everywhere("full, dead-man 0.3 s")
    for share in WRONG:
        learned = sweep.everywhere(f"full, {share:g} of dead time, learning")
        off = mean_bounce(learned) - mean_bounce(exact)
        yield at_most(f"learning from {share:g} of dead time: more bounce than exact, mean", off, "deg", 0.02)
        off = abs(median_travel(learned) - median_travel(exact))
        yield at_most(f"learning from {share:g} of dead time: travel off, median", off, "deg", 0.1)
    pairs = list(zip(exact, bounded, strict=True))
    cost = max(math.degrees(b.bounce - e.bounce) for e, b in pairs)
    yield at_most("dead-man 0.3 s: more bounce of one stop, worst", cost, "deg", 0.1)
    cost = max(abs(math.degrees(b.before - e.before)) for e, b in pairs)
    yield at_most("dead-man 0.3 s: way before the stop, worst difference", cost, "deg", 0.1)
    told = [abs(math.degrees(s.reported - s.bounce)) for s in sweep.everywhere("thesis")]
    yield Row("reported bounce of thesis, off by, median", statistics.median(told), "deg")
    yield Row("reported bounce of thesis, off by, p90", percentile(told, 0.9), "deg")


def numbers(name: str, seen: Sequence[Seen]) -> Iterator[Row]:
    """The numbers of one condition."""
    bounced = bounces(seen)
    yield Row(f"{name}: bounce, median", statistics.median(bounced), "deg")
    yield Row(f"{name}: bounce, mean", statistics.fmean(bounced), "deg")
    yield Row(f"{name}: bounce, worst", max(bounced), "deg")
    yield Row(f"{name}: travel, median", median_travel(seen), "deg")


def plot(sweep: Sweep) -> str:
    """Mean and worst bounce, and travel, by dead time."""
    shown = [*RULES, *(f"full, {share:g} of dead time" for share in WRONG)]
    takes = {
        "Bounce, mean": mean_bounce,
        "Bounce, worst": worst_bounce,
        "Travel after the stop, median": median_travel,
    }
    return figure(
        [
            Panel(title, "dead time, ms", "degrees", {name: sweep.line(name, take) for name in shown})
            for title, take in takes.items()
        ]
    )


def sweep_all() -> Sweep:
    """Every condition, on two processors."""
    wanted = conditions()
    with ProcessPoolExecutor(2, get_context("spawn")) as pool:
        return Sweep(dict(zip(wanted, pool.map(session, wanted), strict=True)))


if __name__ == "__main__":
    found = sweep_all()
    main("stop", rows(found))
    (BUILD / "stop.svg").write_text(plot(found))
    click.echo(f"written to {BUILD / 'stop.svg'}")
