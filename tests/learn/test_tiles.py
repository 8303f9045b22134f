import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bentod.learn.tiles import TileCoder

MASK = 2**64 - 1
anywhere = st.floats(-0.5, 1.5)


def mix(z: int) -> int:
    z = ((z ^ (z >> 30)) * 0xBF58476D1CE4E5B9) & MASK
    z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & MASK
    return z ^ (z >> 31)


def displacements(dimensions: int, tilings: int) -> list[int]:
    found: list[int] = []
    candidate = 1
    while len(found) < dimensions:
        if math.gcd(candidate, tilings) == 1:
            found.append(candidate)
        candidate += 2
    return found


def slow_tiles(inputs: list[float], tilings: int, width: float, memory: int) -> list[int]:
    """The module docstring, one tiling and one dimension at a time, in whole numbers of any size."""
    keys = [mix(((m + 1) * 0x9E3779B97F4A7C15) & MASK) | 1 for m in range(len(inputs) + 1)]
    features = set()
    for i in range(tilings):
        total = i * keys[0]
        for x, shift, key in zip(inputs, displacements(len(inputs), tilings), keys[1:], strict=True):
            clamped = min(max(x, 0.0), 1.0)
            finest = min(int(clamped * (tilings / width)), math.ceil(tilings / width - 1e-9) - 1)
            total += (finest + i * shift) // tilings * key
        features.add(mix(total & MASK) % memory)
    return sorted(features)


@given(
    st.lists(anywhere, min_size=1, max_size=6),
    st.integers(1, 130),
    st.sampled_from([1.0, 0.5, 0.3, 0.07]),
    st.sampled_from([1, 50, 2048, 100_003]),
)
def test_it_agrees_with_a_slow_version_in_plain_python(
    inputs: list[float], tilings: int, width: float, memory: int
) -> None:
    coder = TileCoder(len(inputs), tilings, width, memory)
    assert coder.encode(inputs).tolist() == slow_tiles(inputs, tilings, width, memory)


@given(st.lists(anywhere, min_size=4, max_size=4))
def test_active_features_are_unique_ascending_and_within_memory(inputs: list[float]) -> None:
    features = TileCoder(4).encode(inputs)
    assert (np.diff(features) > 0).all()
    assert features.dtype == np.intp
    assert 0 < len(features) <= 100
    assert 0 <= features[0] <= features[-1] < 2048


def test_the_hash_never_changes_because_saved_weights_depend_on_it() -> None:
    assert TileCoder(2, tilings=8, memory=2048).encode([0.25, 0.75]).tolist() == [
        0,
        307,
        332,
        438,
        640,
        1102,
        1178,
        1784,
    ]


@given(st.floats(0, 1, exclude_max=True), st.sampled_from([1.0, 0.5, 0.3, 0.7]))
def test_exactly_1_lies_in_the_tiles_of_the_values_just_below(y: float, width: float) -> None:
    coder = TileCoder(2, tilings=21, width=width)
    just_below = 1 - 1e-9
    assert coder.encode([1.0, y]).tolist() == coder.encode([just_below, y]).tolist()


@pytest.mark.parametrize(("outside", "edge"), [(-0.2, 0.0), (-1e300, 0.0), (1.3, 1.0), (1e300, 1.0)])
def test_values_outside_are_clamped_not_wrapped(outside: float, edge: float) -> None:
    coder = TileCoder(2)
    assert coder.encode([outside, 0.4]).tolist() == coder.encode([edge, 0.4]).tolist()


@pytest.mark.parametrize("value", [float("nan"), float("inf"), float("-inf")])
def test_values_that_are_not_finite_are_refused(value: float) -> None:
    with pytest.raises(ValueError, match="takes 2 finite numbers"):
        TileCoder(2).encode([0.5, value])


def test_the_wrong_number_of_values_is_refused() -> None:
    with pytest.raises(ValueError, match="takes 2 finite numbers"):
        TileCoder(2).encode([0.5])


def shared(coder: TileCoder, one: list[float], other: list[float]) -> int:
    return len(np.intersect1d(coder.encode(one), coder.encode(other)))


@pytest.mark.parametrize("dimension", range(4))
def test_every_hundredth_of_the_range_changes_one_tile_of_a_hundred(dimension: int) -> None:
    coder = TileCoder(4, tilings=100, memory=2**40)
    middle = [0.505, 0.405, 0.305, 0.605]
    for hundredths in range(1, 30):
        moved = middle.copy()
        moved[dimension] += hundredths / 100
        assert shared(coder, middle, moved) == 100 - hundredths


def test_displacements_are_not_the_same_along_all_dimensions() -> None:
    """Equal displacements would generalise along the diagonal: (−, +) would share far less than (+, +)."""
    coder = TileCoder(2, tilings=100, memory=2**40)
    along = shared(coder, [0.5, 0.5], [0.7, 0.7])
    across = shared(coder, [0.5, 0.5], [0.7, 0.3])
    assert abs(along - across) < 15


def test_two_tiles_on_one_feature_count_once() -> None:
    rng = np.random.default_rng(3)
    coder = TileCoder(4, tilings=100, memory=2048)
    active = [len(coder.encode(point)) for point in rng.random((2000, 4)).tolist()]
    expected = 2048 * (1 - (1 - 1 / 2048) ** 100)
    assert np.mean(active) == pytest.approx(expected, abs=0.3)
    assert min(active) < 97 < max(active)
    assert TileCoder(4, tilings=100, memory=1).encode([0.1, 0.2, 0.3, 0.4]).tolist() == [0]


def test_the_hash_spreads_tiles_evenly_over_memory() -> None:
    coder = TileCoder(4, tilings=64, width=0.1, memory=64)
    rng = np.random.default_rng(3)
    uses = np.zeros(64)
    for point in rng.random((4000, 4)).tolist():
        uses[coder.encode(point)] += 1
    assert uses.std() / uses.mean() < 0.05


@pytest.mark.parametrize(
    "broken", [(0, 1, 1.0, 1), (1, 0, 1.0, 1), (1, 1, 0.0, 1), (1, 1, 2.0, 1), (1, 1, 1.0, 0)]
)
def test_an_impossible_tiling_is_refused(broken: tuple[int, int, float, int]) -> None:
    with pytest.raises(ValueError, match="at least 1 dimension"):
        TileCoder(*broken)
