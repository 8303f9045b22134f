"""In which way what is asked here is something else than what a snapshot answers."""

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from bentod.frames import Value

MOST = 12
"""Differences that are told one by one."""

_LABELS = {"lam": "λ", "gamma": "γ", "rho": "ρ", "step_size": "step size", "scaled": "scaling by 1 − γ"}

_LONGEST = 80  # characters of a value

_NOTHING = "nothing"


@dataclass(frozen=True, slots=True)
class Sides:
    """How sentences call the two that are compared."""

    one: str = "here"
    other: str = "in the snapshot"

    def told(self, label: str, one: Value, other: Value) -> str:
        """What a value is on both sides."""
        return f"{label} {_shown(one)} {self.one}, {_shown(other)} {self.other}"


def differences(mine: Mapping[str, Value], theirs: Mapping[str, Value], sides: Sides = Sides()) -> list[str]:
    """What differs, questions before all else; nothing: the answers to one are answers to the other.

    `mine` is what `Keepable.spec` says here, `theirs` that of a snapshot. Tables that have names are compared
    by name, whether they stand in a list or in a map; in a list their order counts too.
    """
    here, there = _plain(mine), _plain(theirs)
    keys = dict.fromkeys(("questions", "representations", *here, *there))
    found = [text for key in keys for text in _table(key, here.get(key), there.get(key), sides)]
    if (more := len(found) - MOST) > 1:
        return [*found[:MOST], f"and {more} differences more"]
    return found


def _plain(spec: Mapping[str, Value]) -> dict[str, Value]:
    """As a file would give it back: tuples are lists then."""
    plain: dict[str, Value] = json.loads(json.dumps(dict(spec)))
    return plain


def _table(key: str, mine: Value, theirs: Value, sides: Sides) -> Iterator[str]:
    here, there = by_name(mine), by_name(theirs)
    if here is None or there is None:
        yield from (sides.told(f"{way}:", *values) for way, *values in _leaves(_label(key), mine, theirs))
        return
    kind = key.removesuffix("s").replace("_", " ")
    yield from (f"the {kind} {name} is only {sides.one}" for name in here if name not in there)
    yield from (f"the {kind} {name} is only {sides.other}" for name in there if name not in here)
    says = "the question {} is asked with" if kind == "question" else f"{kind} {{}}:"
    for name in here:
        for way, one, other in _leaves("", here[name], there.get(name, here[name])):
            yield sides.told(f"{says.format(name)} {way}", one, other)
    if isinstance(mine, list):
        both = [name for name in here if name in there], [name for name in there if name in here]
        yield from _order(kind, *both, sides)


def by_name(tables: Value) -> dict[str, Value] | None:
    """Tables by their names; None if that is not what they are. Nothing has no names, but could have had."""
    if tables is None:
        return {}
    if isinstance(tables, dict):
        return tables if tables and all(isinstance(table, dict) for table in tables.values()) else None
    if not isinstance(tables, list) or not tables:
        return None
    named: dict[str, Value] = {
        name: table
        for table in tables
        if isinstance(table, dict) and isinstance(name := table.get("name"), str)
    }
    return named if len(named) == len(tables) else None


def _order(kind: str, mine: Sequence[str], theirs: Sequence[str], sides: Sides) -> Iterator[str]:
    for one, other in zip(mine, theirs, strict=True):
        if one != other:
            yield f"the {kind} {one} stands {sides.one} where {other} stands {sides.other}"
            return


def _leaves(label: str, mine: Value, theirs: Value) -> Iterator[tuple[str, Value, Value]]:
    """Differing values, each with the way to it."""
    if isinstance(mine, dict) and isinstance(theirs, dict):
        for key in dict.fromkeys((*mine, *theirs)):
            yield from _leaves(_under(label, _label(key)), mine.get(key), theirs.get(key))
    elif isinstance(mine, list) and isinstance(theirs, list) and len(mine) == len(theirs):
        for place, (one, other) in enumerate(zip(mine, theirs, strict=True)):
            yield from _leaves(_under(label, str(place)), one, other)
    elif not _same(mine, theirs):
        yield label, mine, theirs


def _same(mine: Value, theirs: Value) -> bool:
    return mine == theirs or (mine != mine and theirs != theirs)  # two that are no numbers


def _under(label: str, key: str) -> str:
    return f"{label}.{key}" if label else key


def _label(key: str) -> str:
    return _LABELS.get(key, key.replace("_", " "))


def _shown(value: Value) -> str:
    text = _NOTHING if value is None else value if isinstance(value, str) and value else json.dumps(value)
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 1]}…"
