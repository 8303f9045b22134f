import pytest
from hypothesis import given
from hypothesis import strategies as st

from bentod.errors import ConfigError
from bentod.learn.topology import layers


def test_each_layer_needs_only_what_is_below_it() -> None:
    needs = {"wrist": ["elbow", "hand"], "elbow": [], "hand": ["elbow"], "shoulder": []}
    assert layers(needs) == [("elbow", "shoulder"), ("hand",), ("wrist",)]


def test_without_questions_there_are_no_layers() -> None:
    assert layers({}) == []


@given(st.lists(st.sets(st.integers(0, 11)), max_size=12))
def test_any_order_without_circles_is_followed(wanted: list[set[int]]) -> None:
    needs = {str(i): [str(j) for j in sorted(below) if j < i] for i, below in enumerate(wanted)}
    found = layers(needs)
    assert sorted(name for layer in found for name in layer) == sorted(needs)
    depth = {name: level for level, layer in enumerate(found) for name in layer}
    for name, below in needs.items():
        assert depth[name] == max((depth[other] + 1 for other in below), default=0)


@pytest.mark.parametrize(
    ("needs", "path"),
    [
        ({"a": ["a"]}, "a -> a"),
        ({"a": ["b"], "b": ["a"]}, "a -> b -> a"),
        ({"x": ["a"], "a": ["free", "b"], "b": ["c"], "c": ["a"], "free": []}, "a -> b -> c -> a"),
    ],
)
def test_a_circle_is_refused_by_the_names_in_it(needs: dict[str, list[str]], path: str) -> None:
    with pytest.raises(ConfigError, match=f"circle: {path}$"):
        layers(needs)


def test_a_name_that_nobody_has_is_refused_with_the_nearest() -> None:
    with pytest.raises(ConfigError, match=r"'b' is made from 'elbw', .*did you mean 'elbow'"):
        layers({"elbow": [], "b": ["elbw"]})


def test_a_long_chain_takes_a_layer_for_each_of_its_links() -> None:
    needs = {str(i): [str(i - 1)] if i else [] for i in range(4096)}
    assert len(layers(needs)) == 4096
