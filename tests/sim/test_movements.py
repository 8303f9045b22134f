"""Prompted movements: what electrodes see, what is true of each sample, and what can go wrong on the way."""

import numpy as np
import pytest
from numpy.typing import NDArray

from bentod.contracts import EmgConfig
from bentod.errors import ConfigError
from bentod.frames import Value
from sim.clock import VirtualClock
from sim.emg import open_emg
from sim.movement_nuisances import MYO
from sim.movement_signals import Moving
from sim.movements import LOADS, MOVEMENTS, REST, Prompted

RATE = 1000.0
SHORT = {"repetitions": 1, "hold_s": 1.0, "rest_s": 1.0}


def moving(**options: object) -> Moving:
    return Moving(Prompted.model_validate({**SHORT, **options}), RATE)


def labels(made: Moving) -> NDArray[np.str_]:
    return made.labels(np.arange(made.length))


def levels(made: Moving, label: str) -> NDArray[np.float64]:
    """Root mean square of each channel while `label` is true."""
    return np.asarray(np.sqrt(np.mean(made.samples[labels(made) == label].astype(np.float64) ** 2, axis=0)))


def median_hz(volts: NDArray[np.generic]) -> float:
    power = np.abs(np.fft.rfft(volts.astype(np.float64))) ** 2
    at = int(np.searchsorted(np.cumsum(power), power.sum() / 2))
    return float(np.fft.rfftfreq(len(volts), 1 / RATE)[at])


def test_equal_options_give_equal_signals_and_others_do_not() -> None:
    np.testing.assert_array_equal(moving().samples, moving().samples)
    for other in ({"person": 2}, {"session": 2}, {"day": 1}, {"load": "hammer"}):
        assert not np.array_equal(CLEAN, moving(**other).samples)


def test_samples_are_the_same_however_they_are_cut_and_begin_again_after_the_session() -> None:
    made = moving()
    pieces = [made.read(first, 7) for first in range(0, made.length + 700, 7)]
    joined = np.concatenate(pieces)
    np.testing.assert_array_equal(joined[: made.length], made.samples)
    np.testing.assert_array_equal(joined[made.length : made.length + 700], made.samples[:700])
    assert made.label_at(made.length + 1500) == made.label_at(1500)


def test_every_movement_is_prompted_as_often_as_asked() -> None:
    prompts = moving(repetitions=3).prompts
    for repetition in range(3):
        shown = [prompt.movement for prompt in prompts if prompt.repetition == repetition]
        assert sorted(shown) == sorted(MOVEMENTS)
    orders = [[prompt.movement for prompt in prompts[6 * k : 6 * k + 6]] for k in range(3)]
    assert orders[0] != orders[1] or orders[1] != orders[2]


def test_the_muscles_follow_each_prompt_after_a_reaction() -> None:
    made = moving(reaction_s=(0.15, 0.45))
    for prompt in made.prompts:
        for asked, done in ((prompt.shown, prompt.onset), (prompt.hidden, prompt.release)):
            assert 0.149 <= (done - asked) / RATE <= 0.451
        assert made.prompt_at(prompt.shown - 1) == REST
        assert made.prompt_at(prompt.shown) == prompt.movement
        assert made.label_at(prompt.onset - 1) == REST
        assert made.label_at(prompt.onset) == made.label_at(prompt.release - 1) == prompt.movement
        assert made.label_at(prompt.release) == REST


def test_labels_are_true_each_movement_is_louder_than_rest_and_unlike_the_others() -> None:
    made = moving(hold_s=3.0, rest_s=3.0)
    rest = levels(made, REST).max()
    patterns = [levels(made, movement) for movement in MOVEMENTS]
    for number, pattern in enumerate(patterns):
        assert pattern.max() > 4 * rest
        for other in patterns[:number]:
            cosine = pattern @ other / np.linalg.norm(pattern) / np.linalg.norm(other)
            assert cosine < 0.999


def test_a_load_is_heard_at_rest_and_the_heavier_one_louder() -> None:
    people = range(1, 6)
    mean = {
        load: np.mean([levels(moving(person=who, load=load), REST).mean() for who in people])
        for load in LOADS
    }
    assert mean["unloaded"] < mean["5 lb"] < mean["15 lb"]
    assert mean["unloaded"] < mean["hammer"]


def test_a_hammer_is_held_by_some_channels_more_than_a_weight() -> None:
    def bias(load: str) -> float:
        found = [levels(moving(person=who, load=load), REST) for who in range(1, 7)]
        return float(np.mean([np.std(level) / np.mean(level) for level in found]))

    assert bias("hammer") > 1.2 * bias("15 lb")


def test_the_signal_has_the_band_of_surface_emg() -> None:
    samples = Moving(Prompted(repetitions=1, load="15 lb"), 2000.0).samples[:, 0]
    power = np.abs(np.fft.rfft(samples.astype(np.float64))) ** 2
    hz = np.fft.rfftfreq(len(samples), 1 / 2000.0)
    assert power[(hz > 15) & (hz < 500)].sum() > 0.97 * power.sum()


def test_contractions_differ_from_one_repetition_to_the_next_unless_scatter_is_off() -> None:
    def spread(**scatter: float) -> float:
        made = moving(repetitions=6, scatter={"effort": 0, "synergy": 0, "hold": 0, "day": 0, **scatter})
        stretches = [
            made.samples[p.onset + 300 : p.release] for p in made.prompts if p.movement == "pronation"
        ]
        return float(np.std([np.log(np.std(stretch)) for stretch in stretches]))

    assert spread(effort=0.5) > 4 * spread()


def test_fatigue_lowers_the_frequencies_and_raises_the_voltage_towards_the_end() -> None:
    usual = {"load": "15 lb", "effort": 0.0, "scatter": {"hold": 0.0}, "repetitions": 4}
    made = moving(**usual, drift={"fatigue": 1.0, "amplitude": 0.5})
    first, last = made.samples[: made.length // 4, 0], made.samples[-made.length // 4 :, 0]
    assert median_hz(last) < 0.9 * median_hz(first)
    assert np.std(last) > 1.2 * np.std(first)
    still = moving(**usual)
    tail = still.samples[-still.length // 4 :, 0]
    assert median_hz(tail) == pytest.approx(median_hz(still.samples[: still.length // 4, 0]), rel=0.06)


def test_a_band_that_turns_by_one_electrode_moves_the_pattern_by_one_channel() -> None:
    usual = {"load": "15 lb", "effort": 0.0, "scatter": {"hold": 0.0, "day": 0.0}, "repetitions": 3}
    turned = moving(**usual, drift={"rotation_rad": np.pi / 2}).samples
    before, after = (np.std(part, axis=0) for part in (turned[:3000], turned[-1000:]))
    assert np.corrcoef(np.roll(before, -1), after)[0, 1] > 0.9
    assert np.corrcoef(before, after)[0, 1] < 0.9


def spoilt(**nuisances: object) -> NDArray[np.float32]:
    return moving(nuisances=nuisances).samples


CLEAN = moving().samples


def test_hum_is_the_same_on_every_channel() -> None:
    hum = spoilt(hum_v=1e-4, hum_hz=60.0) - CLEAN
    assert np.abs(hum).max() == pytest.approx(1e-4, rel=0.01)
    np.testing.assert_allclose(hum[:, 0], hum[:, 3], atol=1e-9)
    assert np.argmax(np.abs(np.fft.rfft(hum[:1000, 0]))) == 60


def test_an_offset_is_a_constant_of_each_channel() -> None:
    offset = spoilt(offset_v=1e-3) - CLEAN
    assert np.ptp(offset, axis=0).max() < 1e-8
    assert np.ptp(offset[0]) > 1e-5


def test_a_touched_cable_swings_slowly() -> None:
    swing = spoilt(artefacts_per_min=60.0, artefact_v=1e-3) - CLEAN
    assert np.abs(swing).max() > 1e-4
    assert median_hz(swing[:, 0]) < 10


def test_dead_channels_are_flat_and_dropouts_are_so_for_a_while() -> None:
    loudest = np.abs(spoilt(dead=[2])).max(axis=0)
    assert loudest[2] == 0
    assert np.delete(loudest, 2).min() > 0
    share = np.mean(spoilt(dropout=0.3) == 0)
    assert 0.15 < share < 0.45


def test_a_band_that_was_put_on_turned_has_its_channels_rolled() -> None:
    np.testing.assert_array_equal(spoilt(roll=1), np.roll(CLEAN, 1, axis=1))


def test_a_converter_has_rails_and_steps() -> None:
    coarse = spoilt(rail_v=1e-4, bits=4)
    assert np.abs(coarse).max() == pytest.approx(1e-4)
    assert len(np.unique(coarse)) <= 17


def test_an_armband_gives_whole_counts_with_exact_zeros_at_rest() -> None:
    made = Moving(Prompted(repetitions=1, electrodes=8, nuisances=MYO), 200.0)
    counts = made.samples.astype(np.float64) / MYO.counts_v
    np.testing.assert_allclose(counts, np.rint(counts), atol=1e-4)
    assert np.rint(counts).min() >= -128
    assert np.rint(counts).max() <= 127
    assert counts.max() > 20
    assert np.mean(counts[labels(made) == REST] == 0) > 0.2


def test_a_session_that_is_too_long_to_be_held_is_refused() -> None:
    with pytest.raises(ConfigError, match=r"'movements' makes .* the bound is 2e\+07"):
        Moving(Prompted(repetitions=100, hold_s=30.0, rest_s=30.0), 1000.0)


async def test_a_live_source_plays_movements_and_can_tell_which_is_true(clock: VirtualClock) -> None:
    options: dict[str, Value] = {"movements": {**SHORT, "load": "5 lb"}}
    async with open_emg(EmgConfig(RATE, 3, options), clock) as source:
        assert source.channels == 4
        blocks = aiter(source)
        block = await anext(blocks)
        while block.first_index < 1500:
            block = await anext(blocks)
    expected = moving(load="5 lb")
    np.testing.assert_array_equal(block.samples, expected.read(block.first_index, len(block.samples)))
    assert source.moving is not None
    told = [source.moving.label_at(index) for index in range(0, expected.length, 50)]
    assert told == labels(expected)[::50].tolist()
    assert set(told) == {REST, *MOVEMENTS}


async def test_a_person_who_is_told_to_relax_does_nothing(clock: VirtualClock) -> None:
    async with open_emg(EmgConfig(RATE, 4, {"movements": {**SHORT, "load": "15 lb"}}), clock) as source:
        source.relaxed = True
        blocks = aiter(source)
        samples = np.concatenate([(await anext(blocks)).samples for _ in range(300)])
    assert np.std(samples) < 8e-6


@pytest.mark.parametrize(
    ("options", "told"),
    [
        ({"movements": {"load": "anvil"}}, "movements.load"),
        ({"movements": {"repetition": 2}}, "movements.repetition"),
        ({"movements": {"electrodes": 2}}, "'movements.electrodes' is 2, but the config reads channel 3"),
    ],
)
async def test_what_cannot_be_played_is_refused(
    clock: VirtualClock, options: dict[str, Value], told: str
) -> None:
    with pytest.raises(ConfigError, match=told):
        async with open_emg(EmgConfig(RATE, 4, options), clock):
            pass
