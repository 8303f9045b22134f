"""`bentod recording`: what a recording holds, as sentences, figures, tables, and in other formats."""

import errno
import shutil
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TypeVar, cast

import click

from bentod.analysis import overview, tasks
from bentod.analysis.circuits import circuits
from bentod.analysis.columns import as_json
from bentod.analysis.export import FORMATS, export
from bentod.analysis.extras import load_extra
from bentod.analysis.stream import TABLES, UnfitRecording
from bentod.cli.telling import echo_table, errors_as_sentences, printable
from bentod.errors import BadRequest, Refused
from bentod.record.reader import Recording, parts_of
from bentod.record.recover import recover

_PATH = click.Path(path_type=Path)

_FILE = click.argument("file", type=_PATH)
_FILES = click.argument("files", type=_PATH, nargs=-1, required=True, metavar="FILE...")
_JSON = click.option("--json", "as_data", is_flag=True, help="As JSON, for programs.")

FIGURES = ("joints", "plane", "holders", "predictions", "learning", "trials", "emg", "lateness", "timeline")

Found = TypeVar("Found")
Plot = Callable[[Recording, str, Path, float | None, float | None], None]
Report = Callable[[Recording], str]


@click.group()
def recording() -> None:
    """Look into recordings. FILE is any part of a session, or its folder."""


@recording.command()
@_FILES
@_JSON
def info(files: Sequence[Path], as_data: bool) -> None:
    """Tell what recordings hold, and what is missing from them."""
    with errors_as_sentences():
        found = [_with(file, overview.overview) for file in files]
        if as_data:
            click.echo(as_json([overview.as_data(one) for one in found]))
            return
        for one in found:
            click.echo("\n".join(map(printable, overview.sentences(one))))


@recording.command("recover")
@_FILE
@click.option("-o", "--output", type=_PATH, help="Mend a copy, and leave FILE as it is.")
def recover_command(file: Path, output: Path | None) -> None:
    """Mend a recording that was cut off, and say what was saved and what is lost.

    FILE is mended in place; as it was found it is kept beside, ending in .cut. Of a folder, every part is.
    """
    with errors_as_sentences():
        if output is None:
            for part in parts_of(file) if file.is_dir() else [file]:
                click.echo(printable(str(recover(part))))
            return
        if output.exists():
            raise Refused(f"{output} exists already; remove it, or choose another place with -o")
        shutil.copyfile(file, output)
        mended = recover(output)
        if mended.aside:
            mended.aside.unlink()
        click.echo(printable(str(replace(mended, aside=file if mended.aside else None))))


@recording.command("tasks")
@_FILES
@_JSON
def tasks_command(files: Sequence[Path], as_data: bool) -> None:
    """Count time, toggles and contacts of trials, by participant and condition."""
    with errors_as_sentences():
        found = [circuit for file in files for circuit in _with(file, circuits)]
        if not found:
            names = ", ".join(str(file) for file in files)
            raise UnfitRecording(f"{names}: there is no trial, so there is nothing to count")
        if as_data:
            click.echo(as_json(tasks.as_data(found)))
            return
        summaries = tasks.summaries(found)
        echo_table(tasks.HEAD, tasks.table(summaries))
        click.echo()
        echo_table(tasks.CIRCUIT_HEAD, [tasks.circuit_row(circuit) for circuit in found])
        lines = [*map(tasks.sentence, tasks.comparisons(found)), tasks.HOW, tasks.CAVEAT]
        click.echo("\n" + "\n".join(map(printable, lines)))


@recording.command("export")
@_FILE
@click.option("--format", "kind", type=click.Choice(list(FORMATS)), required=True)
@click.option("-o", "--output", type=_PATH, help="The folder to make; default: SESSION-FORMAT, here.")
@click.option("--topics", default=",".join(TABLES), show_default=True, help="Which tables, with commas.")
def export_command(file: Path, kind: str, output: Path | None, topics: str) -> None:
    """Write tables with one column a quantity, and a dictionary of what the columns mean."""
    with errors_as_sentences(), Recording(file) as found:
        _require_ticks(found)
        out = output or Path(f"{found.header.session}-{kind}")
        _require_folder(out)
        rows = export(found, kind, out, [topic.strip() for topic in topics.split(",") if topic.strip()])
        told = ", ".join(f"{count} {table}" for table, count in rows.items())
        click.echo(f"{out}: {told}; the columns are explained in {out / 'dictionary.json'}")


@recording.command()
@_FILE
@click.option("-o", "--output", type=_PATH, required=True, help="A .png, .svg or .pdf.")
@click.option("--what", type=click.Choice(FIGURES), default="joints", show_default=True)
@click.option("--from", "start", type=float, help="Seconds since the session started.")
@click.option("--to", "end", type=float, help="Seconds since the session started.")
def plot(file: Path, output: Path, what: str, start: float | None, end: float | None) -> None:
    """Draw one figure."""
    with errors_as_sentences():
        if start is not None and end is not None and end <= start:
            raise BadRequest(f"--to {end:g} must be after --from {start:g}", "to")
        _require_folder(output)
        draw = cast("Plot", load_extra("bentod.analysis.report:plot"))
        _with(file, lambda found: draw(found, what, output, start, end))
        click.echo(str(output))


@recording.command()
@_FILE
@click.option("-o", "--output", type=_PATH, required=True, help="The .html to write.")
def report(file: Path, output: Path) -> None:
    """Make one HTML page with every figure and table of a session."""
    with errors_as_sentences():
        _require_folder(output)
        make = cast("Report", load_extra("bentod.analysis.report:report"))
        output.write_text(_with(file, make), encoding="utf-8")
        click.echo(str(output))


def _require_folder(output: Path) -> None:
    """Before long work, not after it."""
    if not output.absolute().parent.is_dir():
        raise NotADirectoryError(errno.ENOTDIR, "there is no such folder", str(output.parent))


def _require_ticks(found: Recording) -> None:
    if not found.info.counts.total:
        raise UnfitRecording(f"{found.header.session} is empty; there is nothing to export")


def _with(file: Path, use: Callable[[Recording], Found]) -> Found:
    """What `use` finds in a recording."""
    with Recording(file) as found:
        return use(found)
