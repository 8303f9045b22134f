"""What features of windows cost, beside libemg on the same windows, in turns within one run."""

import statistics
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from bentod.emg.features.feature_list import FeatureList
from bentod.emg.recognition import Segmenting
from bentod.emg.segmenting import cut
from tests.benchmarks.emg_libemg import Libemg, NotMeasuredError, libemg
from tests.benchmarks.harness import Row, at_least, at_most, interleave, main, medians

CHANNELS = 8
RATE_HZ = 1000.0
SECONDS = 20
WINDOW = Segmenting(150, 50)
ROUNDS = 41
ONE_CALLS = 200
BATCH_CALLS = 3


@dataclass(frozen=True, slots=True)
class Kind:
    """The same features here and there."""

    name: str
    ours: str
    theirs: tuple[str, ...]
    one_us: float  # µs that one window may take where nothing disturbs it
    times: float  # how much faster one window has to be
    batch_times: float  # and all windows of a recording


TD = ("MAV", "ZC", "SSC", "WL")
KINDS = (
    Kind("MAV ZC SSC WL", "td", TD, 25, 3, 3),
    Kind("MAV ZC SSC WL AR(4)", "tdar", (*TD, "AR"), 60, 4, 3),
)


def recording() -> NDArray[np.float64]:
    """Noise in the band of muscles, louder and softer; V, shape (samples, channels)."""
    random = np.random.default_rng(8)
    noise = random.standard_normal((int(SECONDS * RATE_HZ) + 4, CHANNELS))
    smooth = np.asarray(sum(noise[lag : len(noise) - 4 + lag] for lag in range(5))) / 5
    loudness = 0.2 + np.abs(np.sin(np.arange(len(smooth)) / 700))[:, np.newaxis]
    return np.asarray(1e-4 * loudness * (smooth - smooth.mean(axis=0)))


def rows() -> Iterator[Row]:
    """About a minute, and the time to install libemg once."""
    windows = cut(recording(), WINDOW)
    try:
        with libemg(np.ascontiguousarray(windows)) as peer:
            for kind in KINDS:
                yield from _compare(kind, windows, peer)
            yield from _values(windows, peer)
    except NotMeasuredError as error:
        yield Row(f"against libemg: not measured, {error}", float("nan"), "times")
        for kind in KINDS:
            yield from _alone(kind, windows)


def _compare(kind: Kind, windows: NDArray[np.float64], peer: Libemg) -> Iterator[Row]:
    for title, count, calls, times in (
        ("one window", 1, ONE_CALLS, kind.times),
        ("recording, a window", len(windows), BATCH_CALLS, kind.batch_times),
    ):
        measures: dict[str, Callable[[], float]] = {
            "bentod": partial(_seconds, FeatureList(kind.ours, CHANNELS, RATE_HZ), windows[:count], calls),
            "libemg": partial(peer.seconds, kind.theirs, count, calls),
        }
        for warm in measures.values():
            warm()
        taken = interleave(measures, ROUNDS)
        found = {name: 1e6 * statistics.median(each) / count for name, each in taken.items()}
        for name, median in found.items():
            yield Row(f"{kind.name}, {title}: {name}", median, "µs")
        if count == 1:
            yield at_most("  bentod, the fastest round", 1e6 * min(taken["bentod"]), "µs", kind.one_us)
        yield at_least("  faster by", found["libemg"] / found["bentod"], "times", times)


def _alone(kind: Kind, windows: NDArray[np.float64]) -> Iterator[Row]:
    for count, calls in ((1, ONE_CALLS), (len(windows), BATCH_CALLS)):
        run = partial(_seconds, FeatureList(kind.ours, CHANNELS, RATE_HZ), windows[:count], calls)
        taken = 1e6 * medians({"bentod": run}, ROUNDS)["bentod"] / count
        yield Row(f"{kind.name}, {count} windows, a window: bentod", taken, "µs")


def _seconds(features: FeatureList, windows: NDArray[np.float64], calls: int) -> float:
    begun = time.perf_counter()
    for _ in range(calls):
        features.of(windows)
    return (time.perf_counter() - begun) / calls


def _values(windows: NDArray[np.float64], peer: Libemg) -> Iterator[Row]:
    """Where both mean the same; there is no exact zero, nothing flat and no threshold in this recording."""
    asked = ["mav", "zc", "ssc", "wl", "rms", "var_centred", "ar_burg"]
    ours = FeatureList(asked, CHANNELS, RATE_HZ).of(windows)
    theirs = peer.values(("MAV", "ZC", "SSC", "WL", "RMS", "VAR", "AR"), len(windows))
    apart = float(np.max(np.abs(ours - theirs) / np.maximum(np.abs(theirs), 1e-3)))
    yield at_most("greatest difference to libemg, relative", apart, "1", 1e-9)


if __name__ == "__main__":
    main("emg_features", rows())
