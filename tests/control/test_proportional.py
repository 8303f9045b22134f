from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bentod.control.proportional import Envelope, Proportional, Site, difference
from bentod.errors import ConfigError
from bentod.frames import Samples

BICEPS = Site("biceps", 0, 1.0, 10e-6, 50e-6)
TRICEPS = Site("triceps", 1, 1.0, 10e-6, 50e-6)


class Efforts:
    """Samples in, the newest efforts out."""

    def __init__(self, *sites: Site) -> None:
        self.proportional = Proportional(sites)
        self._envelope = Envelope()

    def step(self, samples: Samples) -> dict[str, float]:
        self.proportional.step(self._envelope.step(samples))
        return self.proportional.newest()

    def reset(self) -> None:
        self.proportional.reset()
        self._envelope.reset()


def steady(*volts: float, count: int = 10) -> Samples:
    """Samples of alternating sign whose mean absolute value is `volts`, a channel each."""
    signs = np.where(np.arange(count) % 2, 1.0, -1.0)[:, np.newaxis]
    return np.asarray(signs * np.array(volts), np.float32)


def noise(count: int, channels: int = 2, seed: int = 1) -> Samples:
    return np.random.default_rng(seed).normal(0, 4e-5, (count, channels)).astype(np.float32)


def cut(samples: Samples, cuts: list[int]) -> list[Samples]:
    return np.split(samples, sorted(place % len(samples) for place in cuts))


@pytest.mark.parametrize(
    ("volts", "effort"), [(0.0, 0.0), (10e-6, 0.0), (20e-6, 0.25), (30e-6, 0.5), (50e-6, 1.0), (1.0, 1.0)]
)
def test_effort_rises_from_the_threshold_to_the_maximum(volts: float, effort: float) -> None:
    efforts = Efforts(BICEPS).step(steady(volts))
    assert efforts["biceps"] == pytest.approx(effort, abs=1e-6)


def test_gain_amplifies_one_site() -> None:
    louder = Site("triceps", 1, 3.0, 10e-6, 50e-6)
    efforts = Efforts(BICEPS, louder).step(steady(10e-6, 10e-6))
    assert efforts == {"biceps": pytest.approx(0.0, abs=1e-6), "triceps": pytest.approx(0.5)}


@pytest.mark.parametrize(("efforts", "wish"), [((1, 0), 1), ((0, 1), -1), ((0.7, 0.7), 0), ((0, 0), 0)])
def test_a_pair_of_sites_spans_both_directions(efforts: tuple[float, float], wish: float) -> None:
    assert difference(*efforts) == wish


def test_a_window_counts_ten_samples_and_no_more() -> None:
    efforts = Efforts(BICEPS)
    efforts.step(steady(1.0, count=100))
    assert efforts.step(steady(0.0, count=9))["biceps"] == 1.0
    assert efforts.step(steady(0.0, count=1))["biceps"] == 0.0


@given(
    cuts=st.lists(st.integers(0, 10_000), max_size=80), seed=st.integers(0, 100), window=st.integers(1, 40)
)
def test_the_envelope_is_the_same_to_the_last_bit_however_samples_are_cut(
    cuts: list[int], seed: int, window: int
) -> None:
    samples = noise(300, seed=seed)
    samples[100:120] = np.nan
    envelope = Envelope(window)
    pieces = [envelope.step(piece) for piece in cut(samples, cuts)]
    assert np.concatenate(pieces).tobytes() == Envelope(window).step(samples).tobytes()


@given(cuts=st.lists(st.integers(0, 10_000), max_size=80))
def test_efforts_are_the_same_at_any_tick_rate(cuts: list[int]) -> None:
    samples = noise(300)
    slow, fast = Efforts(BICEPS, TRICEPS), Efforts(BICEPS, TRICEPS)
    for piece in cut(samples, cuts):
        efforts = fast.step(piece)
    assert efforts == slow.step(samples)


def test_the_envelope_is_the_mean_of_the_rectified_window() -> None:
    samples = noise(200)
    envelope = Envelope(10).step(samples)
    for end in range(10, 200):
        np.testing.assert_allclose(envelope[end - 1], np.abs(samples[end - 10 : end]).mean(0), rtol=1e-5)


def test_a_tick_without_new_samples_keeps_the_effort() -> None:
    efforts = Efforts(BICEPS)
    before = efforts.step(steady(30e-6))
    assert efforts.step(steady(30e-6, count=0)) == before


def test_settings_change_between_two_ticks_without_new_samples() -> None:
    efforts = Efforts(BICEPS)
    efforts.step(steady(30e-6))
    efforts.proportional.sites = (Site("biceps", 0, 1.0, 10e-6, 30e-6),)
    assert efforts.step(steady(0.0, count=0))["biceps"] == pytest.approx(1.0)


def test_without_samples_there_is_no_effort() -> None:
    efforts = Efforts(BICEPS)
    assert efforts.step(steady(0.0, count=0)) == {"biceps": 0.0}
    efforts.step(steady(1.0))
    efforts.reset()
    assert efforts.step(steady(0.0, count=0)) == {"biceps": 0.0}


def test_a_few_lost_samples_do_not_jerk_the_arm() -> None:
    samples = steady(30e-6, count=30)
    samples[21:25] = np.nan
    assert Efforts(BICEPS).step(samples)["biceps"] == pytest.approx(0.5, abs=1e-3)


def test_a_window_that_is_mostly_lost_asks_for_nothing() -> None:
    samples = steady(30e-6, count=30)
    samples[-6:] = np.nan
    assert Efforts(BICEPS).step(samples)["biceps"] == 0.0


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_what_is_not_finite_never_becomes_effort(bad: float) -> None:
    efforts = Efforts(BICEPS)
    efforts.step(steady(1.0))
    assert efforts.step(np.full((20, 1), bad, np.float32)) == {"biceps": 0.0}


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"channel": -1}, "channel"),
        ({"gain": 0.0}, "gain"),
        ({"gain": float("nan")}, "gain"),
        ({"threshold": 50e-6}, "maximum"),
        ({"threshold": -1e-6}, "threshold"),
        ({"maximum": float("inf")}, "maximum"),
        ({"release": 0.0}, "release"),
        ({"release": 1.1}, "release"),
    ],
)
def test_settings_that_make_no_sense_are_refused_by_name(change: dict[str, float], word: str) -> None:
    channel, others = int(change.get("channel", 0)), {k: v for k, v in change.items() if k != "channel"}
    with pytest.raises(ConfigError, match=f"'biceps'.*{word}"):
        Site("biceps", channel, **({"gain": 1.0, "threshold": 10e-6, "maximum": 50e-6} | others))


def test_an_effort_that_has_begun_goes_on_down_to_the_release() -> None:
    efforts = Efforts(Site("biceps", 0, 1.0, 10e-6, 50e-6, release=0.5))
    assert efforts.step(steady(9e-6))["biceps"] == 0.0
    assert efforts.step(steady(30e-6))["biceps"] == pytest.approx(25 / 45, abs=1e-3)
    assert efforts.step(steady(9e-6))["biceps"] == pytest.approx(4 / 45, abs=1e-3)
    assert efforts.step(steady(4e-6))["biceps"] == 0.0
    assert efforts.step(steady(9e-6))["biceps"] == 0.0


def test_lost_samples_end_an_effort_that_was_going_on_below_the_threshold() -> None:
    efforts = Efforts(Site("biceps", 0, 1.0, 10e-6, 50e-6, release=0.5))
    efforts.step(steady(30e-6))
    assert efforts.step(np.full((10, 1), np.nan, np.float32))["biceps"] == 0.0
    assert efforts.step(steady(9e-6))["biceps"] == 0.0


@given(cuts=st.lists(st.integers(0, 10_000), max_size=80), release=st.floats(0.1, 1.0))
def test_efforts_with_a_release_are_the_same_at_every_sample_however_samples_are_cut(
    cuts: list[int], release: float
) -> None:
    levels = Envelope().step(noise(300))
    levels[100:110] = np.nan
    site = Site("biceps", 0, 1.0, 30e-6, 50e-6, release)
    cutting = Proportional([site])
    pieces = [cutting.step(piece)["biceps"] for piece in np.split(levels, sorted(c % 300 for c in cuts))]
    assert np.concatenate(pieces).tobytes() == Proportional([site]).step(levels)["biceps"].tobytes()


def test_a_real_recording_moves_both_ways() -> None:
    path = Path(__file__).parents[3] / "shared" / "data" / "libemg_myo_200hz.npz"
    if not path.exists():
        pytest.skip("the recording is not here")
    with np.load(path, allow_pickle=False) as file:
        samples = (file["emg"] * 1e-6).astype(np.float32)
    pair = Efforts(Site("positive", 0, 1.0, 10e-6, 30e-6), Site("negative", 2, 1.0, 10e-6, 30e-6))
    efforts = [pair.step(samples[start : start + 7]) for start in range(0, 9000, 7)]
    wishes = np.array([difference(effort["positive"], effort["negative"]) for effort in efforts])
    assert 0.1 < np.mean(wishes > 0) < 0.4
    assert 0.1 < np.mean(wishes < 0) < 0.4
    assert wishes.max() == 1.0
    assert wishes.min() == -1.0
