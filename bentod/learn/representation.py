"""The state as learners see it: tile-coded inputs, inputs as they are, and a bias.

Features are in this order: those of each tile coding, with a region of its own, so that codings never collide
with one another; then raw inputs; then the bias, which is always 1.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from bentod.config_learn import ARM, Learn, RepresentationTable, Tiles
from bentod.contracts import Features, Vector
from bentod.errors import ConfigError
from bentod.frames import JointSpec, Value
from bentod.learn.expression import Expression, Vocabulary
from bentod.learn.expression_nodes import name_text
from bentod.learn.signals import Named, Signals, starred
from bentod.learn.tiles import LARGEST, TileCoder, unique

MOST_TILINGS = 16_384
"""Tilings that a representation may have in all: as many features are active."""


@dataclass(frozen=True, slots=True)
class Grids:
    """Tile codings of equal shape, which are encoded in one go."""

    coder: TileCoder
    columns: NDArray[np.intp]  # places of each coding's inputs, shape (codings, dimensions)
    offsets: NDArray[np.intp]  # of each coding's features, shape (codings, 1)


class StateCoding:
    """A representation as a table of the config describes it; stateless once built.

    `shapes`: codings in order, each a coder and the places of its inputs. `raw`: places of inputs that are
    features themselves, each with the greatest square that is expected of it.
    """

    def __init__(
        self,
        inputs: Sequence[str],
        shapes: Sequence[tuple[TileCoder, Sequence[int]]],
        raw: Sequence[tuple[int, float]] = (),
        bias: bool = True,
        described: dict[str, Value] | None = None,
    ) -> None:
        self.inputs = tuple(inputs)
        """Expressions whose values, in this order, are to be given to `encode` and `dense`."""
        self._grids = _grids(shapes)
        self._raw = np.array([place for place, _ in raw], dtype=np.intp)
        tiles = sum(coder.size for coder, _ in shapes)
        self._after_tiles = slice(tiles, tiles + len(raw))
        self._bias = np.array([tiles + len(raw)] if bias else [], dtype=np.intp)
        self.apart: tuple[int, ...] = tuple(self._bias.tolist())
        """Features that tell nothing of the state: the bias."""
        self.size = tiles + len(raw) + bias
        """Number of features."""
        tilings = sum(coder.tilings for coder, _ in shapes)
        self.active: float = tilings + sum(square for _, square in raw) + bias or 1.0
        """The greatest |φ|² that is expected; collisions make it smaller by a little."""
        self.binary = not raw
        """Whether all features are 0 or 1."""
        self._described = described or {}
        if tilings > MOST_TILINGS or self.size > LARGEST:
            raise ConfigError(
                f"{tilings} tilings and {self.size} features: too many (at most {MOST_TILINGS} and {LARGEST})"
            )

    def encode(self, inputs: Vector) -> Features:
        """Indices of the active features, unique and ascending. `inputs`: shape (inputs,), clamped to 0..1.

        Raises:
            ValueError: an input is not a finite number, or the features are not binary.
        """
        if not self.binary:
            raise ValueError("Raw inputs make features that have no indices alone: take them dense.")
        return self._active(self._checked(inputs))

    def dense(self, inputs: Vector) -> Vector:
        """All features, shape (size,). Raises ValueError: an input is not a finite number."""
        values = self._checked(inputs)
        phi = np.zeros(self.size)
        phi[self._active(values)] = 1.0
        phi[self._after_tiles] = values[self._raw]
        return phi

    def spec(self) -> dict[str, Value]:
        """All that decides what a feature means; with another, learned weights mean nothing."""
        return {"size": self.size, "bias": bool(len(self._bias)), **self._described}

    def _active(self, inputs: Vector) -> Features:
        parts = [
            (grids.coder.indices(inputs[grids.columns]) + grids.offsets).ravel() for grids in self._grids
        ]
        return np.concatenate([unique(np.concatenate(parts)), self._bias]) if parts else self._bias.copy()

    def _checked(self, inputs: Vector) -> Vector:
        if inputs.shape != (len(self.inputs),) or not np.isfinite(inputs).all():
            raise ValueError(f"{len(self.inputs)} finite inputs are needed, not {inputs.tolist()}.")
        return inputs


def _grids(shapes: Sequence[tuple[TileCoder, Sequence[int]]]) -> tuple[Grids, ...]:
    same: dict[tuple[int, int, tuple[float, ...], int], list[tuple[TileCoder, Sequence[int], int]]] = {}
    offset = 0
    for coder, columns in shapes:
        key = (coder.dimensions, coder.tilings, coder.widths, coder.memory)
        same.setdefault(key, []).append((coder, columns, offset))
        offset += coder.size
    return tuple(
        Grids(
            codings[0][0],
            np.array([columns for _, columns, _ in codings], dtype=np.intp),
            np.array([[start] for _, _, start in codings], dtype=np.intp),
        )
        for codings in same.values()
    )


def codings(learn: Learn, specs: Sequence[JointSpec], signals: Named) -> dict[str, StateCoding]:
    """All representations of a config, by name; the arm's own is the first.

    Raises:
        ConfigError: one of them is not one, or two have the same name.
    """
    vocabulary = Vocabulary(signals, learn.define)
    found = {ARM: arm_coding(learn, specs)} if learn.joints else {}
    for number, table in enumerate(learn.representations):
        where = f"learn.representations.{number}"
        if table.name in found:
            raise ConfigError(f"{where}.name: there is a representation '{table.name}' already")
        found[table.name] = state_coding(table, vocabulary, where)
    return found


def state_coding(table: RepresentationTable, vocabulary: Vocabulary, where: str) -> StateCoding:
    """What a table describes; `where`: its place in the config, e.g. "learn.representations.0".

    Raises:
        ConfigError: an input is not an expression or does not lie in 0..1, widths do not fit the inputs, or
            there would be too many features.
    """
    inputs = _Inputs(vocabulary)
    shapes: list[tuple[TileCoder, Sequence[int]]] = []
    told: list[Value] = []
    for number, tiles in enumerate(table.tiles):
        place = f"{where}.tiles.{number}"
        columns = inputs.places(tiles.inputs, f"{place}.inputs", tiled=True)
        shapes += _shapes(tiles, columns, place)
        told.append(_told(tiles, [inputs.canonical[column] for column in columns]))
    raw = [(place, inputs.square(place)) for place in inputs.places(table.raw, f"{where}.raw", tiled=False)]
    described: dict[str, Value] = {"tiles": told, "raw": [inputs.canonical[place] for place, _ in raw]}
    try:
        return StateCoding(inputs.texts, shapes, raw, table.bias, described)
    except ConfigError as error:
        raise ConfigError(f"{where}: {error}") from None


def arm_coding(learn: Learn, specs: Sequence[JointSpec]) -> StateCoding:
    """The representation of thesis 5.3: angles of `learn.joints` over their limits, and traces of these."""
    angles = [f"norm({name_text(f'{joint}.position')})" for joint in learn.joints]
    traces = [f"trace({angle}, {learn.trace_decay!r})" for angle in angles]
    tiles = Tiles(inputs=(*angles, *traces), tilings=learn.tilings, memory=learn.memory)
    table = RepresentationTable(name="of_thesis_5_3", tiles=(tiles,))
    return state_coding(table, Vocabulary(Signals(specs)), "learn.joints")


class _Inputs:
    """The expressions that a representation is made from, each once."""

    def __init__(self, vocabulary: Vocabulary) -> None:
        self._vocabulary = vocabulary
        self._found: dict[Expression, int] = {}
        self._squares: list[float] = []
        self.texts: list[str] = []
        self.canonical: list[str] = []

    def places(self, texts: Sequence[str], where: str, tiled: bool) -> list[int]:
        """Of the inputs that `texts` name, be they patterns with stars; `tiled`: they must be in 0..1."""
        try:
            return [
                self._place(text, tiled)
                for written in texts
                for text in starred(written, self._vocabulary.names)
            ]
        except ConfigError as error:
            raise ConfigError(f"{where}: {error}") from None

    def square(self, place: int) -> float:
        """The greatest square that is expected of an input; 1 where nobody knows."""
        return self._squares[place]

    def _place(self, text: str, tiled: bool) -> int:
        expression = Expression.parse(text, self._vocabulary)
        bounds = expression.range()
        if tiled and bounds and not 0 <= bounds[0] <= bounds[1] <= 1:
            low, high = bounds
            raise ConfigError(
                f"{text!r} goes from {low:g} to {high:g}, and tiles from 0 to 1: write norm({text})"
            )
        if expression not in self._found:
            self._found[expression] = len(self.texts)
            self.texts.append(text)
            self.canonical.append(str(expression))
            self._squares.append(max(bounds[0] ** 2, bounds[1] ** 2) if bounds else 1.0)
        return self._found[expression]


def _shapes(tiles: Tiles, columns: Sequence[int], where: str) -> list[tuple[TileCoder, Sequence[int]]]:
    """The codings that one table of tiles stands for."""
    together = len(columns)
    dimensions = {"together": together, "each": 1, "pairs": 2}[tiles.combine]
    if dimensions > together:
        raise ConfigError(f"{where}.inputs: {together} input makes no pair")
    try:
        coder = TileCoder(dimensions, tiles.tilings, tiles.width, tiles.memory)
    except ValueError as error:
        raise ConfigError(f"{where}: {error}") from None
    return [(coder, chosen) for chosen in combinations(columns, dimensions)]


def _told(tiles: Tiles, inputs: list[str]) -> Value:
    width = tiles.width
    return {
        "inputs": list(inputs),
        "combine": tiles.combine,
        "tilings": tiles.tilings,
        "width": [*width] if isinstance(width, tuple) else width,
        "memory": tiles.memory,
    }
