"""What was trained, with all that its answers depend on."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from bentod.config_conditioning import Filter
from bentod.emg.classify.loudness import Range
from bentod.emg.recognition import Classifier, Features, Segmenting
from bentod.frames import Value


@dataclass(frozen=True, slots=True)
class Setting:
    """What samples are, before features are made of them."""

    rate_hz: float
    channels: int
    segmenting: Segmenting
    filters: tuple[Filter, ...] = ()

    def differences(self, other: "Setting") -> list[str]:
        """A sentence for each way in which `other`, what there is, is not this, what was trained with."""
        pairs = {
            "rate": (f"{self.rate_hz:g} Hz", f"{other.rate_hz:g} Hz"),
            "number of channels": (str(self.channels), str(other.channels)),
            "window": (f"{self.segmenting.length} samples", f"{other.segmenting.length} samples"),
            "step of the windows": (f"{self.segmenting.step} samples", f"{other.segmenting.step} samples"),
            "conditioning": (spoken(self.filters), spoken(other.filters)),
        }
        return _sentences(pairs)


@dataclass(frozen=True, slots=True)
class Model:
    """Features and a classifier that were trained, and the range of loudness of each class."""

    setting: Setting
    features: Features
    classifier: Classifier
    kind: str  # of bentod.registry.CLASSIFIERS
    options: Mapping[str, float]
    seed: int
    ranges: Mapping[str, Range]
    training: Mapping[str, Value] = field(default_factory=dict)  # a summary for people

    @property
    def labels(self) -> tuple[str, ...]:
        """Of the classes, in the classifier's order."""
        return self.classifier.labels

    def differences(self, setting: Setting, features: Features | None = None) -> list[str]:
        """A sentence for each way in which what there is differs from what this was trained with.

        `features`: what the config asks for; None: whatever the model has. What features found in training
        (such as edges of a histogram) is not compared.
        """
        found = self.setting.differences(setting)
        if features is None:
            return found
        pairs = dict(_unlike("features", dict(self.features.spec()), dict(features.spec())))
        return found + _sentences(pairs)


_OF_SETTING = frozenset({"channels", "rate_hz"})
"""Keys of what features are made of that the setting tells as well."""


def _unlike(where: str, own: Value, asked: Value) -> Iterator[tuple[str, tuple[str, str]]]:
    """Where two specifications differ. An empty list asks for what training finds, whatever that is."""
    if isinstance(own, dict) and isinstance(asked, dict):
        for key in sorted({*own, *asked} - _OF_SETTING):
            yield from _unlike(f"{where}.{key}", own.get(key), asked.get(key))
    elif isinstance(own, list) and isinstance(asked, list) and asked and len(own) == len(asked):
        for place, (one, other) in enumerate(zip(own, asked, strict=True)):
            yield from _unlike(f"{where}[{place}]", one, other)
    elif own != asked and asked != []:
        yield where, (_told(own), _told(asked))


def _told(value: Value) -> str:
    return "not there" if value is None else str(value)


def spoken(filters: tuple[Filter, ...]) -> str:
    """Filters in a few words."""
    dumped = (one.model_dump(exclude_none=True, exclude_defaults=True) for one in filters)
    return "; ".join(", ".join(f"{key} {value}" for key, value in one.items()) for one in dumped) or "none"


def _sentences(pairs: Mapping[str, tuple[str, str]]) -> list[str]:
    return [
        f"The model's {name} is {own}; here it is {other}."
        for name, (own, other) in pairs.items()
        if own != other
    ]
