"""What `bentod emg` is told and tells, in words."""

from collections.abc import Sequence

from bentod.cli.link import parsed
from bentod.emg.classify.evaluation import Score
from bentod.emg.classify.model import Model, spoken
from bentod.errors import ConfigError
from bentod.frames import Value


def number(word: str) -> tuple[str, float]:
    """Key and value of "KEY=NUMBER". Raises ConfigError: it is not of that form."""
    key, _, text = word.partition("=")
    try:
        return key, float(text)
    except ValueError:
        raise ConfigError(f"--option {word}: write KEY=NUMBER") from None


def feature(word: str) -> str | dict[str, Value]:
    """A name, or a table from "NAME:KEY=VALUE,…". Raises ConfigError: it is not of that form."""
    name, colon, rest = word.partition(":")
    if not colon:
        return name
    pairs = [part.partition("=") for part in rest.split(",")]
    if not all(key and sign and text for key, sign, text in pairs):
        raise ConfigError(f"--feature {word}: write NAME:KEY=VALUE,KEY=VALUE")
    return {"name": name, **{key: parsed(text) for key, _, text in pairs}}


def percent(share: Value) -> str:
    """With one digit behind the point."""
    return f"{100 * share:.1f} %" if isinstance(share, int | float) else "not known"


def confusion(score: Score) -> tuple[list[str], list[list[str]]]:
    """Head and rows of a table: windows of each class, by what they were recognised as."""
    recall = score.recall()
    rows = [
        [label, *map(str, counts.tolist()), percent(recall.get(label))]
        for label, counts in zip(score.labels, score.confusion, strict=True)
    ]
    return ["done \\ recognised", *score.labels, "right"], rows


def sentences(model: Model) -> list[str]:
    """What a model is."""
    setting, options = model.setting, ", ".join(f"{key} {value:g}" for key, value in model.options.items())
    lines = [
        f"classifier: {model.kind}" + (f" ({options})" if options else "") + f", seed {model.seed}",
        f"signals: {setting.channels} channels at {setting.rate_hz:g} Hz, filters: {spoken(setting.filters)}",
        f"windows: {setting.segmenting.length} samples every {setting.segmenting.step}",
        f"features: {len(model.features.names)} columns, {_features(model.features.spec().get('features'))}",
    ]
    for label in model.labels:
        span = model.ranges[label]
        lines.append(f"class {label}: loudness {1e6 * span.least:.3g} to {1e6 * span.greatest:.3g} µV")
    known = {name: value for name, value in model.training.items() if value is not None}
    return [*lines, *(f"{name}: {_told(value)}" for name, value in known.items())]


def _features(asked: Value) -> str:
    names = (
        [str(one.get("name")) for one in asked if isinstance(one, dict)] if isinstance(asked, list) else []
    )
    return ", ".join(names)


def _told(value: Value) -> str:
    if isinstance(value, dict):
        return ", ".join(f"{key} {_told(item)}" for key, item in value.items())
    if isinstance(value, Sequence) and not isinstance(value, str | bytes):
        return ", ".join(map(_told, value))
    return percent(value) if isinstance(value, float) else str(value)
