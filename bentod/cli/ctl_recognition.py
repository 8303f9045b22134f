"""Commands of `bentod ctl` about recognising muscle signals: prompts in the terminal, training, use."""

import asyncio
from collections.abc import AsyncIterator, Sequence
from contextlib import suppress

import click

from bentod.cli import show
from bentod.cli.link import Failed, Link, failure
from bentod.cli.recognition_words import collected, trained
from bentod.client import Client
from bentod.errors import BentodError
from bentod.frames import Value

_CLASSES = click.argument("classes", metavar="[CLASS]...", nargs=-1)
_HOLD = click.option("--hold", type=click.FloatRange(0.5, 30), default=3.0, show_default=True, help="s")
_REST = click.option("--rest", type=click.FloatRange(0.5, 30), default=3.0, show_default=True, help="s")
_REPETITIONS = click.option("--repetitions", type=click.IntRange(1, 50), default=3, show_default=True)
_ANEW = click.option("--anew", is_flag=True, help="Forget what was collected before.")
_NOTE = click.option("--condition", default="", help="A note that is kept with it.")
_MODEL = click.option("--model", help="Name of the model; the config's without.")


@click.command("emg-classes")
@click.pass_obj
def emg_classes(link: Link) -> None:
    """Show the classes of contractions, what each moves, and the models."""
    link.do("emg_classes")


@click.command("emg-collect")
@_CLASSES
@_HOLD
@_REST
@_REPETITIONS
@_ANEW
@_NOTE
@click.pass_obj
def emg_collect(
    link: Link,
    classes: tuple[str, ...],
    hold: float,
    rest: float,
    repetitions: int,
    anew: bool,
    condition: str,
) -> None:
    """Prompt contractions and keep them to be trained on; Ctrl-C ends it, and nothing is kept."""
    told = _guided(
        link,
        "emg_collect",
        **_plan(classes, hold, rest, repetitions, anew, condition),
    )
    link.show(told, collected(told))


@click.command("emg-train")
@_MODEL
@click.option("--classifier", help="Another one than the config's: lda, knn, random_forest, svm_linear …")
@click.pass_obj
def emg_train(link: Link, model: str | None, classifier: str | None) -> None:
    """Train a model on all that was collected, while the arm is in use."""
    told = _guided(link, "emg_train", model=model, classifier=classifier)
    link.show(told, trained(told))


@click.command("emg-use")
@click.argument("model", required=False)
@click.pass_obj
def emg_use(link: Link, model: str | None) -> None:
    """Recognise by a model that was trained, from the next tick on."""
    link.do("emg_use", model=model)


@click.command("emg-retrain")
@_CLASSES
@_HOLD
@_REST
@click.option("--repetitions", type=click.IntRange(1, 50), default=1, show_default=True)
@_ANEW
@_NOTE
@_MODEL
@click.pass_obj
def emg_retrain(
    link: Link,
    classes: tuple[str, ...],
    hold: float,
    rest: float,
    repetitions: int,
    anew: bool,
    condition: str,
    model: str | None,
) -> None:
    """Collect, train on old and new, and use, in one go."""
    told = _guided(
        link,
        "emg_retrain",
        **_plan(classes, hold, rest, repetitions, anew, condition),
        model=model,
    )
    found = show.fields(told)
    link.show(told, f"{collected(found['collected'])}\n{trained(found['trained'])}")


@click.command("emg-prompt")
@click.argument("label", default="rest")
@click.pass_obj
def emg_prompt(link: Link, label: str) -> None:
    """Have a simulated wearer make a movement, until another is asked for."""
    link.do("emg_prompt", label=label)


def _plan(
    classes: Sequence[str], hold: float, rest: float, repetitions: int, anew: bool, condition: str
) -> dict[str, Value]:
    """Parameters of a collection, as the daemon names them."""
    return {
        "classes": list[Value](classes) or None,
        "hold_s": hold,
        "rest_s": rest,
        "repetitions": repetitions,
        "add": not anew,
        "condition": condition,
    }


def _guided(link: Link, method: str, **named: Value) -> Value:
    """Call what takes its time, and show prompts meanwhile. Raises Failed: it was refused or interrupted."""
    try:
        return asyncio.run(_with_prompts(link, method, named))
    except BentodError as error:
        raise failure(error) from error
    except KeyboardInterrupt as error:
        raise Failed("Interrupted: nothing was kept.") from error


async def _with_prompts(link: Link, method: str, named: dict[str, Value]) -> Value:
    async with link.way.client() as arm:
        await arm.call("hello", name="ctl")
        async with arm.listen("events") as events:
            return await _beside(arm, events, method, named)


async def _beside(
    arm: Client, events: AsyncIterator[dict[str, Value]], method: str, named: dict[str, Value]
) -> Value:
    showing = asyncio.create_task(_show(events))
    try:
        return await arm.call(method, **named)
    finally:
        showing.cancel()
        with suppress(asyncio.CancelledError, BentodError):
            await showing


async def _show(events: AsyncIterator[dict[str, Value]]) -> None:
    """Prompts on the terminal, and on what is beside it: stderr."""
    async for event in events:
        data = show.fields(event.get("data"))
        if event.get("kind") == "emg" and ("prompt" in data or "collection" in data):
            click.echo(str(event.get("text")), err=True)


@click.command("emg-reset")
@click.pass_obj
def emg_reset(link: Link) -> None:
    """Forget what recognition learned in use, and recognise as trained."""
    link.do("emg_reset")


RECOGNITION = (emg_classes, emg_collect, emg_train, emg_use, emg_reset, emg_retrain, emg_prompt)
"""In the order of the help."""
