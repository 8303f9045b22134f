"""`bentod learn`: what was learned, looked at, compared, learned again, and with other parameters."""

import os
from collections.abc import Callable, Iterable, Iterator
from functools import partial
from pathlib import Path
from typing import cast

import click

from bentod.analysis.columns import as_json
from bentod.analysis.extras import MissingExtra, load_extra
from bentod.cli import snapshot_words as words
from bentod.cli.changes import grid, single
from bentod.cli.merge import merge
from bentod.cli.replay import lines
from bentod.cli.telling import echo_table, errors_as_sentences, printable
from bentod.errors import Refused, SnapshotError
from bentod.learn.differences import Sides, differences
from bentod.learn.snapshot import Keepable, read, taken, write
from bentod.record.reader import Recording
from bentod.replay.altered import relearner
from bentod.replay.comparison import compared
from bentod.replay.relearn import Relearner, Tick, ticks
from bentod.replay.sweep import Outcome, Point, Told, Work, points
from bentod.replay.sweep_table import as_csv, sentences, table
from bentod.replay.sweep_thought import check, thought

_PATH = click.Path(path_type=Path)

_SHOWN = 40
"""Questions and arrays that are listed if nobody asks for all."""

Run = Callable[[Work, list[Point], Told], list[Outcome]]
Draw = Callable[[list[Outcome], Path], None]


@click.group()
def learn() -> None:
    """Look at what was learned, and learn it again from recordings."""


@learn.command()
@click.argument("snapshot", type=_PATH)
@click.option("--all", "everything", is_flag=True, help=f"List more than {_SHOWN} questions and arrays.")
@click.option("--json", "as_data", is_flag=True, help="The header and the arrays' shapes, for programs.")
def show(snapshot: Path, everything: bool, as_data: bool) -> None:
    """Tell what SNAPSHOT answers, what it is learned from, and when."""
    with errors_as_sentences():
        found = read(snapshot)
        if as_data:
            shapes = {name: list(array.shape) for name, array in found.arrays.items()}
            click.echo(as_json({"header": found.header, "arrays": shapes, "digest": found.digest}))
            return
        click.echo("\n".join(map(printable, words.sentences(snapshot, found, snapshot.stat().st_size))))
        head, *asked = words.questions(found)
        _echo_some(head, asked, everything)
        _echo_some(list(words.ARRAY_HEAD), words.arrays(found), everything)


def _echo_some(head: list[str], rows: list[list[str]], everything: bool) -> None:
    if not rows:
        return
    shown = rows if everything else rows[:_SHOWN]
    click.echo()
    echo_table(head, shown)
    if len(shown) < len(rows):
        click.echo(f"… and {len(rows) - len(shown)} more; --all lists them")


@learn.command()
@click.argument("one", type=_PATH)
@click.argument("other", type=_PATH)
def diff(one: Path, other: Path) -> None:
    """Tell how two snapshots differ, in what they answer and in every number; exit code 1 if they do."""
    with errors_as_sentences():
        found = words.told_apart(read(one), read(other), Sides(f"in {one}", f"in {other}"))
    for sentence in found or ["They answer the same questions, and are equal bit for bit."]:
        click.echo(printable(sentence))
    if found:
        raise SystemExit(1)


@learn.command("replay")
@click.argument("recording", type=_PATH)
@click.option("--set", "changes", multiple=True, metavar="KEY=VALUE", help="E.g. learn.step_size=0.1.")
@click.option("--from", "start", type=_PATH, help="Begin with what this snapshot knows.")
@click.option("--snapshot", "output", type=_PATH, help="Keep what is learned in this file.")
def replay_command(
    recording: Path, changes: tuple[str, ...], start: Path | None, output: Path | None
) -> None:
    """Learn again from RECORDING, and compare with what was learned live.

    It begins with what the session itself began with, which its recording carries, or with --from.
    """
    with errors_as_sentences(), Recording(recording) as found:
        chosen = single(changes)
        again = relearner(found.header, chosen)
        if start:
            _begin(_learners(again), start)
        keeping = _learners(again) if output else None
        last = _Last()
        comparison = compared(last.of(ticks(found.entries())), again)
        equal = comparison.ticks and comparison.equal == comparison.ticks
        click.echo("Bit for bit what was thought live." if equal else "Not what was thought live.")
        click.echo("\n".join(lines(comparison)))
        if keeping and output:
            size = write(output, taken(keeping, found.header.arm, last.wall, last.tick))
            click.echo(f"{output}: {size} bytes, what was learned up to tick {last.tick}")


class _Last:
    """The newest tick that was passed on: when a snapshot is as of does not depend on when it is made."""

    def __init__(self) -> None:
        self.tick = -1
        self.wall = 0.0  # s since the epoch

    def of(self, recorded: Iterable[Tick]) -> Iterator[Tick]:
        """The same ticks."""
        for tick in recorded:
            self.tick, self.wall = tick.frame.tick, tick.frame.wall
            yield tick


def _learners(again: Relearner) -> Keepable:
    if again.learners is None:
        raise Refused("the config of this recording has no learners that could be kept")
    return again.learners


def _begin(learners: Keepable, start: Path) -> None:
    """Raises SnapshotError: it is broken, or nothing of it can be gone on with."""
    snapshot = read(start)
    try:
        new = snapshot.give(learners)
    except (SnapshotError, ValueError) as error:
        raise SnapshotError(f"{start} cannot be gone on with: {error}") from error
    if new:
        click.echo("\n".join(["These begin anew:", *differences(learners.spec(), snapshot.spec)]))


@learn.command()
@click.argument("recording", type=_PATH)
@click.option(
    "--set", "changes", multiple=True, required=True, metavar="KEY=VALUE,…", help="learn.step_size=0.1,0.3"
)
@click.option("--jobs", type=click.IntRange(1, 1024), help="Processes at once; default: one a processor.")
@click.option("--scheduler", default="", metavar="ADDRESS", help="Of a Dask cluster: tcp://HOST:8786.")
@click.option(
    "--out", type=click.Path(path_type=Path, file_okay=False), help="Folder for a CSV and a figure."
)
def sweep(
    recording: Path, changes: tuple[str, ...], jobs: int | None, scheduler: str, out: Path | None
) -> None:
    """Learn from RECORDING with every combination of parameters, and compare the errors."""
    with errors_as_sentences():
        tried = points(grid(changes))
        with Recording(recording) as found:
            check(found.header, tried)
        draw = _prepared(out)
        run = _runner(jobs or len(os.sched_getaffinity(0)), scheduler)
        outcomes = run(partial(thought, recording.resolve()), tried, partial(_progress, len(tried)))
        head, *rows = table(outcomes)
        echo_table(head, rows)
        click.echo("\n" + "\n".join(map(printable, sentences(outcomes))))
        if out:
            (out / "sweep.csv").write_text(as_csv(outcomes), encoding="utf-8")
        if out and draw:
            draw(outcomes, out / "sweep.png")
    if any(outcome.failed for outcome in outcomes):
        raise SystemExit(1)


learn.add_command(merge)


def _prepared(out: Path | None) -> Draw | None:
    """Before long work, not after it: the folder, and what draws the figure, if that is installed."""
    if out is None:
        return None
    out.mkdir(parents=True, exist_ok=True)
    try:
        return cast("Draw", load_extra("bentod.analysis.sweep_figure:draw"))
    except MissingExtra as error:
        click.echo(f"There will be no figure: {error}", err=True)
        return None


def _runner(jobs: int, scheduler: str) -> Run:
    """What does the work: processes here, or a cluster."""
    if scheduler:
        there = cast("Callable[..., list[Outcome]]", load_extra("bentod.replay.sweep_cluster:run", ""))
        return partial(there, scheduler)
    here = cast("Callable[..., list[Outcome]]", load_extra("bentod.replay.sweep_pool:run", "sweep"))
    return partial(here, jobs)


def _progress(count: int, outcome: Outcome) -> None:
    came = outcome.failed or f"{outcome.relative:.4f} of the errors live"
    click.echo(printable(f"{outcome.point.place + 1} of {count}: {outcome.point}: {came}"), err=True)
