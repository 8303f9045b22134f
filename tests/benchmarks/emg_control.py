"""Toggles by co-contraction and by pulse on generated muscles: false, missed, and what they cost."""

import time
from collections.abc import Iterator, Sequence

import numpy as np

from bentod.config_sites import CoContraction, Pair, Pulse
from bentod.control.course import Heard
from bentod.control.proportional import Envelope, Proportional, Site
from bentod.control.schemes import Scheme, schemes_of
from bentod.frames import Samples
from sim.antagonists import Habits, Squeezing, squeezes, to_and_fro
from tests.benchmarks.harness import Row, at_most, main

SITES = (Site("biceps", 0, 1.0, 15e-6, 60e-6), Site("triceps", 1, 1.0, 10e-6, 35e-6))
"""Thresholds and maxima with which the recording of 105 s has both above for 5.7 % of the time."""

SECONDS = 105.0
RECORDINGS = 10
SQUEEZES = 400
"""In each of `SESSIONS`."""

SESSIONS = 3
RATES_HZ = (200.0, 1000.0)
TICK_HZ = 30.0
TWO_SITES = {"group": "arm", "positive": "biceps", "negative": "triceps"}


class Wearer:
    """A scheme on these sites, sample blocks as they come in a tick."""

    def __init__(self, pair: Pair, rate_hz: float) -> None:
        self.scheme: Scheme = schemes_of([pair], [], rate_hz)[0]
        self._envelope = Envelope(round(0.05 * rate_hz))
        self._proportional = Proportional(SITES)

    def toggles(self, samples: Samples) -> int:
        """How many there are in `samples`, all since the last call."""
        levels = self._envelope.step(samples)
        sites = {site.name: site for site in SITES}
        return len(self.scheme.step(Heard(sites, levels, self._proportional.step(levels))))


def rows() -> Iterator[Row]:
    """About two minutes."""
    squeezed = Pair.model_validate(TWO_SITES | {"co_contraction": CoContraction()})
    pulsed = Pair.model_validate(TWO_SITES | {"pulse": Pulse(site="triceps")})
    for rate_hz in RATES_HZ:
        at = f"at {rate_hz:g} Hz"
        moving = [to_and_fro(SECONDS, rate_hz, seed) for seed in range(RECORDINGS)]
        share = 100 * float(np.mean([_both_above(samples, rate_hz) for samples in moving]))
        yield Row(f"antagonists {at}: both above threshold", share, "% of the time")
        false = _false(squeezed, moving, rate_hz)
        yield at_most(f"co-contraction {at}: false toggles in {RECORDINGS} x {SECONDS:g} s", false, "", 0)
        false = _false(pulsed, moving, rate_hz)
        yield Row(f"pulse {at}: false toggles in {RECORDINGS} x {SECONDS:g} s", false, "")
        missed, doubled = _meant(squeezed, rate_hz, Squeezing())
        yield at_most(f"co-contraction {at}: missed of {SESSIONS * SQUEEZES} squeezes", missed, "%", 2.0)
        yield at_most(f"co-contraction {at}: counted twice", doubled, "%", 0.0)
    yield from _strangers(squeezed)
    yield Row("a tick with co-contraction at 1000 Hz", 1e6 * _cost(squeezed), "us")
    yield Row("a tick without", 1e6 * _cost(Pair.model_validate(TWO_SITES)), "us")


def _strangers(pair: Pair) -> Iterator[Row]:
    """People whom the defaults do not fit."""
    for share in (0.4, 0.5, 0.6):
        habits = Habits(company=(share, share))
        moving = [to_and_fro(SECONDS, 200.0, seed, habits) for seed in range(RECORDINGS)]
        text = f"antagonist accompanies with {share:.0%}: false toggles a minute"
        yield Row(text, _false(pair, moving, 200.0) / (RECORDINGS * SECONDS / 60), "")
    for skew in (0.06, 0.1):
        missed, _ = _meant(pair, 200.0, Squeezing(skew_s=skew))
        yield Row(f"squeezes with a skew of {1e3 * skew:g} ms (standard deviation): missed", missed, "%")


def _false(pair: Pair, recordings: Sequence[Samples], rate_hz: float) -> int:
    return sum(Wearer(pair, rate_hz).toggles(samples) for samples in recordings)


def _meant(pair: Pair, rate_hz: float, squeezing: Squeezing) -> tuple[float, float]:
    """Percent of the squeezes that were missed, and that were counted more than once."""
    counts: list[int] = []
    for seed in range(SESSIONS):
        samples, onsets = squeezes(SQUEEZES, rate_hz, seed, squeezing)
        wearer = Wearer(pair, rate_hz)
        counts += [wearer.toggles(piece) for piece in np.split(samples, onsets)][1:]
    return 100 * float(np.mean(np.array(counts) == 0)), 100 * float(np.mean(np.array(counts) > 1))


def _both_above(samples: Samples, rate_hz: float) -> float:
    levels = Envelope(round(0.05 * rate_hz)).step(samples)
    return float(np.mean(np.all([levels[:, s.channel] > s.threshold for s in SITES], axis=0)))


def _cost(pair: Pair) -> float:
    """Seconds a tick, median."""
    rate_hz, samples = 1000.0, to_and_fro(30.0, 1000.0, 1)
    wearer, size, costs = Wearer(pair, rate_hz), round(rate_hz / TICK_HZ), []
    for start in range(0, len(samples) - size, size):
        before = time.perf_counter()
        wearer.toggles(samples[start : start + size])
        costs.append(time.perf_counter() - before)
    return float(np.median(costs))


if __name__ == "__main__":
    main("emg_control", rows())
