import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bentod.emg.windows import Ring
from bentod.frames import EmgBlock, Samples


def ramp(first: int, count: int, channels: int = 2) -> Samples:
    """Samples whose value is their index."""
    return np.repeat(np.arange(first, first + count, dtype=np.float32)[:, np.newaxis], channels, axis=1)


def block(first: int, count: int) -> EmgBlock:
    return EmgBlock(first, first / 100, ramp(first, count))


def test_a_new_ring_is_empty() -> None:
    ring = Ring(100.0, 2)
    assert ring.next_index == 0
    assert ring.newest == -math.inf
    assert ring.since(0).shape == (0, 2)


@given(sizes=st.lists(st.integers(1, 40), min_size=1, max_size=60), back=st.integers(0, 60))
def test_a_stretch_holds_the_samples_of_its_indices(sizes: list[int], back: int) -> None:
    ring = Ring(100.0, 2, seconds=0.25)
    for size in sizes:
        ring.append(block(ring.next_index, size))
        wanted = max(ring.next_index - back, ring.oldest_index)
        np.testing.assert_array_equal(
            ring.since(ring.next_index - back), ramp(wanted, ring.next_index - wanted)
        )


def test_what_is_asked_for_too_late_begins_with_the_oldest_sample() -> None:
    ring = Ring(100.0, 2, seconds=0.25)
    ring.append(block(0, 20))
    ring.append(block(20, 20))
    assert ring.oldest_index == 15
    np.testing.assert_array_equal(ring.since(0), ramp(15, 25))


def test_what_has_not_come_yet_is_an_empty_stretch() -> None:
    ring = Ring(100.0, 2)
    ring.append(block(0, 20))
    assert len(ring.since(20)) == 0
    assert len(ring.since(1000)) == 0


@pytest.mark.parametrize("gap", [1, 10, 24, 25, 26, 1000])
def test_a_gap_is_marked_and_moves_no_index(gap: int) -> None:
    ring = Ring(100.0, 2, seconds=0.25)
    ring.append(block(0, 5))
    assert ring.append(block(5 + gap, 5)) == gap
    stretch = ring.since(5)
    np.testing.assert_array_equal(stretch[-5:], ramp(5 + gap, 5))
    assert len(stretch) == min(gap + 5, 25)
    assert np.isnan(stretch[:-5]).all()


def test_a_stretch_is_a_look_and_cannot_be_written_to() -> None:
    ring = Ring(100.0, 2)
    ring.append(block(0, 20))
    stretch = ring.since(10)
    assert not stretch.flags.owndata
    with pytest.raises(ValueError, match="read-only"):
        stretch[0] = 0


def test_every_sample_has_its_time() -> None:
    ring = Ring(100.0, 2)
    ring.append(EmgBlock(0, 5.0, ramp(0, 20)))
    assert ring.newest == pytest.approx(5.19)
    assert ring.time_of(0) == pytest.approx(5.0)
    assert ring.time_of(7) == pytest.approx(5.07)


def test_a_block_that_goes_back_is_refused() -> None:
    ring = Ring(100.0, 2)
    ring.append(block(0, 20))
    with pytest.raises(ValueError, match="sample 19 came after sample 19"):
        ring.append(block(19, 2))


def test_a_block_of_another_width_is_refused() -> None:
    ring = Ring(100.0, 2)
    with pytest.raises(ValueError, match="3 channels came from 2"):
        ring.append(EmgBlock(0, 0.0, ramp(0, 4, channels=3)))
