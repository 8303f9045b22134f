"""Clocks that part slowly are followed; a source that is late is not."""

import pytest

from bentod.emg.drift import GREATEST, QUARTZ, TOTAL, Drift


def after(
    seconds: float, share: float, drift: Drift | None = None, late: float = 0.0, start: float = 0.0
) -> Drift:
    """Blocks every 10 ms on a clock that is slow by `share`, and `late` (s) on their way."""
    drift = drift or Drift()
    for step in range(int(seconds * 100)):
        now = start + step * 0.01
        drift.take(now - now * share - late, now)
    return drift


@pytest.mark.parametrize("share", [0.0001, 0.004, -0.01, -0.018])
def test_a_clock_that_drifts_is_followed(share: float) -> None:
    assert after(60, share).offset == pytest.approx(60 * share, abs=2 * abs(share) + 1e-6)


def test_what_may_be_the_way_is_followed_so_far_and_no_farther() -> None:
    drift = after(600, 0.01)
    assert drift.offset == pytest.approx(TOTAL + 600 * QUARTZ, abs=0.02)
    assert after(600, -0.01, drift, start=600).offset < 0


def test_slow_after_fast_is_followed_no_farther_either() -> None:
    drift = after(100, -0.01)
    assert after(600, 0.01, drift, late=-2.0, start=100).offset < -1 + TOTAL + 700 * QUARTZ


def test_a_true_clock_is_left_alone() -> None:
    assert after(60, 0.0, late=0.02).offset == pytest.approx(0.0, abs=1e-6)


def test_a_source_that_becomes_late_stays_late() -> None:
    drift = after(10, 0.0)
    assert after(10, 0.0, drift, late=0.3, start=10).offset == pytest.approx(0.0, abs=1e-6)


def test_faster_than_clocks_part_is_late() -> None:
    assert after(10, 3 * GREATEST).offset == 0.0


def test_jitter_on_the_way_is_not_the_clocks() -> None:
    drift = Drift()
    for step in range(6000):
        now = step * 0.01
        drift.take(now - 0.01 * (step % 7), now)
    assert drift.offset == pytest.approx(0.0, abs=0.001)
