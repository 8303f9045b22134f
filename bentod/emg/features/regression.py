"""Linear prediction, x_t + a_1 x_{t−1} + … + a_p x_{t−p} = e, of many rows at once, and its cepstrum.

No mean is removed, and there is no intercept. What is 0, or predicted without an error, is not divided by 0:
what remains to be predicted then has coefficients 0. Sources: Burg 1967; Makhoul 1975 for the recursion of
Levinson and Durbin.
"""

import numpy as np
from numpy.lib.stride_tricks import as_strided

from bentod.emg.features.rows import Floats, Rows

TINY = 1e-200
"""V²; no signal has so little power, and its inverse is finite."""


def coefficients(rows: Rows, method: str, order: int) -> Floats:
    """a_1 … a_p of each row, shape (p, windows, channels, segments), by "burg" or "autocorr"."""
    make = burg if method == "burg" else autocorr
    return rows.once(f"{method} {order}", lambda: make(rows, order))


def burg(rows: Rows, order: int) -> Floats:
    """Burg's method: each reflection k = −2 f·b / (f·f + b·b) makes the errors f and b least together."""
    every = rows.padded.reshape(-1, rows.padded.shape[-1])
    found = np.empty((order, len(every)))
    errors = np.zeros((2, *every.shape))
    rows.do(np.copyto, errors, every)
    products, sums = np.empty((2, 2, len(every))), np.empty((2, len(every)))
    power, across = sums
    for number, k in enumerate(found):
        both = _both(errors, rows.length, number + 1)
        rows.do(np.vecdot, both[:, np.newaxis], both, products)
        rows.do(np.add, products[0], products[1, ::-1], sums)  # f·f + b·b and f·b + b·f
        rows.do(np.subtract, -TINY, power, power)
        rows.do(np.divide, across, power, k)
        _reflect(rows, found, number)
        if number < order - 1:
            _filter(rows, errors, k[:, np.newaxis], number + 1)
    return found.reshape(order, *rows.shape)


def _both(errors: Floats, length: int, lag: int) -> Floats:
    """f(t) and b(t − 1) where there are both, as one array: they are kept so far apart less the lag."""
    apart = errors.strides[0] - lag * errors.itemsize
    shape = (2, errors.shape[1], length - lag)
    return as_strided(errors.reshape(-1)[lag:], shape, (apart, *errors.strides[1:]), writeable=False)


def _filter(rows: Rows, errors: Floats, k: Floats, lag: int) -> None:
    """f(t) ← f(t) + k b(t − 1) and b(t) ← b(t − 1) + k f(t).

    f(t) stays at t, and b(t) is kept at t − lag: so both keep their places while the lag grows. All rows are
    taken as one, which is faster; what crosses from row to row comes to places that are not looked at again.
    """
    scratch = rows.once("scratch", lambda: np.empty(errors.shape))
    rows.do(np.multiply, errors, k, scratch)
    f, b = errors.reshape(2, -1)
    for_b, for_f = scratch.reshape(2, -1)
    rows.do(np.add, f[lag:], for_f[:-lag], f[lag:])
    rows.do(np.add, b[:-lag], for_b[lag:], b[:-lag])


def _reflect(rows: Rows, found: Floats, number: int) -> None:
    """Coefficients 0 … number − 1 of one order more, by the reflection at `number`."""
    if number:
        before = found[:number]
        change = np.empty(before.shape)
        rows.do(np.multiply, before[::-1], found[number], change)
        rows.do(np.add, before, change, before)


def autocorr(rows: Rows, order: int) -> Floats:
    """The autocorrelation method: Toeplitz(r_0 … r_{p−1}) a = −(r_1 … r_p), by Levinson and Durbin."""
    found, length = np.empty((order, *rows.shape)), rows.length
    r = np.empty((order + 1, *rows.shape))
    for lag in range(order + 1):
        rows.do(np.vecdot, rows.x[..., lag:], rows.x[..., : length - lag], r[lag])
    left, across, change = np.empty((3, *rows.shape))
    rows.do(np.subtract, -TINY, r[0], left)
    for number, k in enumerate(found):
        rows.do(np.copyto, across, r[number + 1])
        for lag in range(number):
            rows.do(np.multiply, found[lag], r[number - lag], change)
            rows.do(np.add, across, change, across)
        rows.do(np.divide, across, left, k)
        _reflect(rows, found, number)
        rows.do(np.multiply, across, k, change)
        rows.do(np.subtract, left, change, left)
    return found


def cepstrum(rows: Rows, a: Floats) -> Floats:
    """c_n = −a_n − Σ_{l<n} (1 − l/n) a_l c_{n−l}: thesis (3.6), (3.7); the cepstrum of 1/A(z) without c_0.

    Shape as of `a`: (p, windows, channels, segments).
    """
    c, change = np.empty(a.shape), np.empty(rows.shape)
    for n in range(1, len(a) + 1):
        rows.do(np.negative, a[n - 1], c[n - 1])
        for lag in range(1, n):
            rows.do(np.multiply, a[lag - 1], c[n - lag - 1], change)
            rows.do(np.multiply, change, 1 - lag / n, change)
            rows.do(np.subtract, c[n - 1], change, c[n - 1])
    return c
