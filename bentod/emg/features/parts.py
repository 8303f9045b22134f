"""Each feature as operations on rows. N samples are in a segment; `out` has one row a window.

Sources: Hudgins, Parker and Scott 1993 (mav, mavs, zc, ssc, wl); Zardoshti-Kermani et al. 1995 (variance,
histogram, wamp); thesis 3.3.1 (ratios).
"""

from collections.abc import Callable, Sequence
from functools import partial
from itertools import combinations
from typing import TypeAlias, cast

import numpy as np

from bentod.emg.features import regression
from bentod.emg.features.histogram import Bins
from bentod.emg.features.marks import both, crossings, masked, only
from bentod.emg.features.rows import Floats, Rows
from bentod.emg.features.tables import (
    Asked,
    Autoregressive,
    Cepstral,
    Histogram,
    Logarithm,
    Ratios,
    Thresholded,
)

Part: TypeAlias = Callable[[Rows, Asked, Floats], None]
"""Has a feature computed into `out`, shape (windows, channels, segments, values) except where it says so."""


def mav(rows: Rows, _: Asked, out: Floats) -> None:
    """Mean of |x|."""
    rows.do(np.multiply, rows.total(), 1 / rows.length, out[..., 0])


def iav(rows: Rows, _: Asked, out: Floats) -> None:
    """Σ |x|."""
    rows.do(np.copyto, out[..., 0], rows.total())


def mavs(rows: Rows, _: Asked, out: Floats) -> None:
    """From the mean of |x| of a segment to that of the next; shape (windows, channels, segments − 1, 1)."""
    found = rows.mav()
    rows.do(np.subtract, found[..., 1:], found[..., :-1], out[..., 0])


def wl(rows: Rows, _: Asked, out: Floats) -> None:
    """Σ |x_{i+1} − x_i|."""
    steepness = rows.steepness()
    rows.do(np.vecdot, steepness, np.ones(steepness.shape[-1]), out[..., 0])


def rms(rows: Rows, _: Asked, out: Floats) -> None:
    """√(Σ x² / N)."""
    mean = np.empty(rows.shape)
    rows.do(np.multiply, rows.power(), 1 / rows.length, mean)
    rows.do(np.sqrt, mean, out[..., 0])


def log_rms(rows: Rows, asked: Asked, out: Floats) -> None:
    """Natural logarithm of √(Σ x² / N), or of the floor where that is greater."""
    power = np.empty(rows.shape)
    rows.do(np.multiply, rows.power(), 1 / rows.length, power)
    rows.do(partial(np.maximum, power, cast("Logarithm", asked).floor_v ** 2, out=power))
    rows.do(np.log, power, power)
    rows.do(np.multiply, power, 0.5, out[..., 0])


def var_meansquare(rows: Rows, _: Asked, out: Floats) -> None:
    """Σ x² / N."""
    rows.do(np.multiply, rows.power(), 1 / rows.length, out[..., 0])


def var_zero_mean(rows: Rows, _: Asked, out: Floats) -> None:
    """Σ x² / (N − 1): thesis (3.4)."""
    rows.do(np.multiply, rows.power(), 1 / (rows.length - 1), out[..., 0])


def var_centred(rows: Rows, _: Asked, out: Floats) -> None:
    """Σ (x − mean)² / N."""
    mean, apart = rows.sums(rows.padded), rows.zeros()
    rows.do(np.multiply, mean, 1 / rows.length, mean)
    rows.do(np.subtract, rows.x, mean[..., np.newaxis], apart[..., : rows.length])
    rows.do(np.multiply, rows.sums(apart, apart), 1 / rows.length, out[..., 0])


def zc(rows: Rows, asked: Asked, out: Floats) -> None:
    """Changes of sign, between samples with |x| > threshold; what is between them has the sign before."""
    threshold = cast("Thresholded", asked).threshold_v
    negative = rows.marks.mark(np.less, rows.padded, -threshold)
    signed = rows.marks.mark(np.greater, rows.magnitude(), threshold)
    valid = rows.marks.within(0, rows.length)
    rows.marks.count(crossings(negative, signed, valid), out[..., 0])


def zc_product(rows: Rows, asked: Asked, out: Floats) -> None:
    """Neighbours with x_i x_{i+1} < 0 and |x_i − x_{i+1}| > threshold (Hudgins)."""
    product = rows.zeros()
    last = rows.length - 1
    rows.do(np.multiply, rows.x[..., 1:], rows.x[..., :-1], product[..., :last])
    opposite = rows.marks.mark(np.less, product, 0.0)
    apart = rows.marks.mark(np.greater, rows.steepness(), cast("Thresholded", asked).threshold_v)
    rows.marks.count(both(opposite, apart), out[..., 0])


def ssc(rows: Rows, asked: Asked, out: Floats) -> None:
    """Samples with (x_i − x_{i−1})(x_i − x_{i+1}) > threshold²."""
    bound = cast("Thresholded", asked).threshold_v ** 2
    mark = rows.marks.mark(np.less, rows.once("bend", lambda: _bend(rows)), -bound)
    rows.marks.count(only(mark), out[..., 0])


def ssc_ge0(rows: Rows, asked: Asked, out: Floats) -> None:
    """Samples with (x_i − x_{i−1})(x_i − x_{i+1}) ≥ threshold²: counts all of a flat signal at 0."""
    bound = cast("Thresholded", asked).threshold_v ** 2
    mark = rows.marks.mark(np.less_equal, rows.once("bend", lambda: _bend(rows)), -bound)
    rows.marks.count(masked(mark, rows.marks.within(0, rows.length - 2)), out[..., 0])


def _bend(rows: Rows) -> Floats:
    """(x_{i+1} − x_i)(x_{i+2} − x_{i+1}) at i, which is minus what `ssc` asks for at i + 1."""
    change, found = rows.change(), rows.zeros()
    flat = change.reshape(-1)
    rows.do(np.multiply, flat[1:], flat[:-1], found.reshape(-1)[:-1])
    return found


def wamp(rows: Rows, asked: Asked, out: Floats) -> None:
    """Neighbours with |x_{i+1} − x_i| > threshold."""
    mark = rows.marks.mark(np.greater, rows.steepness(), cast("Thresholded", asked).threshold_v)
    rows.marks.count(only(mark), out[..., 0])


def hist(rows: Rows, asked: Asked, out: Floats) -> None:
    """Share of the samples in each bin."""
    rows.do(Bins(rows, cast("Histogram", asked), out).count)


def ratios(rows: Rows, asked: Asked, out: Floats) -> None:
    """(MAV_i − MAV_j) / (MAV_i + MAV_j) for channels i < j; shape (windows, pairs, segments, 1)."""
    pairs = np.array(list(combinations(range(rows.shape[1]), 2)))
    one, other = (np.empty(out.shape[:-1]) for _ in range(2))
    floor = cast("Ratios", asked).floor_v
    rows.do(np.take, rows.mav(), pairs[:, 0], 1, one, "clip")
    rows.do(np.take, rows.mav(), pairs[:, 1], 1, other, "clip")
    rows.do(np.subtract, one, other, out[..., 0])
    rows.do(np.add, one, other, one)
    rows.do(partial(np.maximum, one, floor, out=one))
    rows.do(np.divide, out[..., 0], one, out[..., 0])


def ar(method: str) -> Part:
    """Coefficients a_1.. of x_t + a_1 x_{t−1} + … = e."""

    def part(rows: Rows, asked: Asked, out: Floats) -> None:
        found = regression.coefficients(rows, method, cast("Autoregressive", asked).order)
        rows.do(np.copyto, out, np.moveaxis(found, 0, -1))

    return part


def cc(rows: Rows, asked: Asked, out: Floats) -> None:
    """Coefficients c_1.. of the cepstrum of 1/A(z)."""
    cepstral = cast("Cepstral", asked)
    found = regression.cepstrum(rows, regression.coefficients(rows, cepstral.method, cepstral.order))
    rows.do(np.copyto, out, np.moveaxis(found, 0, -1))


def bias(rows: Rows, _: Asked, out: Floats) -> None:
    """1; shape (windows, 1, 1, 1)."""
    rows.do(np.copyto, out, 1.0)


PARTS: dict[str, Part] = {
    **{
        part.__name__: part for part in (mav, iav, mavs, wl, rms, log_rms, zc, zc_product, ssc, ssc_ge0, wamp)
    },
    **{part.__name__: part for part in (var_centred, var_meansquare, var_zero_mean, hist, ratios, cc, bias)},
    "ar_burg": ar("burg"),
    "ar_autocorr": ar("autocorr"),
}


def columns(asked: Asked, channels: int) -> Sequence[str]:
    """What follows the feature's name in the names of its columns, e.g. "[3]" of channel 3."""
    if asked.name == "bias":
        return ("",)
    places = [f"[{channel}]" for channel in range(channels)]
    if isinstance(asked, Ratios):
        places = [f"[{one},{other}]" for one, other in combinations(range(channels), 2)]
    segments = range(asked.segments - 1 if asked.name == "mavs" else asked.segments)
    spread = [f".s{segment}" if asked.segments > 1 else "" for segment in segments]
    return [place + segment + value for place in places for segment in spread for value in _values(asked)]


def _values(asked: Asked) -> Sequence[str]:
    if isinstance(asked, Autoregressive):
        letter = "c" if isinstance(asked, Cepstral) else "a"
        return [f".{letter}{number}" for number in range(1, asked.order + 1)]
    if isinstance(asked, Histogram):
        return [f".b{number}" for number in range(asked.bins)]
    return ("",)
