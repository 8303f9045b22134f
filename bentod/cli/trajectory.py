"""A trajectory in a file, as way points, and what must hold before an arm may follow it."""

import csv
import math
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from bentod.errors import ConfigError, nearest

MOST = 10_000
"""Way points."""

TIME = "time_s"


@dataclass(frozen=True, slots=True)
class Reach:
    """What a joint may do."""

    minimum: float  # rad
    maximum: float  # rad
    velocity: float  # rad/s, the greatest


@dataclass(frozen=True, slots=True)
class WayPoint:
    """Where joints are to be at a time."""

    line: int  # of the file, from 1
    time: float  # s
    positions: Mapping[str, float]  # rad, by joint


@dataclass(frozen=True, slots=True)
class Trajectory:
    """Way points, straight from one to the next."""

    name: str
    points: Sequence[WayPoint]

    @property
    def joints(self) -> tuple[str, ...]:
        """Names."""
        return tuple(self.points[0].positions)

    @property
    def duration(self) -> float:
        """From the first way point to the last (s)."""
        return self.points[-1].time - self.points[0].time

    def at(self, time: float) -> dict[str, float]:
        """Where each joint is to be (rad), `time` s after the first way point."""
        times = [point.time - self.points[0].time for point in self.points]
        return {
            joint: float(np.interp(time, times, [point.positions[joint] for point in self.points]))
            for joint in self.joints
        }

    def check(self, reaches: Mapping[str, Reach]) -> None:
        """Raises ConfigError: a joint is none of the arm's, or would go too far or too fast; says where."""
        for point in self.points:
            for joint, position in point.positions.items():
                self._reached(point, joint, position, reaches)
        for before, after in pairwise(self.points):
            for joint in self.joints:
                way, took = after.positions[joint] - before.positions[joint], after.time - before.time
                if abs(way) / took > reaches[joint].velocity:
                    raise self._refused(
                        after,
                        f"{joint} would have to go at {abs(way) / took:.3g} rad/s; its greatest speed is "
                        f"{reaches[joint].velocity:g} rad/s",
                    )

    def _reached(self, point: WayPoint, joint: str, position: float, reaches: Mapping[str, Reach]) -> None:
        if joint not in reaches:
            raise self._refused(point, f"there is no joint '{joint}'{nearest(joint, reaches)}")
        reach = reaches[joint]
        if not reach.minimum <= position <= reach.maximum:
            raise self._refused(
                point,
                f"{joint} = {position:g} rad is outside its limits, {reach.minimum:g} to "
                f"{reach.maximum:g} rad",
            )

    def _refused(self, point: WayPoint, why: str) -> ConfigError:
        return ConfigError(f"{self.name}: line {point.line}: {why}")


def read_trajectory(path: Path) -> Trajectory:
    """The trajectory in a CSV file (a column time_s in s, one in rad for each joint) or a TOML file (points).

    Raises:
        ConfigError: it cannot be read, or is no trajectory; says in which line.
    """
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise ConfigError(f"{path}: cannot be read: {error}") from error
    try:
        rows = _of_toml(text) if path.suffix == ".toml" else _of_csv(text)
    except ConfigError as error:
        raise ConfigError(f"{path}: {error}") from None
    if not 2 <= len(rows) <= MOST:
        raise ConfigError(f"{path}: {len(rows)} way points: a trajectory has 2 to {MOST}")
    points = [_point(path, line, row) for line, row in rows]
    for before, after in pairwise(points):
        if not after.time > before.time:
            raise ConfigError(
                f"{path}: line {after.line}: {TIME} = {after.time:g} is not after {before.time:g}"
            )
        if after.positions.keys() != before.positions.keys():
            raise ConfigError(f"{path}: line {after.line}: names other joints than the way point before it")
    return Trajectory(str(path), points)


def _of_csv(text: str) -> list[tuple[int, dict[str, object]]]:
    rows = csv.DictReader(text.splitlines())
    found: list[tuple[int, dict[str, object]]] = []
    for row in rows:
        if None in row or None in row.values():
            raise ConfigError(f"line {rows.line_num}: has not as many columns as the first line")
        found.append((rows.line_num, dict(row)))
    return found


def _of_toml(text: str) -> list[tuple[int, dict[str, object]]]:
    try:
        points = tomllib.loads(text).get("points")
    except tomllib.TOMLDecodeError as error:
        raise ConfigError(f"not valid TOML: {error}") from error
    lines = [n for n, line in enumerate(text.splitlines(), 1) if line.strip().startswith("[[points]]")]
    if not isinstance(points, list) or len(points) != len(lines):
        raise ConfigError("needs way points, each a table that begins with [[points]]")
    return list(zip(lines, points, strict=True))


def _point(path: Path, line: int, row: Mapping[str, object]) -> WayPoint:
    values: dict[str, float] = {}
    for key, told in row.items():
        try:
            values[key.strip()] = float(str(told))
        except ValueError:
            raise ConfigError(f"{path}: line {line}: {key} = {told} is not a number") from None
        if not math.isfinite(values[key.strip()]):
            raise ConfigError(f"{path}: line {line}: {key} = {told} is not finite")
    if TIME not in values or len(values) < 2:
        raise ConfigError(f"{path}: line {line}: needs {TIME} (s), and the position (rad) of a joint or more")
    return WayPoint(line, values.pop(TIME), values)
