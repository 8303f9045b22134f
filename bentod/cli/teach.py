"""`bentod teach`: ways to teach an arm besides using it (thesis 5.6.5); learners learn from what is read."""

import asyncio
from collections.abc import Awaitable, Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TypeVar

import click

from bentod.cli import teaching
from bentod.cli.learn import replay_command
from bentod.cli.link import ADDRESS, CA_FILE, TOKEN_FILE, Way
from bentod.cli.telling import errors_as_sentences
from bentod.cli.trajectory import read_trajectory
from bentod.client import Client
from bentod.endpoint import default_socket_path

_PATH = click.Path(path_type=Path)

T = TypeVar("T")


@click.group()
@ADDRESS
@TOKEN_FILE
@CA_FILE
@click.pass_context
def teach(ctx: click.Context, socket: str | None, token_file: Path | None, ca_file: Path | None) -> None:
    """Teach the arm: by leading it with the hand, along a trajectory, or with a recording."""
    ctx.obj = Way(socket or default_socket_path(), token_file, ca_file)


@teach.command()
@click.argument("file", type=_PATH)
@click.option("--times", type=click.IntRange(1, 1000), default=1, show_default=True, help="How often.")
@click.option("--yes", is_flag=True, help="Do not ask first.")
@click.pass_obj
def trajectory(way: Way, file: Path, times: int, yes: bool) -> None:
    """Lead the arm along the way points of FILE, while it learns; Ctrl-C stops it at once.

    FILE is CSV with the columns time_s (s) and one for each joint (rad), or TOML with the same as [[points]].
    A way point outside the limits of a joint, or too far from the one before it, is refused.
    """
    with errors_as_sentences():
        found = read_trajectory(file)
        names, lasts = ", ".join(found.joints), times * found.duration
        if not yes:
            click.confirm(f"{names} will move by themselves for {lasts:.0f} s. Go on?", abort=True)
        with _interrupted("Stopped. The arm is paused: `bentod ctl pause off` releases it."):
            _ask(way, lambda arm: teaching.lead(arm, found, times, click.echo))


@teach.command()
@click.argument("joints", metavar="[JOINT]...", nargs=-1)
@click.option("--circuits", type=click.IntRange(1, 1000), help="Ends after so many; else Ctrl-C ends it.")
@click.pass_obj
def hand(way: Way, joints: tuple[str, ...], circuits: int | None) -> None:
    """Lead JOINT..., or all, by the hand: they go limp, and learners watch where you move them.

    What was learned is followed as soon as they have torque again and somebody uses them.
    """
    with errors_as_sentences():
        names = _ask(way, lambda arm: teaching.chosen(arm, joints))
        told = ", ".join(names)
        click.confirm(f"{told} will go limp, and what they carry falls: hold the arm. Go on?", abort=True)
        _ask(way, lambda arm: teaching.limp(arm, names))
        click.echo("Limp. Lead the arm; a circuit ends where it began.")
        with suppress(KeyboardInterrupt):
            _ask(way, lambda arm: teaching.count(arm, names, circuits, click.echo))
        if not click.confirm("Hold the arm still. Shall it have torque again?"):
            click.echo("It is left limp: `bentod ctl torque on` gives it torque.")
            return
        _ask(way, lambda arm: teaching.hold(arm, names))
        click.echo("It holds where it is until `bentod ctl pause off` releases it.")


@teach.command()
@click.argument("file", type=_PATH)
@click.option("--snapshot", type=_PATH, required=True, help="Keep what is learned in this file.")
@click.option("--from", "start", type=_PATH, help="Begin with what this snapshot knows.")
@click.option("--set", "changes", multiple=True, metavar="KEY=VALUE", help="E.g. learn.step_size=0.1.")
@click.pass_context
def recording(
    ctx: click.Context, file: Path, snapshot: Path, start: Path | None, changes: tuple[str, ...]
) -> None:
    """Learn from the recording FILE, as `bentod learn replay` does, for an arm to begin with."""
    ctx.invoke(replay_command, recording=file, changes=changes, start=start, output=snapshot)
    click.echo(f'An arm begins with it that has [learn.snapshot] path = "{snapshot.absolute()}".')


def _ask(way: Way, act: Callable[[Client], Awaitable[T]]) -> T:
    async def connected() -> T:
        async with way.client() as arm:
            return await act(arm)

    return asyncio.run(connected())


@contextmanager
def _interrupted(sentence: str) -> Iterator[None]:
    """Ctrl-C is told as a sentence, and the exit code is that of an interruption."""
    try:
        yield
    except KeyboardInterrupt:
        click.echo(sentence, err=True)
        raise SystemExit(130) from None
