"""A signal that no muscle makes asks for nothing."""

import numpy as np
import pytest

from bentod.emg.signs import FEWEST, lifeless, stretch
from bentod.frames import Samples
from sim.emg_wearer import CIRCUIT, Options, Wearer

LEAST = 10e-6


def signal(*volts: float) -> Samples:
    return np.array(volts, np.float32)[:, np.newaxis]


def test_a_stretch_is_50_ms_and_at_least_ten_samples() -> None:
    assert (stretch(2000.0), stretch(200.0), stretch(50.0)) == (100, 10, FEWEST)


def test_a_value_that_does_not_change_is_no_muscle() -> None:
    assert lifeless(signal(*[5e-5] * 10), 0, LEAST) == (
        "EMG channel 0 is stuck: of its newest 10 samples most are 5e-05 V."
    )


def test_the_least_bit_of_a_converter_is_no_life() -> None:
    assert "stuck" in lifeless(signal(*[5e-5, 5.004e-5] * 5), 0, LEAST)


def test_an_amplifier_between_its_rails_is_no_muscle() -> None:
    both = [1e-3, 1e-3, -1e-3, -1e-3, 2e-4, 1e-3, -1e-3, -1e-3, 1e-3, 0.0]
    assert lifeless(signal(*both), 0, LEAST) == (
        "EMG channel 0 is saturated: of its newest 10 samples most are -0.001 V or 0.001 V."
    )


def test_a_still_signal_that_asks_for_nothing_is_left_alone() -> None:
    assert lifeless(signal(*[5e-6] * 10), 0, LEAST) == ""
    assert lifeless(signal(*[0.0] * 10), 0, 0.0) == ""


def test_too_few_samples_tell_nothing() -> None:
    assert lifeless(signal(*[5e-5] * 9), 0, LEAST) == ""


@pytest.mark.parametrize("rate_hz", [200.0, 1000.0])
@pytest.mark.parametrize("clipped_v", [1.0, 150e-6])
def test_a_living_contraction_is_never_taken_for_dead(rate_hz: float, clipped_v: float) -> None:
    """Clipped at twice its standard deviation, too."""
    wearer = Wearer(Options(program=(CIRCUIT[1],), lag_s=0.0), rate_hz, 3)
    samples = np.clip(wearer.read(0, int(30 * rate_hz)), -clipped_v, clipped_v)
    size = stretch(rate_hz)
    for start in range(0, len(samples) - size, 7):
        assert lifeless(samples[start : start + size], 0, LEAST) == ""


def test_an_offset_that_is_filtered_out_is_no_sign_and_hides_none() -> None:
    wearer = Wearer(Options(program=(CIRCUIT[1],), lag_s=0.0), 200.0, 3)
    offset = wearer.read(0, 10) + np.float32(0.3)
    assert "stuck" in lifeless(offset, 0, LEAST)
    assert lifeless(offset, 0, LEAST, mean_free=True) == ""
    assert lifeless(signal(*[0.3] * 10), 0, LEAST, mean_free=True) == ""
    assert "stuck" in lifeless(signal(*[0.3] * 7, 0.4, 0.4, 0.4), 0, LEAST, mean_free=True)
