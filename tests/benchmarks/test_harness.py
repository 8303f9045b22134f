import json
from pathlib import Path

import pytest

from tests.benchmarks.harness import Row, at_least, at_most, interleave, main, medians


@pytest.mark.parametrize(("value", "holds"), [(1.9, True), (2.0, True), (2.1, False)])
def test_a_bound_from_above_holds_up_to_the_bound(value: float, holds: bool) -> None:
    assert at_most("tick", value, "ms", 2) == Row("tick", value, "ms", "<= 2", holds)


@pytest.mark.parametrize(("value", "holds"), [(59.0, False), (60.0, True)])
def test_a_bound_from_below_holds_from_the_bound_on(value: float, holds: bool) -> None:
    assert at_least("learned", value, "%", 60) == Row("learned", value, "%", ">= 60", holds)


def test_rounds_are_interleaved_and_none_is_always_first() -> None:
    order: list[str] = []

    def measure(name: str) -> float:
        order.append(name)
        return float(len(order))

    values = interleave({"a": lambda: measure("a"), "b": lambda: measure("b")}, rounds=3)
    assert order == ["a", "b", "b", "a", "a", "b"]
    assert values == {"a": [1.0, 4.0, 5.0], "b": [2.0, 3.0, 6.0]}


def test_one_disturbed_round_does_not_move_the_median() -> None:
    seen = iter([5.0, 5.0, 900.0, 5.0, 5.0])
    assert medians({"a": lambda: next(seen)}, rounds=5) == {"a": 5.0}


def test_the_report_is_a_table_and_a_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rows = [at_most("tick", 1.25, "ms", 2), at_most("minute", 4.0, "s", 3), Row("toggles", 7, "")]
    main("core", rows, tmp_path / "bench")
    lines = capsys.readouterr().out.splitlines()
    assert lines[1].split() == ["tick", "1.25", "ms", "<=", "2", "holds"]
    assert lines[2].endswith("DOES NOT HOLD")
    assert lines[3].split() == ["toggles", "7"]
    written = json.loads((tmp_path / "bench" / "core.json").read_text())
    assert written[1] == {"name": "minute", "value": 4.0, "unit": "s", "target": "<= 3", "holds": False}
    assert written[2]["holds"] is None
