import math

import numpy as np
import pytest
from hypothesis import given, settings
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
    "broken", [(0, 1, 1.0, 1), (1, 0, 1.0, 1), (1, 1, 0.0, 1), (1, 1, 2.0, 1), (1, 1, 1.0, -1)]
)
def test_an_impossible_tiling_is_refused(broken: tuple[int, int, float, int]) -> None:
    with pytest.raises(ValueError, match="at least 1 dimension"):
        TileCoder(*broken)


@pytest.mark.parametrize(("dimensions", "features"), [(1, 51), (2, 321)])
def test_exact_tilings_have_as_many_features_as_those_of_the_thesis(dimensions: int, features: int) -> None:
    wide, narrow = (TileCoder(dimensions, n, width, memory=0) for n, width in ((3, 0.5), (6, 0.17)))
    assert wide.size + narrow.size == features


shapes = st.integers(1, 3).flatmap(
    lambda dimensions: st.tuples(
        st.just(dimensions),
        st.integers(1, 20),
        st.lists(
            st.sampled_from([1.0, 0.9, 0.5, 0.3, 1 / 3, 0.17, 0.1]), min_size=dimensions, max_size=dimensions
        ),
        st.lists(st.lists(anywhere, min_size=dimensions, max_size=dimensions), min_size=2, max_size=2),
    )
)


@settings(max_examples=50)
@given(shapes)
def test_an_exact_tile_is_known_by_its_tiling_and_its_place(
    shape: tuple[int, int, list[float], list[list[float]]],
) -> None:
    """Two points share a feature of a tiling if, and only if, they lie between the same edges of it."""
    dimensions, tilings, widths, points = shape
    coder = TileCoder(dimensions, tilings, widths, memory=0)
    one, other = (coder.encode(point) for point in points)
    per_tiling = coder.size // tilings
    for found in (one, other):
        assert (found // per_tiling).tolist() == list(range(tilings))
    for i in range(tilings):
        same = all(
            place(a, i, d, tilings, width) == place(b, i, d, tilings, width)
            for a, b, d, width in zip(*points, displacements(dimensions, tilings), widths, strict=True)
        )
        assert (one[i] == other[i]) == same


def place(x: float, i: int, displacement: int, tilings: int, width: float) -> int:
    """Of the tile of tiling i that x lies in, along one dimension."""
    last = math.ceil(tilings / width - 1e-9) - 1
    finest = min(int(min(max(x, 0.0), 1.0) * (tilings / width)), last)
    return (finest + i * displacement % tilings) // tilings


@pytest.mark.parametrize("memory", [0, 2048])
@settings(max_examples=40)
@given(st.floats(0, 1), st.floats(0, 1))
def test_neighbours_share_all_tiles_but_those_whose_edge_is_between_them(
    memory: int, x: float, y: float
) -> None:
    coder = TileCoder(2, tilings=16, memory=memory)
    near = [min(x + 1 / 32, 1.0), y]
    assert len(np.intersect1d(coder.encode([x, y]), coder.encode(near))) >= len(coder.encode([x, y])) - 1


def test_a_dimension_of_narrower_tiles_is_told_apart_more_finely() -> None:
    coder = TileCoder(2, tilings=10, width=[1.0, 0.1], memory=0)
    assert coder.size == 10 * 2 * 11
    assert shared(coder, [0.55, 0.55], [0.65, 0.55]) == 9
    assert shared(coder, [0.55, 0.55], [0.55, 0.65]) == 0


def test_several_points_are_encoded_as_each_of_them_alone() -> None:
    coder = TileCoder(3, tilings=12, width=[0.3, 1.0, 0.5])
    points = np.random.default_rng(5).random((7, 3))
    for found, point in zip(coder.indices(points), points.tolist(), strict=True):
        assert np.unique(found).tolist() == coder.encode(point).tolist()


def test_widths_that_do_not_fit_the_dimensions_are_refused() -> None:
    with pytest.raises(ValueError, match="3 dimensions need as many widths of a tile, not 2"):
        TileCoder(3, width=[0.5, 0.5])


def test_more_exact_tiles_than_any_memory_holds_are_refused() -> None:
    with pytest.raises(ValueError, match="more than 16777216 features: give them memory"):
        TileCoder(9, tilings=8, width=0.1, memory=0)
