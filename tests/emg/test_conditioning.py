"""Filters that are causal, begin without a step, forget gaps, and give the same bits at any block size."""

import sys
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bentod import registry
from bentod.config_conditioning import Filter
from bentod.config_file import parse
from bentod.emg.conditioning import Conditioning, Volts
from bentod.errors import ConfigError
from bentod.frames import Samples
from bentod.record.provenance import as_toml
from sim.emg_wearer import Options, Wearer
from tests.rig import sim_config

RATE_HZ = 1000.0
HIGH_PASS = Filter(kind="high_pass", hz=20)
LOW_PASS = Filter(kind="low_pass", hz=400, order=4)
BAND_PASS = Filter(kind="band_pass", low_hz=20, high_hz=450)
NOTCH = Filter(kind="notch", hz=50, q=20, harmonics=3)
CHAINS = [(HIGH_PASS,), (LOW_PASS,), (BAND_PASS,), (NOTCH,), (HIGH_PASS, NOTCH, LOW_PASS)]
chains = pytest.mark.parametrize("chain", CHAINS, ids=lambda chain: "+".join(one.kind for one in chain))


def noise(count: int, channels: int = 3, seed: int = 1) -> Samples:
    return np.random.default_rng(seed).normal(0, 50e-6, (count, channels)).astype(np.float32)


def tone(hz: float, seconds: float, rate_hz: float = RATE_HZ, volts: float = 1e-3) -> Samples:
    times = np.arange(round(seconds * rate_hz)) / rate_hz
    return (volts * np.sin(2 * np.pi * hz * times))[:, np.newaxis].astype(np.float32)


def whole(chain: Sequence[Filter], samples: Samples, rate_hz: float = RATE_HZ) -> Volts:
    return Conditioning(chain, rate_hz, samples.shape[1]).step(samples)


def in_blocks(chain: Sequence[Filter], samples: Samples, cuts: Sequence[int]) -> Volts:
    conditioning = Conditioning(chain, RATE_HZ, samples.shape[1])
    edges = [0, *sorted(cut % (len(samples) + 1) for cut in cuts), len(samples)]
    return np.concatenate([conditioning.step(samples[a:b]) for a, b in pairwise(edges)])


def gain(chain: Sequence[Filter], hz: float) -> float:
    """How much of a tone is left once everything has settled."""
    out = whole(chain, tone(hz, 3.0))[-500:]
    return float(np.sqrt(2 * np.mean(out**2)) / 1e-3)


@settings(max_examples=40, deadline=None)
@given(
    chain=st.sampled_from(CHAINS),
    cuts=st.lists(st.integers(0, 10_000), max_size=30),
    gaps=st.lists(st.tuples(st.integers(0, 599), st.integers(1, 300), st.integers(0, 3)), max_size=6),
    seed=st.integers(0, 100),
)
def test_the_bits_are_the_same_in_blocks_of_any_size_with_and_without_gaps(
    chain: tuple[Filter, ...], cuts: list[int], gaps: list[tuple[int, int, int]], seed: int
) -> None:
    samples = noise(600, seed=seed)
    for first, length, channel in gaps:
        samples[first : first + length, channel if channel < 3 else slice(None)] = np.nan
    np.testing.assert_array_equal(in_blocks(chain, samples, cuts), whole(chain, samples))


def test_a_channel_alone_is_what_it_is_among_others() -> None:
    samples = noise(500)
    samples[100:120, 1] = np.nan
    together = whole((HIGH_PASS, NOTCH), samples)
    np.testing.assert_array_equal(whole((HIGH_PASS, NOTCH), samples[:, 2:]), together[:, 2:])


@chains
def test_nothing_is_known_before_it_has_happened(chain: tuple[Filter, ...]) -> None:
    samples, changed = noise(400), noise(400)
    changed[300:] = 1.0
    np.testing.assert_array_equal(whole(chain, samples)[:300], whole(chain, changed)[:300])


def test_without_a_filter_samples_are_what_they_were() -> None:
    samples = noise(50)
    samples[7, 1] = np.inf
    out = whole((), samples)
    assert np.isnan(out[7, 1])
    samples[7, 1] = out[7, 1] = 0
    np.testing.assert_array_equal(out, samples.astype(np.float64))


def test_filters_take_away_what_their_names_say() -> None:
    assert gain((HIGH_PASS,), 20) == pytest.approx(np.sqrt(0.5), rel=0.01)
    assert gain((HIGH_PASS,), 2) < 0.011
    assert gain((HIGH_PASS,), 200) == pytest.approx(1, rel=0.01)
    assert gain((LOW_PASS,), 400) == pytest.approx(np.sqrt(0.5), rel=0.01)
    assert gain((BAND_PASS,), 100) == pytest.approx(1, rel=0.01)
    assert [gain((NOTCH,), hz) < 0.002 for hz in (50, 100, 150, 200)] == [True, True, True, False]
    assert gain((NOTCH,), 80) == pytest.approx(1, rel=0.01)
    assert gain((NOTCH,), 51.25) == pytest.approx(np.sqrt(0.5), rel=0.02)
    assert gain((NOTCH,), 151.25) == pytest.approx(np.sqrt(0.5), rel=0.02)


def test_an_offset_makes_no_step_at_the_start() -> None:
    out = whole((HIGH_PASS,), np.full((500, 1), 0.3, np.float32))
    assert np.nanmax(np.abs(out)) < 1e-12


@chains
def test_after_a_long_gap_nothing_is_told_until_the_filters_have_settled(chain: tuple[Filter, ...]) -> None:
    settling = Conditioning(chain, RATE_HZ, 1).settling
    samples = noise(8000, 1) + np.float32(0.3)
    samples[3000:5000] = np.nan
    samples[5000:] -= 0.2  # the offset of another electrode
    out = whole(chain, samples)[:, 0]
    told = np.flatnonzero(np.isfinite(out))
    assert np.array_equal(told, [*range(settling, 3000), *range(5000 + settling, 8000)])
    undisturbed = np.concatenate((noise(5000, 1, seed=2) + np.float32(0.1), samples[5000:]))
    error = np.abs(out - whole(chain, undisturbed)[:, 0])[5000 + settling :]
    assert np.max(error) <= 0.1 * np.max(np.abs(noise(8000, 1)))  # the past of either may be as wrong


@chains
@pytest.mark.parametrize("length", [1, 5, 10, 60])
def test_a_short_gap_is_forgotten_sooner_and_leaves_as_little_behind(
    chain: tuple[Filter, ...], length: int
) -> None:
    clean = noise(6000, 1)
    broken = clean.copy()
    broken[3000 : 3000 + length] = np.nan
    out = whole(chain, broken)[:, 0]
    silent = np.flatnonzero(np.isnan(out[3000:]))
    assert len(silent) == silent[-1] + 1 <= length + Conditioning(chain, RATE_HZ, 1).settling
    error = np.abs(out - whole(chain, clean)[:, 0])[3000 + len(silent) :]
    assert np.max(error) <= 0.1 * np.max(np.abs(clean))


def test_a_lost_block_does_not_silence_a_notch_for_long() -> None:
    """A block of 10 ms, at 200 Hz: the notch by itself needs half a second to settle."""
    notch = (Filter(kind="notch", hz=50, q=30),)
    hum = tone(50, 10.0, rate_hz=200.0)
    hum[1000:1002] = np.nan
    out = whole(notch, hum, 200.0)[:, 0]
    assert Conditioning(notch, 200.0, 1).settling > 80
    assert np.isnan(out[1000:]).sum() < 30
    assert np.nanmax(np.abs(out[1000:])) < 0.1e-3


def test_a_sample_that_no_converter_gives_is_missing_and_not_remembered() -> None:
    samples = noise(1000, 1)
    samples[500] = 3e38
    out = whole((HIGH_PASS,), samples)[:, 0]
    assert np.isnan(out[500])
    assert np.nanmax(np.abs(out)) < 1e-3
    assert np.isfinite(out[600:]).all()


def test_samples_that_were_skipped_count_as_missing() -> None:
    samples = noise(500)
    conditioning = Conditioning((HIGH_PASS,), RATE_HZ, 3)
    conditioning.step(samples)
    conditioning.skip(10**9)
    np.testing.assert_array_equal(conditioning.step(samples), whole((HIGH_PASS,), samples))


def test_mains_hum_is_taken_out_of_a_contraction_and_the_contraction_stays() -> None:
    program = Options(program=((0, 1.0, 10.0),), lag_s=0.0)
    clean = Wearer(program, RATE_HZ, 3).read(0, 10_000)[:, :1]
    humming = clean + tone(50, 10.0, volts=200e-6)
    mav = np.nanmean(np.abs(whole((HIGH_PASS, NOTCH), humming)))
    assert mav == pytest.approx(np.nanmean(np.abs(whole((HIGH_PASS, NOTCH), clean))), rel=0.01)


def test_a_filter_that_the_source_cannot_carry_is_refused_by_name_and_bound() -> None:
    with pytest.raises(ConfigError, match=r"^emg\.filters\.1\.high_hz = 450: the bound is 196 Hz"):
        Conditioning((HIGH_PASS, BAND_PASS), 400.0, 1)


def test_a_filter_that_never_settles_is_refused() -> None:
    with pytest.raises(ConfigError, match="do not settle within 10 s"):
        Conditioning((Filter(kind="notch", hz=0.5, q=60),), RATE_HZ, 1)


@pytest.mark.parametrize(
    ("table", "said"),
    [
        ({"kind": "high_pass"}, "hz is missing: kind = 'high_pass' needs it"),
        ({"kind": "band_pass", "hz": 20, "low_hz": 20, "high_hz": 90}, "hz does not belong to kind"),
        ({"kind": "high_pass", "hz": 20, "q": 10}, "q does not belong to kind = 'high_pass'"),
        ({"kind": "notch", "hz": 50, "order": 4}, "order does not belong to kind = 'notch'"),
        ({"kind": "band_pass", "low_hz": 90, "high_hz": 20}, "must be at least 4 Hz above low_hz"),
    ],
)
def test_a_filter_has_the_keys_of_its_kind_and_no_others(table: dict[str, object], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        Filter.model_validate(table)


def test_without_scipy_only_filters_are_refused_and_it_is_said_what_brings_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(sys.modules, "scipy", None)
    monkeypatch.delitem(sys.modules, "bentod.emg.filters", raising=False)
    assert len(Conditioning((), RATE_HZ, 1).step(noise(10, 1))) == 10
    with pytest.raises(ConfigError, match=r"filters.* need the package 'scipy'.*'bentod\[emg\]'"):
        Conditioning((HIGH_PASS,), RATE_HZ, 1)


def test_filters_are_told_whole_in_a_recording_and_read_again() -> None:
    filters = "\n".join(
        f"[[emg.filters]]\n{table}"
        for table in (
            'kind = "high_pass"\nhz = 20',
            'kind = "band_pass"\nlow_hz = 20\nhigh_hz = 90\norder = 4',
            'kind = "notch"\nhz = 50\nharmonics = 2',
        )
    )
    config = sim_config(("[emg.source]", f"{filters}\n[emg.source]"))
    told = as_toml(config)
    assert "q = 20.0" in told
    assert parse(told, "recording", registry) == config
