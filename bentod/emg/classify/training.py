"""From labelled windows to a model."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field

from bentod.emg.augment import Tonic, with_tonic
from bentod.emg.classify.kinds import trainer
from bentod.emg.classify.labelled import LabelledWindows
from bentod.emg.classify.loudness import loudness, ranges
from bentod.emg.classify.model import Model, Setting
from bentod.emg.recognition import Classifier, Features
from bentod.frames import Value


@dataclass(frozen=True, slots=True)
class Recipe:
    """What is made of labelled windows."""

    features: Features
    classifier: str = "lda"  # of bentod.registry.CLASSIFIERS
    options: Mapping[str, float] = field(default_factory=dict)  # the classifier's own
    seed: int = 0
    tonic: Tonic | None = None  # contractions that are added to copies of the windows; None: no copies


def fitted(windows: LabelledWindows, recipe: Recipe) -> tuple[Features, Classifier]:
    """Features and a classifier that know these windows.

    Raises:
        ConfigError: there is no such classifier, its extra is not installed, or it cannot be trained so.
    """
    train = trainer(recipe.classifier)
    features = recipe.features.fit(windows.windows)
    labels = windows.labels.tolist()
    if recipe.tonic is None:
        return features, train(features.of(windows.windows), labels, recipe.options, recipe.seed)
    volts, told = with_tonic(windows.windows, labels, recipe.tonic, recipe.seed)
    return features, train(features.of(volts), told, recipe.options, recipe.seed)


def trained(
    windows: LabelledWindows,
    recipe: Recipe,
    setting: Setting,
    about: Mapping[str, Value] | None = None,
) -> Model:
    """A model of windows that were made as `setting` says; `about` goes into its summary.

    It may take a second and a whole processor: leave it to another process than the one that moves an arm.

    Raises:
        ConfigError: see `fitted`.
    """
    features, classifier = fitted(windows, recipe)
    labels = windows.labels.tolist()
    counts: dict[str, Value] = dict(sorted(Counter(labels).items()))
    return Model(
        setting,
        features,
        classifier,
        recipe.classifier,
        recipe.options,
        recipe.seed,
        ranges(loudness(windows.windows), labels),
        {"windows": counts, **(about or {})},
    )
