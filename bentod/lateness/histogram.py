"""Many latenesses in a few numbers: percentiles, bins of a logarithmic scale, and bars of text."""

import bisect
from collections.abc import Sequence
from dataclasses import dataclass

EDGES = tuple(round(10 ** (step / 4) * 1e-6, 9) for step in range(25))
"""s; four bins a decade from 1 µs to 1 s. One more bin lies before the first edge, and one after the last."""

SHARES = {"p50": 0.5, "p99": 0.99, "p99.9": 0.999, "max": 1.0}

WIDTH = 24
"""Characters of the longest bar."""

BLOCKS = " ▏▎▍▌▋▊▉█"


def percentile(values: Sequence[float], share: float) -> float:
    """The value that `share` (0..1) of the values do not exceed: one of them, never between two."""
    ordered = sorted(values)
    return ordered[min(int(share * len(ordered)), len(ordered) - 1)]


@dataclass(frozen=True, slots=True)
class Histogram:
    """How often values fell between each two of `EDGES`."""

    counts: tuple[int, ...]  # one more than there are edges

    @classmethod
    def of(cls, values: Sequence[float]) -> "Histogram":
        """Of values in s; what is early counts as on time."""
        counts = [0] * (len(EDGES) + 1)
        for value in values:
            counts[bisect.bisect_right(EDGES, value)] += 1
        return cls(tuple(counts))

    def share(self, place: int) -> float:
        """Share of all values in one bin, 0..1."""
        return self.counts[place] / max(sum(self.counts), 1)


def percentiles(values: Sequence[float]) -> dict[str, float]:
    """Of at least one value (s), by name."""
    return {name: percentile(values, share) for name, share in SHARES.items()}


def draw(histograms: Sequence[Histogram], titles: Sequence[str]) -> list[str]:
    """Lines of text: one a bin that any of them reaches, a column each.

    Bars grow with the logarithm of the count: what happens once in ten thousand is what one looks for.
    """
    used = [place for place in range(len(EDGES) + 1) if any(h.counts[place] for h in histograms)]
    if not used:
        return []
    head = " " * 18 + "  ".join(title.ljust(WIDTH + 7) for title in titles)
    rows = [
        f"{_range(place):>16}  " + "  ".join(_cell(histogram, place) for histogram in histograms)
        for place in range(used[0], used[-1] + 1)
    ]
    return [line.rstrip() for line in (head, *rows)]


def in_unit(seconds: float) -> str:
    """A lateness as a person reads it."""
    micros = seconds * 1e6
    if micros < 1000:
        return f"{micros:.0f} µs"
    return f"{micros / 1e3:.3g} ms" if micros < 1e6 else f"{seconds:.3g} s"


def _range(place: int) -> str:
    if place == len(EDGES):
        return f"{in_unit(EDGES[-1])} and more"
    return f"below {in_unit(EDGES[place])}"


def _cell(histogram: Histogram, place: int) -> str:
    count = histogram.counts[place]
    full = _log(sum(histogram.counts))
    eighths = round(8 * WIDTH * _log(count) / full) if count else 0
    bar = BLOCKS[-1] * (eighths // 8) + BLOCKS[eighths % 8].strip()
    return f"{count or '':>6} {bar.ljust(WIDTH)}"


def _log(count: int) -> int:
    return count.bit_length()
