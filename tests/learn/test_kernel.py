import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bentod.errors import ConfigError
from bentod.learn import kernel as kernel_module
from bentod.learn import lazy_compiled
from bentod.learn.group import Group
from bentod.learn.kernel import choose
from bentod.learn.lazy import Algorithm, Real
from bentod.learn.lazy_compiled import missing
from bentod.learn.lazy_numpy import NumpyKernel
from tests.learn.journeys import SIZE, algorithms, follow, new_group, random_journeys, seeds

compiled = pytest.mark.skipif(bool(missing()), reason=f"No compiled kernel here: {missing()}.")


def same(ours: Group, theirs: Group) -> None:
    """To the last bit, in all that a snapshot has."""
    mine, others = ours.memory(), theirs.memory()
    assert mine.keys() == others.keys()
    for name, array in mine.items():
        np.testing.assert_array_equal(array, others[name], strict=True)


@compiled
@settings(max_examples=50)
@given(seeds, algorithms, st.sampled_from([np.float64, np.float32]), st.lists(st.integers(1, 59), max_size=3))
def test_compiled_and_numpy_are_equal_to_the_bit(
    seed: int, algorithm: Algorithm, dtype: type[Real], stops: list[int]
) -> None:
    journeys = random_journeys(seed)
    ours, theirs = (new_group(journeys, algorithm, kernel, dtype) for kernel in (choose(), NumpyKernel()))
    stops = sorted(set(stops))
    for number, (first, end) in enumerate(zip([0, *stops], [*stops, 60], strict=True)):
        mine, others = follow(ours, journeys, first, end), follow(theirs, journeys, first, end)
        np.testing.assert_array_equal(mine.predictions, others.predictions)
        np.testing.assert_array_equal(mine.deltas, others.deltas)
        same(ours, theirs)
        if number % 2:
            # Each goes on from what the other knew.
            memory = ours.memory()
            ours.recall(theirs.memory())
            theirs.recall(memory)
        else:
            ours.cut()
            theirs.cut()


@compiled
@pytest.mark.parametrize("dtype", [np.float64, np.float32])
@pytest.mark.parametrize("gvfs", [1, 127, 129, 300])
def test_they_are_equal_however_many_gvfs_there_are(gvfs: int, dtype: type[Real]) -> None:
    journeys = random_journeys(11, gvfs=gvfs)
    ours, theirs = (new_group(journeys, "true_online", k, dtype) for k in (choose(), NumpyKernel()))
    np.testing.assert_array_equal(
        follow(ours, journeys).predictions, follow(theirs, journeys).predictions, strict=True
    )
    same(ours, theirs)


@compiled
def test_they_are_equal_when_gvfs_overflow() -> None:
    journeys = random_journeys(11, gvfs=5)
    journeys.rewards[20:30, 1] = 1.7e308
    journeys.rewards[25:, 3] *= 1e30
    ours, theirs = (new_group(journeys, "true_online", k, np.float32) for k in (choose(), NumpyKernel()))
    follow(ours, journeys)
    follow(theirs, journeys)
    assert ours.resets[1] > 0
    same(ours, theirs)


@compiled
def test_numpy_goes_on_in_the_very_state_that_the_compiled_kernel_left() -> None:
    journeys = random_journeys(3)
    group, other = (new_group(journeys, "true_online", choose(), np.float64) for _ in range(2))
    follow(group, journeys, end=30)
    follow(other, journeys, end=30)
    group._steps = NumpyKernel().bind(group._lazy)
    mine, theirs = follow(group, journeys, 30), follow(other, journeys, 30)
    np.testing.assert_array_equal(mine.predictions, theirs.predictions)
    same(group, other)


@compiled
def test_its_name_tells_the_compiler() -> None:
    assert choose("compiled").name.startswith("compiled (")
    assert choose("auto").name == choose("compiled").name


def test_numpy_is_always_there() -> None:
    assert choose("numpy").name == "numpy"


def test_without_a_library_auto_takes_numpy_and_compiled_says_how_to_get_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(kernel_module, "missing", lambda: "no compiled kernel was built")
    assert choose("auto").name == "numpy"
    with pytest.raises(ConfigError, match=r"no compiled kernel was built.*C compiler.*install bentod again"):
        choose("compiled")


@compiled
def test_a_library_of_another_source_is_not_used(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lazy_compiled, "SOURCE", lazy_compiled.SOURCE.with_name("lazy.py"))
    assert lazy_compiled.missing.__wrapped__() == "the compiled kernel is older than its source"


@compiled
def test_a_library_that_cannot_be_loaded_is_not_used(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lazy_compiled, "LIBRARY", lazy_compiled.SOURCE)
    lazy_compiled._library.cache_clear()
    try:
        assert "no compiled kernel was built" in lazy_compiled.missing.__wrapped__()
    finally:
        lazy_compiled._library.cache_clear()


def test_nothing_is_written_beyond_the_columns_of_a_group() -> None:
    journeys = random_journeys(4, gvfs=3)
    everything = np.full((SIZE, 9), 5.0)
    group = Group(everything[:, 2:5], journeys.initial, "true_online", 0.05, choose())
    follow(group, journeys)
    assert (everything[:, [0, 1, 5, 6, 7, 8]] == 5).all()
    assert not (everything[:, 2:5] == 5).any()
