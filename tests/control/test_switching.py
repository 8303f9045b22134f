from collections.abc import Iterable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bentod.control.proportional import Envelope
from bentod.control.switching import BACKWARD, FORWARD, ToggleSite, Toggling
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


class Switches:
    """Samples in, toggles out."""

    def __init__(self, *sites: ToggleSite) -> None:
        self.toggling = Toggling(sites)
        self._envelope = Envelope()

    def step(self, samples: Samples) -> dict[str, list[int]]:
        return self.toggling.step(self._envelope.step(samples))

    def reset(self) -> None:
        self.toggling.reset()
        self._envelope.reset()


def steps(pieces: Iterable[Samples], site: ToggleSite) -> list[int]:
    """Every toggle in order."""
    switches = Switches(site)
    return [step for piece in pieces for step in switches.step(piece)[site.name]]


def toggles(samples: Samples, size: int = 7, site: ToggleSite = FLEXOR) -> int:
    found = steps((samples[start : start + size] for start in range(0, len(samples), size)), site)
    assert set(found) <= {FORWARD}
    return len(found)


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
    pieces = np.split(samples, sorted(place % len(samples) for place in cuts))
    assert len(steps(pieces, FLEXOR)) == toggles(samples, size=len(samples))


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
    switches = Switches(FLEXOR)
    assert switches.step(muscle(REST, PULSE)) == {"flexor": [FORWARD]}
    switches.reset()
    assert switches.step(muscle((55e-6, 200))) == {"flexor": []}
    assert switches.step(muscle(REST, PULSE)) == {"flexor": [FORWARD]}


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_lost_samples_neither_toggle_nor_end_a_contraction(bad: float) -> None:
    lost = np.full((100, 1), bad, np.float32)
    samples = np.concatenate([muscle(REST, PULSE), lost, muscle(PULSE, REST), lost, muscle(REST)])
    assert toggles(samples) == 1


def test_the_threshold_changes_between_two_ticks() -> None:
    switches = Switches(FLEXOR)
    assert switches.step(muscle(REST, (14e-6, 20))) == {"flexor": []}
    switches.toggling.sites = (ToggleSite("flexor", 0, 1.0, 5e-6),)
    assert switches.step(muscle((14e-6, 20))) == {"flexor": [FORWARD]}


def test_gain_amplifies_the_site() -> None:
    assert toggles(muscle(REST, (14e-6, 40), REST), site=ToggleSite("flexor", 0, 3.0, 20e-6)) == 1


def test_sites_toggle_for_themselves() -> None:
    other = ToggleSite("extensor", 1, 1.0, 20e-6)
    samples = np.hstack([muscle(REST, PULSE, REST), muscle(REST, REST, PULSE)])
    switches = Switches(FLEXOR, other)
    assert switches.step(samples[:150]) == {"flexor": [FORWARD], "extensor": []}
    assert switches.step(samples[150:]) == {"flexor": [], "extensor": [FORWARD]}


BOTH_WAYS = ToggleSite("flexor", 0, 1.0, 20e-6, long=120, ended=20)
LONG = (55e-6, 160)


def test_a_short_contraction_goes_on_and_a_long_one_back_if_the_site_does_both() -> None:
    assert steps([muscle(REST, PULSE, REST, LONG, REST, PULSE, REST)], BOTH_WAYS) == [
        FORWARD,
        BACKWARD,
        FORWARD,
    ]


def test_a_long_contraction_toggles_while_it_is_held_and_a_short_one_when_it_is_over() -> None:
    switches = Switches(BOTH_WAYS)
    assert switches.step(muscle(REST, (55e-6, 110))) == {"flexor": []}
    assert switches.toggling.undecided
    assert switches.step(muscle((55e-6, 20))) == {"flexor": [BACKWARD]}
    assert switches.step(muscle((55e-6, 400), REST, PULSE)) == {"flexor": []}
    assert switches.step(muscle(REST)) == {"flexor": [FORWARD]}


@pytest.mark.parametrize("seed", range(10))
def test_a_long_contraction_is_not_short_because_its_signal_scatters(seed: int) -> None:
    assert steps([muscle(REST, (30e-6, 160), REST, seed=seed)], BOTH_WAYS) == [BACKWARD]


def test_a_contraction_of_which_samples_are_lost_is_neither_short_nor_long() -> None:
    lost = np.full((40, 1), np.nan, np.float32)
    samples = [muscle(REST, PULSE), lost, muscle(REST, REST)]
    assert steps(samples, BOTH_WAYS) == []
    assert steps([*samples, muscle(PULSE, REST)], BOTH_WAYS) == [FORWARD]


def test_what_is_undecided_at_a_reset_is_forgotten() -> None:
    switches = Switches(BOTH_WAYS)
    switches.step(muscle(REST, PULSE))
    switches.reset()
    assert switches.step(muscle(REST, REST)) == {"flexor": []}


@given(cuts=st.lists(st.integers(0, 10_000), max_size=60), seed=st.integers(0, 100))
def test_short_and_long_are_the_same_at_any_tick_rate(cuts: list[int], seed: int) -> None:
    samples = muscle(REST, PULSE, REST, LONG, REST, (22e-6, 300), REST, seed=seed)
    pieces = np.split(samples, sorted(place % len(samples) for place in cuts))
    assert steps(pieces, BOTH_WAYS) == steps([samples], BOTH_WAYS)


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
