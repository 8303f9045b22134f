"""A lead that is off asks for nothing; a living muscle is never taken for one."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bentod.config_conditioning import Filter, Leads
from bentod.emg.conditioning import Conditioning, Volts
from bentod.emg.contact import Contact, Wired
from sim.emg_wearer import Options, Wearer

MYO = Path(__file__).parents[3] / "shared" / "data" / "libemg_myo_200hz.npz"
RATE_HZ = 1000.0
THRESHOLD, MAXIMUM = 10e-6, 30e-6


def contact(rate_hz: float = RATE_HZ, channels: int = 1, **leads: float) -> Contact:
    judge = Contact(Leads.model_validate(leads), rate_hz)
    judge.sites = [Wired(f"site{i}", i, THRESHOLD, MAXIMUM) for i in range(channels)]
    return judge


def hum(seconds: float, volts: float, hz: float = 50.0, rate_hz: float = RATE_HZ, channels: int = 1) -> Volts:
    times = np.arange(round(seconds * rate_hz)) / rate_hz
    return np.tile(volts * np.sin(2 * np.pi * hz * times)[:, np.newaxis], channels)


def rest(seconds: float, seed: int = 1, channels: int = 1) -> Volts:
    return np.random.default_rng(seed).normal(0, 3e-6, (round(seconds * RATE_HZ), channels))


def contraction(seconds: float, rate_hz: float = RATE_HZ, volts: float = 60e-6) -> Volts:
    options = Options(program=((0, 1.0, seconds),), lag_s=0.0, full_v=volts)
    return Wearer(options, rate_hz, 3).read(0, round(seconds * rate_hz))[:, :1].astype(np.float64)


def first_silence(out: Volts) -> float:
    """When (s) the first sample is withheld; infinite if none is."""
    silent = np.flatnonzero(np.isnan(out[:, 0]))
    return silent[0] / RATE_HZ if len(silent) else np.inf


@pytest.mark.parametrize("hz", [50.0, 60.0, 49.8])
def test_hum_that_would_move_the_arm_is_a_lead_that_is_off(hz: float) -> None:
    judge = contact()
    signal = np.concatenate((rest(2.0), rest(2.0) + hum(2.0, 300e-6, hz)))
    out = judge.step(signal, signal)
    assert 2.0 < first_silence(out) <= 2.25
    assert np.isnan(out[2300:]).all()
    (turn,) = judge.take_turns()
    assert turn.text.startswith("EMG site site0 (channel 0): ")
    assert f"hum of {round(hz, -1):g} Hz" in turn.text
    assert judge.take_turns() == []


def test_hum_that_asks_for_nothing_is_left_alone() -> None:
    judge = contact()
    signal = rest(5.0) + hum(5.0, 10e-6)
    np.testing.assert_array_equal(judge.step(signal, signal), signal)
    assert judge.take_turns() == []


def test_hum_that_a_filter_takes_out_is_left_alone_unless_no_good_contact_has_as_much() -> None:
    notch = (Filter(kind="high_pass", hz=20), Filter(kind="notch", hz=50))
    for volts, off in ((100e-6, False), (1e-3, True)):
        judge = contact()
        signal = np.concatenate((rest(3.0), contraction(3.0))) + hum(6.0, volts)
        judge.step(signal, Conditioning(notch, RATE_HZ, 1).step(signal))
        assert bool(judge.off) is off


def test_an_offset_and_a_slow_swing_are_no_muscle() -> None:
    for slow in (np.full((2000, 1), 2e-4), hum(2.0, 2e-4, 1.0)):
        judge = contact()
        signal = np.concatenate((rest(2.0), rest(2.0) + slow))
        out = judge.step(signal, signal)
        assert 2.0 < first_silence(out) <= 2.35
        assert "slower than 10 Hz" in judge.off["site0"]


def test_an_offset_that_a_filter_takes_away_is_left_alone() -> None:
    judge = contact()
    signal = rest(4.0) + 0.3
    judge.step(signal, Conditioning((Filter(kind="high_pass", hz=20),), RATE_HZ, 1).step(signal))
    assert judge.off == {}


def test_one_lead_does_not_silence_another() -> None:
    judge = contact(channels=3)
    signal = rest(3.0, channels=3)
    signal[:, 1:2] += hum(3.0, 300e-6)
    out = judge.step(signal, signal)
    assert list(judge.off) == ["site1"]
    np.testing.assert_array_equal(out[:, [0, 2]], signal[:, [0, 2]])


def test_a_lead_is_back_after_half_a_second_at_rest_and_both_turns_are_told_once() -> None:
    judge = contact()
    loose = rest(1.0) + hum(1.0, 300e-6)
    judge.step(loose, loose)
    held = contraction(2.0)
    assert np.isnan(judge.step(held, held)).all()  # it is on again, but who knows since when it asks
    out = judge.step(rest(2.0), rest(2.0))
    assert 0.5 <= np.isnan(out).sum() / RATE_HZ <= 0.8
    assert [turn.reason == "" for turn in judge.take_turns()] == [False, True]
    assert np.isfinite(judge.step(held, held)).all()


def test_a_flat_line_is_told_once_and_life_again() -> None:
    judge = contact()
    flat = np.full((3000, 1), 1e-7)
    np.testing.assert_array_equal(judge.step(flat, flat), flat)  # it asks for nothing by itself
    assert "no change for 2 s" in judge.flat["site0"]
    judge.step(rest(1.0), rest(1.0))
    assert judge.flat == {}
    assert [bool(turn.reason) for turn in judge.take_turns()] == [True, False]


def test_an_amplifier_that_only_makes_its_own_noise_is_flat_where_the_config_knows_that() -> None:
    judge = contact(flat_v=2e-6)
    noise = np.random.default_rng(1).uniform(-1e-6, 1e-6, (4000, 1))
    judge.step(noise, noise)
    assert "site0" in judge.flat


def test_missing_samples_neither_take_a_lead_off_nor_bring_it_back() -> None:
    judge = contact()
    missing = np.full((3000, 1), np.nan)
    judge.step(missing, missing)
    assert (judge.off, judge.flat) == ({}, {})
    loose = rest(1.0) + hum(1.0, 300e-6)
    judge.step(loose, loose)
    judge.step(missing, missing)
    assert list(judge.off) == ["site0"]


def test_whoever_does_not_want_it_switches_it_off() -> None:
    judge = Contact(Leads(enabled=False), RATE_HZ)
    judge.sites = contact().sites
    signal = hum(3.0, 1e-3)
    assert np.isfinite(judge.step(signal, signal)).all()
    assert judge.off == {}


@settings(max_examples=10, deadline=None)
@given(cuts=st.lists(st.integers(0, 5000), max_size=40), seed=st.integers(0, 50))
def test_it_is_judged_by_the_index_whatever_the_blocks(cuts: list[int], seed: int) -> None:
    parts = (rest(1.0), rest(1.0) + hum(1.0, 3e-4), contraction(1.0), rest(2.0, seed))
    signal = np.concatenate(parts)
    signal[700:720] = np.nan
    at_once, in_blocks = contact(), contact()
    edges = [0, *sorted(cuts), len(signal)]
    pieces = [in_blocks.step(signal[a:b], signal[a:b]) for a, b in pairwise(edges)]
    np.testing.assert_array_equal(np.concatenate(pieces), at_once.step(signal, signal))
    assert in_blocks.take_turns() == at_once.take_turns()


@pytest.mark.parametrize("rate_hz", [200.0, 1000.0, 2000.0])
@pytest.mark.parametrize("threshold", [0.0, 10e-6])
def test_a_living_contraction_is_never_taken_for_a_lead_that_is_off(rate_hz: float, threshold: float) -> None:
    judge = Contact(Leads(), rate_hz)
    judge.sites = [Wired("up", 0, threshold, MAXIMUM)]
    signal = contraction(20.0, rate_hz)
    judge.step(signal, signal)
    assert judge.take_turns() == []


@pytest.mark.parametrize("array", ["emg", "stream"])
@pytest.mark.parametrize("threshold", [0.0, 3e-6, 10e-6])
def test_no_alarm_on_an_armband_that_is_worn(array: str, threshold: float) -> None:
    """200 Hz, 8 bits, many exact zeros; one count stands for a microvolt. Every channel, at rest and not."""
    if not MYO.exists():
        pytest.skip("the recording is not there")
    with np.load(MYO, allow_pickle=False) as file:
        signal = file[array].astype(np.float64) * 1e-6
    judge = Contact(Leads(), 200.0)
    judge.sites = [Wired(f"c{i}", i, threshold, MAXIMUM) for i in range(8)]
    np.testing.assert_array_equal(judge.step(signal, signal), signal)
    assert judge.take_turns() == []
