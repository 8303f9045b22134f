import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bentod.emg.recognition import Segmenting
from bentod.emg.segmenting import Segmenter, complete, cut, segmenting
from bentod.errors import ConfigError

CHANNELS = 2
Found = dict[int, np.ndarray[tuple[int, ...], np.dtype[np.float64]] | None]


def signal(count: int) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """Samples whose value is their index, and as much below 0."""
    index = np.arange(float(count))
    return np.stack([index, -index], axis=1)


def off_line(samples: np.ndarray[tuple[int, ...], np.dtype[np.float64]], asked: Segmenting) -> Found:
    """Windows by number, one by one; None: not complete."""
    found: Found = {}
    for number in range(len(samples)):
        part = samples[number * asked.step : number * asked.step + asked.length]
        if len(part) == asked.length:
            found[number] = part.T.copy() if np.isfinite(part).all() else None
    return found


def on_line(
    segmenter: Segmenter, first: int, samples: np.ndarray[tuple[int, ...], np.dtype[np.float64]]
) -> Found:
    cuts = segmenter.feed(first, samples)
    found: Found = dict.fromkeys(range(cuts.first - cuts.lost, cuts.first))
    for place, whole in enumerate(cuts.complete.tolist()):
        found[cuts.first + place] = cuts.windows[place].copy() if whole else None
    return found


def assert_same(found: Found, wanted: Found) -> None:
    assert list(found) == list(wanted)
    for number, window in wanted.items():
        np.testing.assert_array_equal(found[number], window)


segmentings = st.builds(Segmenting, st.integers(2, 12), st.integers(1, 20))


def test_a_window_has_the_samples_of_its_number() -> None:
    windows = cut(signal(20), Segmenting(6, 4))
    assert windows.shape == (4, CHANNELS, 6)
    np.testing.assert_array_equal(windows[2, 0], [8, 9, 10, 11, 12, 13])
    np.testing.assert_array_equal(windows[2, 1], [-8, -9, -10, -11, -12, -13])


def test_windows_are_no_copies() -> None:
    samples = signal(100)
    assert np.shares_memory(cut(samples, Segmenting(30, 10)), samples)
    segmenter = Segmenter(Segmenting(30, 10), CHANNELS)
    windows = segmenter.feed(0, samples).windows
    assert windows.base is not None
    assert np.shares_memory(windows[0], windows[1])


def test_nobody_writes_into_windows() -> None:
    with pytest.raises(ValueError, match="read-only"):
        cut(signal(100), Segmenting(30, 10))[0, 0, 0] = 1
    with pytest.raises(ValueError, match="read-only"):
        Segmenter(Segmenting(30, 10), CHANNELS).feed(0, signal(100)).windows[0, 0, 0] = 1


def test_too_few_samples_are_no_window() -> None:
    assert cut(signal(29), Segmenting(30, 10)).shape == (0, CHANNELS, 30)
    assert complete(signal(29), Segmenting(30, 10)).shape == (0,)


@given(
    asked=segmentings,
    sizes=st.lists(st.integers(0, 40), max_size=40),
    bad=st.lists(st.tuples(st.integers(0, 300), st.sampled_from([np.nan, np.inf, -np.inf])), max_size=4),
)
def test_blocks_of_any_size_give_the_windows_of_the_whole(
    asked: Segmenting, sizes: list[int], bad: list[tuple[int, float]]
) -> None:
    samples = signal(sum(sizes))
    for index, value in bad:
        samples[index : index + 1, index % CHANNELS] = value
    segmenter, first = Segmenter(asked, CHANNELS), 0
    found: Found = {}
    for size in sizes:
        found |= on_line(segmenter, first, samples[first : first + size])
        first += size
    assert_same(found, off_line(samples, asked))


@given(
    asked=segmentings,
    blocks=st.lists(st.tuples(st.integers(0, 200), st.integers(1, 40)), min_size=1, max_size=15),
)
def test_what_is_missing_makes_windows_incomplete_and_moves_none(
    asked: Segmenting, blocks: list[tuple[int, int]]
) -> None:
    samples = np.full((sum(gap + size for gap, size in blocks), CHANNELS), np.nan)
    whole = signal(len(samples))
    segmenter, first, begun = Segmenter(asked, CHANNELS), 0, blocks[0][0]
    found: Found = {}
    for gap, size in blocks:
        first += gap
        samples[first : first + size] = whole[first : first + size]
        found |= on_line(segmenter, first, whole[first : first + size])
        first += size
    wanted = off_line(samples, asked)
    assert_same(found, {number: w for number, w in wanted.items() if number * asked.step >= begun})


def test_a_gap_of_hours_takes_no_memory() -> None:
    segmenter = Segmenter(Segmenting(150, 50), CHANNELS)
    segmenter.feed(0, signal(200))
    cuts = segmenter.feed(50_000_000, signal(200))
    assert cuts.first - cuts.lost == 2
    assert cuts.first + cuts.complete.tolist().index(True) == 1_000_000


def test_a_signal_that_began_before_is_cut_at_the_same_samples() -> None:
    cuts = Segmenter(Segmenting(6, 4), CHANNELS).feed(101, signal(200)[101:])
    assert cuts.first == 26
    assert cuts.lost == 0
    assert cuts.windows[0, 0, 0] == 104


def test_a_block_from_the_past_is_refused() -> None:
    segmenter = Segmenter(Segmenting(6, 4), CHANNELS)
    segmenter.feed(0, signal(10))
    with pytest.raises(ValueError, match="sample 9 came after sample 9"):
        segmenter.feed(9, signal(10))


def test_a_block_of_other_channels_is_refused() -> None:
    with pytest.raises(ValueError, match="2 channels"):
        Segmenter(Segmenting(6, 4), CHANNELS).feed(0, np.zeros((10, 3)))


def test_windows_are_cut_in_whole_samples() -> None:
    assert segmenting(0.15, 0.05, 1000.0) == Segmenting(150, 50)
    assert segmenting(0.15, 0.05, 200.0) == Segmenting(30, 10)


@pytest.mark.parametrize(("window", "step", "told"), [(0.004, 0.05, "too short"), (0.15, 0.001, "too close")])
def test_windows_without_samples_are_refused(window: float, step: float, told: str) -> None:
    with pytest.raises(ConfigError, match=told):
        segmenting(window, step, 200.0)
