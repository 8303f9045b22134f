"""Features as slow loops over one segment, straight from their definitions."""

from collections.abc import Callable
from math import copysign

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def zc(x: Floats, threshold: float) -> float:
    sign, count = 0.0, 0
    for value in x:
        if abs(value) > threshold:
            count += sign * value < 0
            sign = copysign(1, value)
    return float(count)


def zc_product(x: Floats, threshold: float) -> float:
    return float(
        sum(x[i] * x[i + 1] < 0 and abs(x[i] - x[i + 1]) > threshold for i in range(len(x) - 1)),
    )


def ssc(x: Floats, threshold: float) -> float:
    turns = ((x[i] - x[i - 1]) * (x[i] - x[i + 1]) for i in range(1, len(x) - 1))
    return float(sum(turn > threshold**2 for turn in turns))


def ssc_ge0(x: Floats, threshold: float) -> float:
    turns = ((x[i] - x[i - 1]) * (x[i] - x[i + 1]) for i in range(1, len(x) - 1))
    return float(sum(turn >= threshold**2 for turn in turns))


def wamp(x: Floats, threshold: float) -> float:
    return float(sum(abs(x[i + 1] - x[i]) > threshold for i in range(len(x) - 1)))


COUNTS: dict[str, Callable[[Floats, float], float]] = {
    "zc": zc,
    "zc_product": zc_product,
    "ssc": ssc,
    "ssc_ge0": ssc_ge0,
    "wamp": wamp,
}

AMPLITUDES: dict[str, Callable[[Floats], float]] = {
    "mav": lambda x: float(np.mean(np.abs(x))),
    "iav": lambda x: float(sum(abs(value) for value in x)),
    "wl": lambda x: float(sum(abs(x[i + 1] - x[i]) for i in range(len(x) - 1))),
    "rms": lambda x: float(np.sqrt(np.mean(x**2))),
    "var_centred": lambda x: float(np.var(x)),
    "var_meansquare": lambda x: float(sum(x**2) / len(x)),
    "var_zero_mean": lambda x: float(sum(x**2) / (len(x) - 1)),
}


def burg(x: Floats, order: int) -> Floats:
    a, f, b = np.array([1.0]), x[1:], x[:-1]
    for _ in range(order):
        power = f @ f + b @ b
        k = -2 * (f @ b) / power if power else 0.0
        longer = np.append(a, 0.0)
        a = longer + k * longer[::-1]
        f, b = (f + k * b)[1:], (b + k * f)[:-1]
    return a[1:]


def autocorr(x: Floats, order: int) -> Floats:
    r = np.array([x[lag:] @ x[: len(x) - lag] for lag in range(order + 1)]) / len(x)
    matrix = np.array([[r[abs(i - j)] for j in range(order)] for i in range(order)])
    return np.asarray(np.linalg.solve(matrix, -r[1:])) if r[0] else np.zeros(order)


def cepstrum(a: Floats) -> Floats:
    """c_1 … c_p of 1/A(z) from its log spectrum, which has no aliasing to speak of at so many points."""
    spectrum = np.fft.fft(np.concatenate(([1.0], a)), 1 << 14)
    return np.asarray(2 * np.fft.ifft(-np.log(np.abs(spectrum))).real[1 : len(a) + 1])
