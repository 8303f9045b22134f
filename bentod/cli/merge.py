"""`bentod learn merge`: one snapshot of what several arms have learned."""

from pathlib import Path

import click

from bentod.cli.telling import errors_as_sentences
from bentod.learn.merge import merge as merged
from bentod.learn.snapshot import read, write

_PATH = click.Path(path_type=Path)


@click.command()
@click.argument("snapshots", type=_PATH, nargs=-1, required=True)
@click.option("--out", type=_PATH, required=True, help="File for what they know together.")
@click.option("--weights", default="", metavar="W,W,…", help="How much each counts; left out, all the same.")
def merge(snapshots: tuple[Path, ...], out: Path, weights: str) -> None:
    """Merge SNAPSHOTS of arms that answer the same questions from the same representations.

    Of every feature each arm counts as often as it was where that feature is active.
    """
    with errors_as_sentences():
        counts = _numbers(weights) if weights else [1.0] * len(snapshots)
        if out.exists():
            raise click.UsageError(f"{out} exists already")
        found = merged([read(path) for path in snapshots], counts, [str(path) for path in snapshots])
        size = write(out, found)
    click.echo(f"{out}: {size} bytes, what {len(snapshots)} snapshots know together")


def _numbers(text: str) -> list[float]:
    try:
        return [float(word) for word in text.split(",")]
    except ValueError:
        raise click.UsageError(f"--weights {text!r}: must be numbers with commas between them") from None
