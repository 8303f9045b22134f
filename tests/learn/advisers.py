"""What an arm has learned, as a file that advises others."""

from pathlib import Path

import numpy as np

from bentod.config_learn import Learn
from bentod.learn.predictor import Body, Predictor
from bentod.learn.snapshot import Snapshot, read, taken, write
from tests.learn.predictors import BODY, SMALL, live, new_predictor


def learned(ticks: int = 900, first: int = 0, **learn: object) -> Predictor:
    """A predictor that has lived through some ticks."""
    predictor = new_predictor(**learn)
    live(predictor, first, first + ticks)
    return predictor


def kept(predictor: Predictor, path: Path) -> Snapshot:
    """What it knows, written and read again."""
    write(path, taken(predictor, path.stem, 0.0, predictor.horde.answers.tick))
    return read(path)


def advised(path: Path, digest: str = "", **learn: object) -> Predictor:
    """A predictor that knows nothing itself, with the adviser "old"."""
    adviser = {"name": "old", "snapshot": path, "digest": digest}
    return Predictor(BODY, Learn.model_validate(SMALL | {"advisers": [adviser]} | learn))


def missed(told: list[dict[str, float]], other: list[dict[str, float]], name: str) -> float:
    """Root mean square of the difference between two predictions, rad."""
    return float(np.sqrt(np.mean([(a[name] - b[name]) ** 2 for a, b in zip(told, other, strict=True)])))


def advised_without_groups(path: Path) -> Predictor:
    """The same on an arm whose joints are in no group."""
    adviser = {"name": "old", "snapshot": path}
    body = Body(BODY.specs, (), {}, BODY.rate_hz)
    return Predictor(body, Learn.model_validate(SMALL | {"advisers": [adviser]}))
