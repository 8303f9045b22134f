"""Questions that assists need answered: asked of the learners for as long as somebody helps with them."""

from collections.abc import Mapping, Sequence

from pydantic import ValidationError

from bentod.assist.help import Help
from bentod.config_errors import explain
from bentod.config_learn import Gvf
from bentod.errors import BadRequest
from bentod.frames import Value
from bentod.learn.predictor import Predictor

MOST_ENTRIES = 256
"""Of a table that somebody sends: each may be wrong, and be told of at length, while a tick waits."""

LONGEST_ERROR = 2000  # characters


def gvf_of(table: Value) -> Gvf:
    """What a table like those of `learn.gvfs` says. Raises BadRequest: it is not such a table."""
    parts = [table, *table.values()] if isinstance(table, dict) else [table]
    if (entries := sum(len(part) for part in parts if isinstance(part, dict | list))) > MOST_ENTRIES:
        raise BadRequest(f"gvf: {entries} entries are more than {MOST_ENTRIES}", "gvf")
    try:
        return Gvf.model_validate(table)
    except ValidationError as error:
        raise BadRequest("; ".join(explain(error, Gvf, ("gvf",)))[:LONGEST_ERROR], "gvf") from error


class Inquiry:
    """What the assists of all groups have asked so far. What was learned of it stays when they change."""

    def __init__(self, predictor: Predictor | None) -> None:
        self._predictor = predictor
        self._asked: dict[str, Mapping[str, Value]] = {}
        self._needed: dict[str, tuple[str, ...]] = {}

    def needed(self, group: str) -> tuple[str, ...]:
        """Names of the questions that the assist of a group looks at now."""
        return self._needed.get(group, ())

    def ask(self, help_: Help, joints: Sequence[str]) -> None:
        """Have asked what the assist of a group needs, unless it is; somebody's own of that name will do.

        Raises:
            BadRequest: it cannot be asked, e.g. as nothing is learned from the joints; nothing has changed.
        """
        tables = {str(table["name"]): table for table in help_.asks(joints)}
        if self._predictor is not None:
            asked = {question.name for question in self._predictor.horde.questions}
            mine = {name for name in self._asked.keys() & asked if name in tables}
            old = [name for name in mine if self._asked[name] != tables[name]]
            new = [name for name in tables if name in old or name not in asked]
            gvfs = [gvf_of(dict(tables[name])) for name in new]
            if old:
                self._predictor.remove(sorted(old))
            if gvfs:
                self._predictor.add(*gvfs)
            self._asked |= {name: tables[name] for name in new}
        self._needed[help_.group] = tuple(tables)
