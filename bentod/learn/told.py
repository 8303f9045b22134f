"""What people and clients are told of general value functions: in every tick, and when they ask."""

import math
from collections.abc import Collection, Iterator, Sequence
from dataclasses import asdict

import numpy as np
from numpy.typing import NDArray

from bentod.frames import LearnFrame, Value
from bentod.learn.horde import Horde, plain
from bentod.learn.unit import Unit

_DIGITS = 4
"""Decimals, or significant figures of what has a unit: more says nothing, and fills recordings."""


class Teller:
    """Tells of a horde. `apart`: questions whose predictions are told elsewhere, with the joints."""

    def __init__(self, horde: Horde, apart: Collection[str]) -> None:
        self._horde = horde
        self._own = np.array(
            [place for place, name in enumerate(horde.answers.names) if name not in apart], dtype=np.intp
        )
        self._described: tuple[int, list[dict[str, Value]]] | None = None
        self._own_names = [horde.answers.names[place] for place in self._own.tolist()]

    def frame(self) -> LearnFrame:
        """Of the newest tick."""
        answers = self._horde.answers
        return LearnFrame(
            predictions=_known(self._own_names, answers.value[self._own]),
            older=answers.older(),
            confidence=_known(answers.names, np.round(answers.confidence, _DIGITS)),
            surprise=_known(answers.names, np.round(answers.surprise, _DIGITS)),
            error=_known(answers.names, _rounded(answers.error)),
            familiarity=self._familiarity(),
        )

    def describe(self) -> list[dict[str, Value]]:
        """Every question and how it stands, in the order in which they were asked; not to be changed.

        It is put together once a tick, however many ask.
        """
        tick = self._horde.answers.tick
        if self._described is None or self._described[0] != tick:
            told = {place: entry for unit in self._horde.units for place, entry in self._unit(unit)}
            self._described = tick, [told[place] for place in sorted(told)]
        return self._described[1]

    def _unit(self, unit: Unit) -> Iterator[tuple[int, dict[str, Value]]]:
        answers, bounds = self._horde.answers, unit.doubts.interval
        columns: dict[str, NDArray[np.float64] | None] = {
            "prediction": answers.value[unit.places],
            "confidence": answers.confidence[unit.places],
            "surprise": answers.surprise[unit.places],
            "error": answers.error[unit.places],
            "normalised_error": unit.doubts.normalised_error,
            "lowest": bounds[0] if bounds else None,
            "highest": bounds[1] if bounds else None,
            "resets": unit.pupils.resets.astype(np.float64),
        }
        known = {key: column.tolist() for key, column in columns.items() if column is not None}
        for column, place in enumerate(unit.places.tolist()):
            question = self._horde.questions[place]
            numbers = {key: _number(values[column]) for key, values in known.items()}
            yield place, plain(question) | numbers | {"visits": self._visits(question.representation)}

    def _visits(self, representation: str) -> dict[str, Value]:
        """What is known of the state that the arm is in; empty where nobody counts."""
        visit = self._horde.encoders[representation].visit
        told = asdict(visit) if visit else {}
        return {key: _number(float(value)) for key, value in told.items()}

    def _familiarity(self) -> dict[str, float]:
        visits = {name: encoder.visit for name, encoder in self._horde.encoders.items()}
        return {name: round(visit.familiarity, _DIGITS) for name, visit in visits.items() if visit}


def _rounded(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """To `_DIGITS` significant figures."""
    size = np.where(np.isfinite(values) & (values != 0), np.abs(values), 1)
    scale = 10 ** (_DIGITS - 1 - np.floor(np.log10(size)))
    rounded: NDArray[np.float64] = np.round(values * scale) / scale
    return rounded


def _known(names: Sequence[str], values: NDArray[np.float64]) -> dict[str, float]:
    return {name: value for name, value in zip(names, values.tolist(), strict=True) if math.isfinite(value)}


def _number(value: float) -> Value:
    return value if math.isfinite(value) else None
