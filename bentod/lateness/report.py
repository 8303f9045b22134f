"""What a trial found, for people and for programs: percentiles, histograms, and a verdict in a sentence."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from bentod.frames import Value
from bentod.lateness.histogram import EDGES, SHARES, Histogram, draw, in_unit, percentiles
from bentod.lateness.ticking import Ticks
from bentod.lateness.trial import CLOCK, DAEMON, Case, Round, describe, together, undisturbed

EARLY_ENOUGH = 0.25
"""Share of its period within which all but one tick in a thousand must begin."""

BUSY = 0.5
"""Load average before a trial, above which other programs are in its way."""

FEW = 1000
"""Ticks, with fewer of which one in a thousand is not known."""


@dataclass(frozen=True, slots=True)
class Report:
    """One trial on one machine."""

    machine: Mapping[str, str | int]
    scheduling: str
    busy: float  # load average just before
    rounds: Sequence[Round]

    @property
    def counted(self) -> Sequence[Round]:
        """Rounds that the host of a virtual machine left alone, or all."""
        return undisturbed(self.rounds)

    @property
    def found(self) -> dict[Case, Ticks]:
        """What was seen in the rounds that count."""
        return together(self.counted)

    def data(self) -> dict[str, Value]:
        """For a program: SI units."""
        return {
            "verdict": self.verdict(),
            "machine": dict(self.machine),
            "scheduling": self.scheduling,
            "load_average_before": self.busy,
            "stolen_by_host": [one.stolen for one in self.rounds],
            "rounds_counted": len(self.counted),
            "edges_s": list(EDGES),
            "runs": [_run(case, ticks) for case, ticks in self.found.items()],
        }

    def lines(self) -> Iterator[str]:
        """For a terminal."""
        machine = self.machine
        yield f"{machine['cpu']} ({machine['cores']} cores), {machine['kernel']}"
        yield f"Python {machine['python']}; scheduling: {self.scheduling}"
        for rate, loaded in dict.fromkeys((case.rate_hz, case.loaded) for case in self.found):
            yield ""
            yield from self._part(rate, loaded)
        yield ""
        yield self.verdict()
        yield from self._reservations()

    def verdict(self) -> str:
        """Which rates this machine is good for."""
        objections = {rate: self._objection(rate) for rate in sorted({case.rate_hz for case in self.found})}
        good = [rate for rate, why in objections.items() if not why]
        parts = [f"{_listed(good)} {'are' if len(good) > 1 else 'is'} safe here"] if good else []
        parts += [f"{rate:g} Hz is not safe here ({why})" for rate, why in objections.items() if why]
        return f"{', '.join(parts)}."

    def _reservations(self) -> Iterator[str]:
        """What to keep in mind about the verdict."""
        if any(len(ticks.late) < FEW for ticks in self.found.values()):
            yield "Measure longer to be sure of the rarest: one tick in a thousand is not known from fewer."
        if self.busy > BUSY:
            yield f"Other programs were at work (load average {self.busy:.1f})."
        left_out = len(self.rounds) - len(self.counted)
        if left_out:
            yield f"{left_out} of {len(self.rounds)} rounds were disturbed by the host and are left out."
        elif not all(one.calm for one in self.rounds):
            took = max(one.stolen for one in self.rounds)
            yield f"The host of this virtual machine took up to {took:.1%} of it: some of this is its doing."

    def _objection(self, rate: float) -> str:
        """Why a rate is not safe, by its worst case; the clock alone speaks for a rate that has no daemon."""
        way = DAEMON if any(case.rate_hz == rate and case.way == DAEMON for case in self.found) else CLOCK
        for case, ticks in self.found.items():
            if (case.rate_hz, case.way) != (rate, way):
                continue
            late = percentiles(ticks.late)["p99.9"]
            when = "under load" if case.loaded else "idle"
            if ticks.missed:
                missed = "a tick was" if ticks.missed == 1 else f"{ticks.missed} ticks were"
                return f"{when}, {missed} missed"
            if late * rate > EARLY_ENOUGH:
                return f"{when}, one tick in a thousand is {in_unit(late)} late or more"
        return ""

    def _part(self, rate: float, loaded: bool) -> Iterator[str]:
        cases = [case for case in self.found if (case.rate_hz, case.loaded) == (rate, loaded)]
        yield f"{rate:g} Hz, {'under load' if loaded else 'idle'}: how late a tick begins"
        yield f"  {'':<16}" + "".join(f"{name:>10}" for name in (*SHARES, "ticks", "missed"))
        for case in cases:
            ticks = self.found[case]
            cells = [in_unit(value) for value in percentiles(ticks.late).values()]
            counts = [str(len(ticks.late)), str(ticks.missed)]
            yield f"  {case.way:<16}" + "".join(f"{cell:>10}" for cell in (*cells, *counts))
        yield from draw([Histogram.of(self.found[case].late) for case in cases], [c.way for c in cases])


def _run(case: Case, ticks: Ticks) -> Value:
    return {
        "way": case.way,
        "rate_hz": case.rate_hz,
        "loaded": case.loaded,
        "what": describe(case),
        "ticks": len(ticks.late),
        "missed": ticks.missed,
        "late_s": dict(percentiles(ticks.late)),
        "counts": list(Histogram.of(ticks.late).counts),
    }


def _listed(rates: Sequence[float]) -> str:
    words = [f"{rate:g} Hz" for rate in rates]
    return " and ".join(filter(None, (", ".join(words[:-1]), words[-1])))
