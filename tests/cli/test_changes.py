"""What `--set` may say."""

import pytest

from bentod.cli.changes import grid, single
from bentod.errors import ConfigError
from bentod.frames import Value


def test_one_value_a_key_is_what_a_person_means_by_it() -> None:
    assert single(["learn.step_size=0.1", "assist.mode=off", "learn.timescales=[10, 20]", "a.b=x=y"]) == {
        "learn.step_size": 0.1,
        "assist.mode": False,
        "learn.timescales": [10, 20],
        "a.b": "x=y",
    }


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("0.05,0.1,0.3", [0.05, 0.1, 0.3]),
        ("td,true_online", ["td", "true_online"]),
        ("[10,20],[10,30]", [[10, 20], [10, 30]]),
        ("on,off", [True, False]),
        ("7", [7]),
    ],
)
def test_several_values_stand_between_commas(text: str, values: list[Value]) -> None:
    assert grid([f"a.b={text}", "a.c=1"]) == {"a.b": values, "a.c": [1]}


@pytest.mark.parametrize("word", ["learn.step_size", "step_size=0.1", "learn.step_size=", ""])
def test_a_word_of_another_form_is_refused(word: str) -> None:
    with pytest.raises(ConfigError, match=r"write TABLE\.KEY=VALUE"):
        single([word])
    with pytest.raises(ConfigError, match=r"write TABLE\.KEY=VALUE"):
        grid([word])


def test_a_key_that_stands_twice_is_refused() -> None:
    with pytest.raises(ConfigError, match="stands twice"):
        grid(["a.b=1", "a.b=2"])
