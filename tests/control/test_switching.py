from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bentod.control.switching import ToggleSite, Toggling
from bentod.errors import ConfigError
from bentod.frames import Samples

FLEXOR = ToggleSite("flexor", 0, 1.0, 20e-6)
REST = (2.5e-6, 100)
PULSE = (55e-6, 40)  # 0.2 s at 200 Hz


def muscle(*stretches: tuple[float, int], seed: int = 1) -> Samples:
    """Noise of one channel: (mean absolute value in V, samples) after one another."""
    volts = np.repeat([level for level, _ in stretches], [count for _, count in stretches])
    random = np.random.default_rng(seed)
    return (volts * random.normal(0, np.sqrt(np.pi / 2), len(volts))).astype(np.float32)[:, np.newaxis]


def toggles(samples: Samples, size: int = 7, site: ToggleSite = FLEXOR) -> int:
    toggling = Toggling([site])
    pieces = [samples[start : start + size] for start in range(0, len(samples), size)]
    return sum(toggling.step(piece)[site.name] for piece in pieces)


def test_a_short_contraction_toggles_once() -> None:
    assert toggles(muscle(REST, PULSE, REST)) == 1


def test_a_contraction_that_is_over_between_two_ticks_is_not_missed() -> None:
    assert toggles(muscle(REST, PULSE, REST), size=1000) == 1


def test_every_contraction_counts() -> None:
    assert toggles(muscle(*[REST, PULSE] * 9, REST)) == 9


@pytest.mark.parametrize("seed", range(20))
def test_a_contraction_that_is_held_for_a_minute_toggles_once(seed: int) -> None:
    assert toggles(muscle(REST, (55e-6, 12_000), REST, seed=seed)) == 1


def test_ten_minutes_of_noise_below_the_threshold_toggle_nothing() -> None:
    assert toggles(muscle((8e-6, 120_000))) == 0


@given(cuts=st.lists(st.integers(0, 10_000), max_size=60), seed=st.integers(0, 100))
def test_toggles_are_the_same_at_any_tick_rate(cuts: list[int], seed: int) -> None:
    samples = muscle(*[REST, PULSE] * 3, (20e-6, 200), REST, seed=seed)
    toggling = Toggling([FLEXOR])
    pieces = np.split(samples, sorted(place % len(samples) for place in cuts))
    assert sum(toggling.step(piece)["flexor"] for piece in pieces) == toggles(samples, size=len(samples))


def test_a_second_rise_belongs_to_the_same_contraction_until_the_muscle_was_quiet() -> None:
    bounce = (2.5e-6, 40)
    assert toggles(muscle(REST, PULSE, bounce, PULSE, REST)) == 1
    assert (
        toggles(muscle(REST, PULSE, bounce, PULSE, REST), site=ToggleSite("f", 0, 1.0, 20e-6, quiet=10)) == 2
    )


def test_a_muscle_that_was_tense_from_the_start_must_rest_first() -> None:
    assert toggles(muscle((55e-6, 200), REST)) == 0
    assert toggles(muscle((55e-6, 200), REST, PULSE)) == 1


def test_after_a_reset_a_muscle_must_rest_first() -> None:
    toggling = Toggling([FLEXOR])
    assert toggling.step(muscle(REST, PULSE)) == {"flexor": 1}
    toggling.reset()
    assert toggling.step(muscle((55e-6, 200))) == {"flexor": 0}
    assert toggling.step(muscle(REST, PULSE)) == {"flexor": 1}


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_lost_samples_neither_toggle_nor_end_a_contraction(bad: float) -> None:
    lost = np.full((100, 1), bad, np.float32)
    samples = np.concatenate([muscle(REST, PULSE), lost, muscle(PULSE, REST), lost, muscle(REST)])
    assert toggles(samples) == 1


def test_the_threshold_changes_between_two_ticks() -> None:
    toggling = Toggling([FLEXOR])
    assert toggling.step(muscle(REST, (14e-6, 20))) == {"flexor": 0}
    toggling.sites = (ToggleSite("flexor", 0, 1.0, 5e-6),)
    assert toggling.step(muscle((14e-6, 20))) == {"flexor": 1}


def test_gain_amplifies_the_site() -> None:
    assert toggles(muscle(REST, (14e-6, 40), REST), site=ToggleSite("flexor", 0, 3.0, 20e-6)) == 1


def test_sites_toggle_for_themselves() -> None:
    other = ToggleSite("extensor", 1, 1.0, 20e-6)
    samples = np.hstack([muscle(REST, PULSE, REST), muscle(REST, REST, PULSE)])
    toggling = Toggling([FLEXOR, other])
    assert toggling.step(samples[:150]) == {"flexor": 1, "extensor": 0}
    assert toggling.step(samples[150:]) == {"flexor": 0, "extensor": 1}


@pytest.mark.parametrize(
    ("threshold", "release", "quiet", "word"),
    [(-1e-6, 0.7, 60, "threshold"), (20e-6, 1.1, 60, "release"), (20e-6, 0.7, 0, "quiet")],
)
def test_settings_out_of_bounds_are_refused_by_name(
    threshold: float, release: float, quiet: int, word: str
) -> None:
    with pytest.raises(ConfigError, match=f"'flexor': {word} is"):
        ToggleSite("flexor", 0, 1.0, threshold, release, quiet)


def test_a_real_recording_toggles_once_for_each_contraction_under_that_electrode() -> None:
    path = Path(__file__).parents[3] / "shared" / "data" / "libemg_myo_200hz.npz"
    if not path.exists():
        pytest.skip("the recording is not here")
    with np.load(path, allow_pickle=False) as file:
        samples = (file["emg"] * 1e-6).astype(np.float32)
    assert toggles(samples, site=ToggleSite("toggle", 7, 1.0, 12e-6)) == 6
