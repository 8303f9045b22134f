"""`bentod emg`: classifiers of muscle signals, trained on labelled recordings, tried and looked at."""

from collections.abc import Sequence
from pathlib import Path

import click

from bentod.cli.configs import read as read_config
from bentod.cli.emg_words import confusion, feature, number, percent, sentences
from bentod.cli.telling import echo_table, errors_as_sentences, printable
from bentod.config_conditioning import Filter
from bentod.emg.augment import Tonic
from bentod.emg.classify import model_file
from bentod.emg.classify.evaluation import at_random, by_repetition, scored, total
from bentod.emg.classify.labelled import LabelledWindows, Recorded, windows_of
from bentod.emg.classify.labelled_files import read
from bentod.emg.classify.model import Setting
from bentod.emg.classify.training import Recipe, trained
from bentod.emg.features.feature_list import FeatureList
from bentod.emg.segmenting import segmenting
from bentod.errors import ConfigError
from bentod.frames import Value
from bentod.registry import CLASSIFIERS

_PATH = click.Path(path_type=Path)
_RECORDINGS = click.argument("recordings", type=_PATH, nargs=-1, required=True)
_RATE = click.option("--rate-hz", type=float, help="Of recordings that do not state it.")
_SCALE = click.option("--volts-per-unit", type=float, help="Default: 1e-6 for whole numbers, else 1.")

_TIMES = 5
"""Random splits; the thesis made 30."""


@click.group()
def emg() -> None:
    """Train a classifier of muscle signals on labelled recordings, and try it."""


@emg.command()
@_RECORDINGS
@click.option("--out", type=_PATH, required=True, help="File for the model.")
@click.option("--classifier", type=click.Choice(sorted(CLASSIFIERS)), default="lda", show_default=True)
@click.option("--option", "options", multiple=True, metavar="KEY=NUMBER", help="Of the classifier: c=10.")
@click.option(
    "--feature", "features", multiple=True, default=("td",), metavar="NAME[:KEY=VALUE,…]", show_default=True
)
@click.option(
    "--tonic",
    type=click.FloatRange(0, 10),
    help="Train also as if muscles held a load, up to so many times the loudest channel; 2 is usual.",
)
@click.option("--window-s", type=float, default=0.15, show_default=True)
@click.option("--step-s", type=float, default=0.05, show_default=True)
@click.option("--seed", type=click.IntRange(0, 2**31), default=0, show_default=True)
@click.option("--config", type=_PATH, help="Condition as the [[emg.filters]] of this config do.")
@_RATE
@_SCALE
def train(
    recordings: tuple[Path, ...],
    out: Path,
    classifier: str,
    options: tuple[str, ...],
    features: tuple[str, ...],
    tonic: float | None,
    window_s: float,
    step_s: float,
    seed: int,
    config: Path | None,
    rate_hz: float | None,
    volts_per_unit: float | None,
) -> None:
    """Train on RECORDINGS, .npz or .csv with labels, and say how well their classes are told apart."""
    with errors_as_sentences():
        found = [read(path, rate_hz, volts_per_unit) for path in recordings]
        rate, channels = found[0].rate_hz, found[0].channels
        setting = Setting(rate, channels, segmenting(window_s, step_s, rate), _filters(config))
        windows = windows_of(found, setting.segmenting, setting.filters)
        asked = FeatureList([feature(word) for word in features], channels, rate)
        busy = None if tonic is None else Tonic(strength=tonic)
        recipe = Recipe(asked, classifier, dict(map(number, options)), seed, busy)
        about: dict[str, Value] = {"recordings": [path.name for path in recordings], "tonic": tonic}
        model = trained(windows, recipe, setting, {**about, **_estimated(windows, recipe)})
        size = model_file.write(out, model)
    click.echo(f"{out}: {size} bytes")


def _filters(config: Path | None) -> tuple[Filter, ...]:
    """Those of a config; none without one. Raises ConfigError: it has no [emg]."""
    if config is None:
        return ()
    found = read_config(config).emg
    if found is None:
        raise ConfigError(f"{config}: it has no [emg]")
    return found.filters


def _estimated(windows: LabelledWindows, recipe: Recipe) -> dict[str, Value]:
    """Tell how well classes are recognised; returns it for the model's summary."""
    told: dict[str, Value] = {}
    if len(set(windows.repetitions.tolist())) > 1:
        scores = by_repetition(windows, recipe)
        whole = total(list(scores.values()))
        each = ", ".join(percent(score.accuracy) for score in scores.values())
        told["leave_one_repetition_out"] = whole.accuracy
        click.echo(f"each repetition by the others: {percent(whole.accuracy)} ({each})")
        echo_table(*confusion(whole))
    else:
        click.echo("There is only one repetition: nothing says how well another one would be recognised.")
    told["random_80_20"] = total(at_random(windows, recipe, times=_TIMES, seed=recipe.seed)).accuracy
    click.echo(f"a random fifth by the rest: {percent(told['random_80_20'])}, too good: windows overlap")
    return told


@emg.command()
@click.argument("model", type=_PATH)
@_RECORDINGS
@_RATE
@_SCALE
def test(
    model: Path, recordings: tuple[Path, ...], rate_hz: float | None, volts_per_unit: float | None
) -> None:
    """Try MODEL on RECORDINGS, .npz or .csv with labels: window by window, without votes or rejection."""
    with errors_as_sentences():
        found = model_file.read(model)
        recorded = [read(path, rate_hz, volts_per_unit) for path in recordings]
        _must_fit(found.setting, recorded)
        windows = windows_of(recorded, found.setting.segmenting, found.setting.filters)
        score = scored(windows, found.features, found.classifier)
    click.echo(f"{percent(score.accuracy)} of {score.windows} windows")
    echo_table(*confusion(score))


def _must_fit(setting: Setting, recorded: Sequence[Recorded]) -> None:
    """Raises ConfigError: a recording is of another rate, or another number of channels."""
    for one in recorded:
        there = Setting(one.rate_hz, one.channels, setting.segmenting, setting.filters)
        if problems := setting.differences(there):
            raise ConfigError("\n".join(problems))


@emg.command()
@click.argument("model", type=_PATH)
def show(model: Path) -> None:
    """Tell what MODEL was trained on, and what it needs."""
    with errors_as_sentences():
        for sentence in sentences(model_file.read(model)):
            click.echo(printable(sentence))
