"""Who knows what of old: memories of units handed on to units that ask other questions besides."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from bentod.learn.paths import below
from bentod.learn.unit import Unit

Memory = Mapping[str, NDArray[np.float64]]
T = TypeVar("T")


def succeed(
    unit: Unit, names: Sequence[str], elders: Sequence[tuple[Sequence[str], Unit]], known: frozenset[str]
) -> None:
    """Let `unit`, which answers the questions `names`, go on where one of `elders` is, to the last bit.

    `elders`: with the questions that each answers; they are used up. `known`: questions that mean the same
    to both. The others begin anew.
    """
    if not (found := _closest(names, elders, known)):
        return
    elder, mine, theirs = found
    unit.pupils.go_on(elder.pupils, mine, theirs)
    own, fresh, memory = unit.own(), unit.beside(), elder.beside()
    unit.recall_beside({key: _merged(key, fresh, memory, key in own, mine, theirs) for key in fresh})


@dataclass(frozen=True, slots=True)
class Heritage:
    """What units knew: of each, the questions that it answered, by name, and its memory."""

    units: Sequence[tuple[Sequence[str], Memory]]

    @classmethod
    def of(cls, names: Sequence[Sequence[str]], memory: Memory) -> "Heritage":
        """Units with questions of these `names`, out of the joint memory of all."""
        return cls([(asked, below(memory, str(place))) for place, asked in enumerate(names)])

    def hand_on(self, unit: Unit, names: Sequence[str], known: frozenset[str]) -> list[str]:
        """Let `unit`, which answers the questions `names`, go on where its ancestors were.

        `known`: questions that mean the same now as then. Returns those that nobody knew, which begin anew.

        Raises:
            ValueError: this is not the memory of such units; `unit` may know some of it now.
        """
        if not (found := _closest(names, self.units, known)):
            return list(names)
        memory, mine, theirs = found
        own = unit.own()
        fresh = unit.memory()
        unit.recall({key: _merged(key, fresh, memory, key in own, mine, theirs) for key in fresh})
        others = [place for place in range(len(names)) if place not in mine]
        if others:
            unit.reset(others)
        return [names[place] for place in others]


def _closest(
    names: Sequence[str], units: Sequence[tuple[Sequence[str], T]], known: frozenset[str]
) -> tuple[T, list[int], list[int]] | None:
    """The unit that answered most of `names`, and the places here and there of those that it answered."""
    wanted = known.intersection(names)
    if not wanted or not units:
        return None
    asked, unit = max(units, key=lambda it: len(wanted.intersection(it[0])))
    places = {name: place for place, name in enumerate(asked)}
    mine = [place for place, name in enumerate(names) if name in wanted and name in places]
    return (unit, mine, [places[names[place]] for place in mine]) if mine else None


def _merged(
    key: str, fresh: Memory, memory: Memory, own: bool, mine: Sequence[int], theirs: Sequence[int]
) -> NDArray[np.float64]:
    """One array: shared ones as they were, and of those with a column for each question the known columns."""
    if key not in memory:
        if own:
            raise ValueError(f"The memory lacks {key}.")
        return fresh[key]
    if not own:
        return memory[key]
    merged, told = fresh[key].copy(), memory[key]
    if told.ndim != merged.ndim or told.shape[:-1] != merged.shape[:-1]:
        raise ValueError(
            f"{key} has the shape {told.shape}, but should have {merged.shape[:-1]} and its GVFs."
        )
    merged[..., list(mine)] = told[..., list(theirs)]
    return merged
