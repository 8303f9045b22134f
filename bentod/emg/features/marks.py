"""Counting of samples that something is true of, with all rows as the bits of a few large whole numbers.

A sign that is carried on until the next sample that has a sign looks as if it took a loop. It is the carry
of an addition: a bit that is set in both summands sends a carry off, one that is set in one of them passes it
on, and one that is set in none stops it.
"""

from collections.abc import Callable
from math import prod
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

Bits: TypeAlias = bytes
"""One bit a sample, the earliest lowest; rows begin with a byte."""

Join: TypeAlias = Callable[[Bits], Bits]
"""From the bits of all marks, one after another, to those to be counted."""


class Marks:
    """Which samples are counted, and the counts; `finish` when everything has been asked for."""

    def __init__(self, shape: tuple[int, ...], length: int) -> None:
        """`shape`: of rows with their samples, padded to whole bytes; `length`: without the padding."""
        self._shape = shape
        self._length = length
        self._tests: list[tuple[np.ufunc, NDArray[Any], float]] = []
        self._counts: list[tuple[Join, NDArray[np.float64]]] = []

    def mark(self, test: np.ufunc, values: NDArray[np.float64], bound: float) -> slice:
        """Have `test(values, bound)` made for each sample; where its bits are among all."""
        size = prod(self._shape) // 8
        self._tests.append((test, values, bound))
        return slice((len(self._tests) - 1) * size, len(self._tests) * size)

    def count(self, join: Join, out: NDArray[np.float64]) -> None:
        """Have the bits that `join` makes of all marks counted along the samples into `out`."""
        self._counts.append((join, out))

    def within(self, first: int, last: int) -> int:
        """Bits of the samples from `first` up to, not including, `last` of each row."""
        row = np.zeros(self._shape, np.bool_)
        row[..., max(first, 0) : max(min(last, self._length), 0)] = True
        return number(np.packbits(row, bitorder="little").tobytes())

    def finish(self, do: Callable[..., None]) -> None:
        """Have it `do` everything."""
        if not self._tests:
            return
        planes = np.zeros((len(self._tests), *self._shape), np.bool_)
        for plane, (test, values, bound) in zip(planes, self._tests, strict=True):
            do(test, values, bound, plane)
        *rows, samples = self._shape
        ones = np.empty((len(self._counts), *rows, samples // 8))
        counts = np.empty(ones.shape[:-1])
        do(self._pack, planes.reshape(-1), ones.reshape(-1))
        do(np.vecdot, ones, np.ones(samples // 8), counts)
        for found, (_, out) in zip(counts, self._counts, strict=True):
            do(np.copyto, out, found)

    def _pack(self, planes: NDArray[np.bool_], ones: NDArray[np.float64]) -> None:
        """Number of bits that are set, byte by byte."""
        packed = np.packbits(planes, None, "little").tobytes()
        joined = b"".join([join(packed) for join, _ in self._counts])
        np.bitwise_count(np.frombuffer(joined, np.uint8), ones)


def number(bits: Bits) -> int:
    """The bits as a whole number."""
    return int.from_bytes(bits, "little")


def only(mark: slice) -> Join:
    """The bits of one mark."""
    return lambda marks: marks[mark]


def both(one: slice, other: slice) -> Join:
    """Bits that two marks share."""
    size = one.stop - one.start
    return lambda marks: (number(marks[one]) & number(marks[other])).to_bytes(size, "little")


def masked(mark: slice, mask: int) -> Join:
    """Bits of one mark that are in `mask`, too."""
    size = mark.stop - mark.start
    return lambda marks: (number(marks[mark]) & mask).to_bytes(size, "little")


def crossings(below: slice, signed: slice, valid: int) -> Join:
    """Where a sign is another than the one before, of marks "negative" and "has a sign".

    `valid` has a bit for each sample, none for the padding, where every carry stops.
    """
    size = below.stop - below.start

    def join(marks: Bits) -> Bits:
        negative = number(marks[below])
        positive = number(marks[signed]) ^ negative
        down = negative & _carried(positive, valid ^ negative)
        up = positive & _carried(negative, valid ^ positive)
        return (down | up).to_bytes(size, "little")

    return join


def _carried(source: int, path: int) -> int:
    """Samples that something comes to from a `source` before, over samples of the `path` only."""
    return (source + path) ^ source ^ path
