"""How commands speak: tables, text that cannot steer a terminal, and errors as one sentence."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import click

from bentod.errors import BentodError


@contextmanager
def errors_as_sentences() -> Iterator[None]:
    """What goes wrong is a sentence and the exit code 1."""
    try:
        yield
    except BentodError as error:
        click.echo(f"bentod: {printable(str(error))}", err=True)
        raise SystemExit(1) from error
    except OSError as error:
        click.echo(f"bentod: {error.filename or 'a file'}: {error.strerror or error}", err=True)
        raise SystemExit(1) from error


def echo_table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """Aligned columns."""
    cells = [[printable(cell) for cell in row] for row in (head, *rows)]
    widths = [max(len(row[column]) for row in cells) for column in range(len(head))]
    for row in cells:
        padded = (cell.ljust(width) for cell, width in zip(row, widths, strict=True))
        click.echo("  ".join(padded).rstrip())


def printable(text: str) -> str:
    """`text` without what would steer the terminal: a client chooses its own name."""
    return "".join(letter if letter.isprintable() else "?" for letter in text)
