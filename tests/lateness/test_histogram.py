import pytest
from hypothesis import given
from hypothesis import strategies as st

from bentod.lateness.histogram import EDGES, Histogram, draw, in_unit, percentile, percentiles
from bentod.lateness.ticking import NOTHING, Stretch, Ticks


def test_a_percentile_is_a_value_that_was_seen() -> None:
    values = [float(value) for value in range(100)]
    assert [percentile(values, share) for share in (0, 0.5, 0.99, 1)] == [0, 50, 99, 99]


def test_percentiles_have_the_names_that_people_know() -> None:
    assert percentiles([3.0, 1.0, 2.0]) == {"p50": 2.0, "p99": 3.0, "p99.9": 3.0, "max": 3.0}


@given(st.lists(st.floats(-1.0, 100.0)))
def test_every_value_is_in_one_bin(values: list[float]) -> None:
    assert sum(Histogram.of(values).counts) == len(values)


def test_a_value_falls_between_its_edges() -> None:
    counts = Histogram.of([0.0, 1.5e-6, 5.0]).counts
    assert [place for place, count in enumerate(counts) if count] == [0, 1, len(EDGES)]


def test_bars_show_also_what_is_rare() -> None:
    lines = draw([Histogram.of([50e-6] * 9999 + [20e-3])], ["ours"])
    assert "ours" in lines[0]
    assert "9999 █████" in lines[1]
    assert lines[-1].endswith("1 █▊")


def test_nothing_seen_is_nothing_drawn() -> None:
    assert draw([Histogram.of([])], ["ours"]) == []


@pytest.mark.parametrize(("seconds", "text"), [(52e-6, "52 µs"), (1.234e-3, "1.23 ms"), (2.0, "2 s")])
def test_lateness_is_told_in_the_unit_that_suits_it(seconds: float, text: str) -> None:
    assert in_unit(seconds) == text


def test_the_first_ticks_do_not_count() -> None:
    starts = {1.0: 1.5, 1.1: 1.11, 1.2: 1.22, 1.3: 9.0}
    assert Stretch(10, 2, first=1).judged(starts).late == pytest.approx((0.01, 0.02))


def test_a_deadline_without_a_tick_is_a_missed_tick() -> None:
    starts = {1.0: 1.0, 1.1: 1.35, 1.4: 1.4, 1.5: 1.5}
    assert Stretch(10, 4).judged(starts).missed == 2


def test_stretches_add_up() -> None:
    assert NOTHING + Ticks((0.1,), 1) + Ticks((0.2,), 2) == Ticks((0.1, 0.2), 3)
