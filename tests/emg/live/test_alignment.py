"""Labels stand where muscles worked, not where prompts stood."""

from dataclasses import replace

import numpy as np
import pytest

from bentod.emg.live.alignment import aligned, labelled
from bentod.emg.live.collection import Session
from bentod.emg.live.plan import Plan
from bentod.emg.live.quality import clipped, quality, warnings
from bentod.frames import Samples
from tests.emg.live.signals import FILTERS, LABELS, RATE_HZ, performed, session, wearer

PLAN = Plan(("close",), 2.0, 2.0, 3)


def contracting(delays: tuple[float, ...], strength: float = 10.0) -> Session:
    """White noise, each contraction that many seconds after its prompt, and as late at its end."""
    random = np.random.default_rng(1)
    samples = 1e-6 * random.normal(size=(PLAN.samples(RATE_HZ), 4))
    prompts = PLAN.prompts(RATE_HZ)
    for prompt, delay in zip(prompts, delays, strict=True):
        late = round(delay * RATE_HZ)
        samples[prompt.shown + late : prompt.hidden + late] *= strength
    return Session(RATE_HZ, samples.astype(np.float32), prompts)


def test_each_contraction_is_found_where_it_began_and_ended() -> None:
    delays = (0.2, 0.45, -0.1)
    for found, delay in zip(aligned(contracting(delays), ()), delays, strict=True):
        assert found.aligned
        assert found.made
        assert found.delay_s(RATE_HZ) == pytest.approx(delay, abs=0.03)
        assert (found.release - found.prompt.hidden) / RATE_HZ == pytest.approx(delay, abs=0.05)


def test_labels_follow_and_what_lies_between_belongs_to_neither_class() -> None:
    one = contracting((0.3, 0.3, 0.3))
    piece, prompted = labelled(one, aligned(one, ()), "sitting")
    shown, hidden = one.prompts[0].shown, one.prompts[0].hidden
    assert prompted[shown] == prompted[hidden - 1] == "close" != prompted[hidden]
    assert piece.labels[shown + 100] == "rest"
    assert piece.labels[shown + 250] == ""
    assert piece.labels[shown + 400] == piece.labels[hidden + 200] == "close"
    assert piece.labels[hidden + 370] == ""
    assert piece.labels[hidden + 500] == "rest"
    assert set(piece.conditions) == {"sitting"}


def test_rests_count_to_the_contraction_after_them_and_the_last_to_the_last() -> None:
    one = contracting((0.3, 0.3, 0.3))
    piece, _ = labelled(one, aligned(one, ()), "")
    places = [0, *(prompt.shown + 500 for prompt in one.prompts), len(one.samples) - 1]
    assert [piece.repetitions[place] for place in places] == [0, 0, 1, 2, 2]


def test_a_contraction_that_was_not_made_is_left_out_and_told() -> None:
    one = contracting((0.3, 0.3, 0.3))
    prompt = one.prompts[1]
    one.samples[prompt.shown : prompt.hidden + 600] = one.samples[:2600]
    moved = aligned(one, ())
    piece, _ = labelled(one, moved, "")
    assert [found.made for found in moved] == [True, False, True]
    assert set(piece.labels[prompt.shown : prompt.hidden]) == {""}
    told = warnings(quality(one, moved), moved, RATE_HZ)
    assert told == ["close, repetition 2: left out, since the signal was only 1.1 times that at rest."]


def test_one_that_began_long_before_its_prompt_is_labelled_by_the_usual_delay_and_told() -> None:
    one = contracting((0.2, 0.2, 0.2))
    prompt = one.prompts[2]
    one.samples[prompt.shown - 500 : prompt.shown + 200] *= 10
    moved = aligned(one, ())
    assert not moved[2].aligned
    assert moved[2].delay_s(RATE_HZ) == pytest.approx(0.2, abs=0.03)
    assert moved[2].text(RATE_HZ).endswith("a guess, +0.19 s.")


def test_simulated_people_are_found_within_the_ramp_of_their_muscles() -> None:
    moved = aligned(session(), FILTERS)
    assert all(found.aligned and found.made for found in moved)
    assert all(0.1 < found.delay_s(RATE_HZ) < 0.7 for found in moved)


def test_missing_samples_stay_missing_and_are_told() -> None:
    one = performed(Plan(LABELS[:1], 1.5, 1.5, 2), wearer())
    prompt = one.prompts[0]
    one.samples[prompt.shown + 700 : prompt.shown + 900] = np.nan
    moved = aligned(one, FILTERS)
    found = quality(one, moved)
    assert warnings(found, moved, RATE_HZ) == ["wrist_flexion lacks 7 % of its samples."]
    assert np.isnan(labelled(one, moved, "")[0].samples[prompt.shown + 800]).all()


def rails(bound: float) -> Samples:
    volts = np.random.default_rng(2).normal(size=(5000, 2)).astype(np.float32)
    return np.clip(np.cumsum(volts, axis=0) % 40 - 20, -bound, bound).astype(np.float32)


def test_a_converter_at_its_rails_is_told_from_one_that_is_not() -> None:
    assert clipped(rails(15.0)) > 0.05
    assert clipped(rails(100.0)) == 0.0
    assert clipped(np.zeros((100, 2), np.float32)) == 0.0


def test_a_session_without_any_contraction_is_guessed_and_left_out() -> None:
    one = contracting((0.3, 0.3, 0.3), strength=1.0)
    assert not any(found.made for found in aligned(one, ()))
    flat = replace(one, samples=np.zeros_like(one.samples))
    assert not any(found.made for found in aligned(flat, ()))
