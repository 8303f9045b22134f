import itertools
from collections.abc import Callable, Sequence

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drivers.emg.package_counter import PackageCounter

COUNTERS: dict[str, tuple[Callable[[int], int], int]] = {
    "of one byte": (lambda n: n % 256, 1),
    "that never turns": (lambda n: 1000 + n, 1),
    "from 0 to 199": (lambda n: n % 200, 1),
    "from 101 to 200, of two samples": (lambda n: 101 + n % 100, 2),
    "in steps of two": (lambda n: (1 + 2 * n) % 256, 1),
    "of two bytes, of eight samples": (lambda n: n % 65536, 8),
}
"""By what is told of it: number of package n, and samples in a package."""


def counted(name: str, packages: Sequence[int]) -> list[float]:
    number, samples = COUNTERS[name]
    return [float(number(package)) for package in packages for _ in range(samples)]


@pytest.mark.parametrize("name", COUNTERS)
@settings(max_examples=15, deadline=None)
@given(lost=st.dictionaries(st.sampled_from(range(300, 901, 100)), st.integers(1, 90), max_size=5))
def test_every_package_that_is_lost_is_found_once_a_round_was_seen(name: str, lost: dict[int, int]) -> None:
    missing = {start + ahead for start, count in lost.items() for ahead in range(count)}
    packages = [package for package in range(1100) if package not in missing]
    gaps = PackageCounter().gaps(counted(name, packages))
    samples = COUNTERS[name][1]
    expected = {
        place * samples: (after - before - 1) * samples
        for place, (before, after) in enumerate(itertools.pairwise(packages), 1)
        if after - before > 1
    }
    assert dict(gaps) == expected


@pytest.mark.parametrize("name", COUNTERS)
@settings(max_examples=15, deadline=None)
@given(cuts=st.lists(st.integers(0, 1000), max_size=20))
def test_it_does_not_matter_how_the_numbers_are_cut(name: str, cuts: list[int]) -> None:
    numbers = counted(name, [n for n in range(800) if n not in (350, 351, 500)])
    edges = [0, *sorted(cuts), len(numbers)]
    counter = PackageCounter()
    found = [
        (start + place, count)
        for start, end in itertools.pairwise(edges)
        for place, count in counter.gaps(numbers[start:end])
    ]
    assert found == PackageCounter().gaps(numbers)
    assert found


@pytest.mark.parametrize("numbers", [[], [7.0], [0.0] * 50, [float("nan")] * 9, [5.0, 4.0, 3.0, 2.0]])
def test_numbers_that_do_not_count_tell_no_loss(numbers: list[float]) -> None:
    assert PackageCounter().gaps(numbers) == []
