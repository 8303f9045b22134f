"""What a model's file says besides its arrays, and how both become a model again."""

import json
from collections.abc import Mapping
from importlib.metadata import PackageNotFoundError, version
from typing import Annotated, Literal, cast

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, JsonValue, ValidationError

from bentod.config_conditioning import Filter
from bentod.emg.classify.kinds import restored
from bentod.emg.classify.loudness import Range
from bentod.emg.classify.model import Model, Setting
from bentod.emg.features.feature_list import FeatureList
from bentod.emg.recognition import Classifier, Segmenting
from bentod.errors import SnapshotError
from bentod.frames import Value

FORMAT = 1
"""The newest that is understood."""

_PACKAGES = ("bentod", "numpy", "scikit-learn")


class Header(BaseModel):
    """All but the arrays."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    format: Literal[1]
    rate_hz: Annotated[float, Field(gt=0)]
    channels: Annotated[int, Field(ge=1)]
    length: Annotated[int, Field(ge=2)]  # of a window, samples
    step: Annotated[int, Field(ge=1)]  # samples
    filters: tuple[Filter, ...]
    features: dict[str, JsonValue]
    columns: Annotated[tuple[str, ...], Field(min_length=1)]  # names of the features' columns
    classifier: str
    options: dict[str, float]
    seed: int
    labels: Annotated[tuple[str, ...], Field(min_length=2)]
    ranges: dict[str, tuple[float, float]]  # V
    training: dict[str, JsonValue]
    versions: dict[str, str]


def written(model: Model) -> str:
    """The header of `model`, as JSON. Raises ValueError: something in it has no form in JSON."""
    setting = model.setting
    told: dict[str, object] = {
        "format": FORMAT,
        "rate_hz": setting.rate_hz,
        "channels": setting.channels,
        "length": setting.segmenting.length,
        "step": setting.segmenting.step,
        # A filter refuses keys of other kinds of filter even at their defaults.
        "filters": [one.model_dump(exclude_defaults=True) for one in setting.filters],
        "features": dict(model.features.spec()),
        "columns": model.features.names,
        "classifier": model.kind,
        "options": dict(model.options),
        "seed": model.seed,
        "labels": model.labels,
        "ranges": {label: (found.least, found.greatest) for label, found in model.ranges.items()},
        "training": dict(model.training),
        "versions": {name: _version(name) for name in _PACKAGES},
    }
    try:
        return json.dumps(told, allow_nan=False, sort_keys=True)
    except TypeError as error:
        raise ValueError(f"a model's file cannot hold this: {error}") from error


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "none"


def understood(text: bytes) -> Header:
    """The header that `text` is. Raises SnapshotError: it is none, or of a newer format."""
    try:
        told = json.loads(text)
        newer = told.get("format") if isinstance(told, dict) else None
        if isinstance(newer, int) and newer > FORMAT:
            raise SnapshotError(f"it is of format {newer}; this bentod reads up to {FORMAT}")
        return Header.model_validate(told)
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(map(str, first["loc"])) or "all of it"
        raise SnapshotError(f"its header cannot be understood: {where}: {first['msg']}") from error
    except ValueError as error:
        raise SnapshotError(f"its header is not valid JSON: {error}") from error


def model(header: Header, arrays: Mapping[str, NDArray[np.float64]]) -> Model:
    """What was written.

    Raises:
        ConfigError: its features or classifier are not known here.
        SnapshotError: its parts do not go together.
    """
    features = FeatureList.from_spec(cast("Mapping[str, Value]", header.features))
    if features.names != header.columns:
        raise SnapshotError(
            f"its features are {_spoken(header.columns)}; what they are made of gives "
            f"{_spoken(features.names)}"
        )
    if missing := set(header.labels) - header.ranges.keys():
        raise SnapshotError(f"its class '{min(missing)}' has no range of loudness")
    classifier = restored(header.classifier, header.labels, arrays)
    _try(classifier, len(header.columns))
    segmenting = Segmenting(header.length, header.step)
    return Model(
        Setting(header.rate_hz, header.channels, segmenting, header.filters),
        features,
        classifier,
        header.classifier,
        header.options,
        header.seed,
        {label: Range(*bounds) for label, bounds in header.ranges.items()},
        cast("Mapping[str, Value]", header.training),
    )


def _spoken(names: tuple[str, ...]) -> str:
    return f"{len(names)} columns from '{names[0]}' to '{names[-1]}'"


def _try(classifier: Classifier, columns: int) -> None:
    """Raises SnapshotError: it does not take rows of so many columns."""
    try:
        classifier.probabilities(np.zeros((1, columns)))
    except Exception as error:  # of a file that somebody else may have made
        raise SnapshotError(f"its classifier does not take rows of {columns} columns: {error}") from error
