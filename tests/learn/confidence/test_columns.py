from collections.abc import Callable, Iterator

import numpy as np
import pytest

from bentod.learn.confidence.columns import Columns
from bentod.learn.confidence.guard import Guard
from bentod.learn.confidence.interval import Interval
from bentod.learn.confidence.real_valued import RealUncertainty
from bentod.learn.confidence.surprise import Surprise
from bentod.learn.confidence.uncertainty import Uncertainty
from bentod.learn.confidence.verify import ReturnError
from tests.learn.confidence.oracles import Vector

SIZE = 9
HERE = np.array([0, 3, 4])
Step = Callable[[Vector], object]


def surprise(count: int) -> tuple[Columns, Step]:
    it = Surprise(count)
    return it, it.step


def uncertainty(count: int) -> tuple[Columns, Step]:
    it = Uncertainty(SIZE, np.full(count, np.nan))
    return it, lambda values: it.step(HERE, values, HERE, values)


def real_uncertainty(count: int) -> tuple[Columns, Step]:
    it = RealUncertainty(SIZE, np.full(count, np.nan))
    phi = np.linspace(0, 1, SIZE)
    return it, lambda values: it.step(phi, values, phi, values)


def interval(count: int) -> tuple[Columns, Step]:
    it = Interval(SIZE, count, 4, every=2)
    return it, lambda values: it.step(HERE, lambda: np.tile(values, (SIZE, 1)))


def return_error(count: int) -> tuple[Columns, Step]:
    it = ReturnError(count, 6)
    return it, lambda values: it.step(values, values, 0.5)


def guard(count: int) -> tuple[Columns, Step]:
    it = Guard(np.zeros(count), 1.0)
    return it, lambda values: it.step(values, values / 2, 0.5)


ALL = [surprise, uncertainty, real_uncertainty, interval, return_error, guard]
each = pytest.mark.parametrize("make", ALL)
Make = Callable[[int], tuple[Columns, Step]]


def signals(count: int, steps: int = 40, seed: int = 0) -> Iterator[Vector]:
    return iter(np.random.default_rng(seed).normal(size=(steps, count)))


@each
def test_what_is_recalled_goes_on_bit_for_bit(make: Make) -> None:
    (old, step_old), (new, step_new) = make(3), make(3)
    for values in signals(3):
        step_old(values)
    new.recall(old.memory())
    for values in signals(3, seed=1):
        np.testing.assert_array_equal(np.array(step_new(values)), np.array(step_old(values)))
    assert all(
        np.array_equal(new.memory()[name], array, equal_nan=True) for name, array in old.memory().items()
    )


@each
def test_a_memory_is_a_copy(make: Make) -> None:
    it, step = make(2)
    for values in signals(2):
        step(values)
    kept = it.memory()
    frozen = {name: array.copy() for name, array in kept.items()}
    for values in signals(2, seed=1):
        step(values)
    other, step_other = make(2)
    other.recall(kept)
    for values in signals(2, seed=2):
        step_other(values)
    assert all(np.array_equal(kept[name], array, equal_nan=True) for name, array in frozen.items())
    assert all(array.dtype == np.float64 and "/" not in name for name, array in kept.items())


@each
def test_those_that_stay_do_not_notice_that_others_come_and_go(make: Make) -> None:
    (changing, step_changing), (alone, step_alone) = make(3), make(1)
    for t, values in enumerate(signals(4, steps=60)):
        if t == 20:
            changing.take(np.array([2]))
        if t == 30:
            changing.grow(2)
        ours = values[1:] if t < 20 else values[3:] if t < 30 else values[[3, 0, 1]]
        got, expected = np.array(step_changing(ours)), np.array(step_alone(values[3:]))
        np.testing.assert_allclose(got[..., 2 if t < 20 else 0], expected[..., 0], rtol=0, atol=1e-12)
    assert changing.count == 3
    assert alone.count == 1


@each
def test_who_joins_later_starts_from_nothing(make: Make) -> None:
    it, step = make(1)
    for values in signals(1, steps=24):
        step(values)
    it.grow(1)
    _, step_fresh = make(2)
    for values in signals(2, steps=24, seed=3):
        got, expected = np.array(step(values)), np.array(step_fresh(values))
        np.testing.assert_allclose(got[..., 1], expected[..., 1], rtol=0, atol=1e-12)


@each
def test_a_memory_of_another_is_refused_and_nothing_changes(make: Make) -> None:
    it, step = make(2)
    for values in signals(2):
        step(values)
    before = it.memory()
    with pytest.raises(ValueError, match="has the shape"):
        it.recall(make(3)[0].memory())
    with pytest.raises(ValueError, match="remembers"):
        it.recall(before | {"something": np.zeros(2)})
    after = it.memory()
    assert all(np.array_equal(after[name], array, equal_nan=True) for name, array in before.items())
