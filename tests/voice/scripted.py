"""What must be heard of literal frames and events; the voice and the page are held to the same."""

import json
from dataclasses import dataclass
from pathlib import Path

from tests.rig import Table, table

FILE = Path(__file__).parent / "cases.json"


@dataclass(frozen=True, slots=True)
class Step:
    """Something that happens, what is due then, and what is selected."""

    time: float  # s
    what: str  # "frame", "event", "lost", or "wait" for nothing
    value: Table
    due: list[str]
    selected: str


@dataclass(frozen=True, slots=True)
class Case:
    """A sentence, and the steps that show it."""

    name: str
    steps: tuple[Step, ...]


def cases() -> list[Case]:
    """Those of the file. A frame is the one before it with changes, the first one `start` with some."""
    whole = json.loads(FILE.read_text(encoding="utf-8"))
    return [
        Case(case["name"], tuple(_steps(table(whole["start"]), case["steps"]))) for case in whole["cases"]
    ]


def _steps(frame: Table, steps: list[list[object]]) -> list[Step]:
    found = []
    for time, what, value, due, selected in steps:
        if what == "frame":
            frame = {**frame, **(value if isinstance(value, dict) else {})}
        given = frame if what == "frame" else value
        assert isinstance(time, int | float)
        assert isinstance(due, list)
        found.append(Step(time, str(what), given if isinstance(given, dict) else {}, due, str(selected)))
    return found
