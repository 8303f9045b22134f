"""A terminal taken over for a while: its own screen, keys without Enter; afterwards all is as it was."""

import os
import sys
import termios
import tty
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress

import click

_ENTER = "\x1b[?1049h\x1b[?25l\x1b[?2004h"  # alternate screen, no cursor, what is pasted in brackets
_LEAVE = "\x1b[?2004l\x1b[?25h\x1b[?1049l"

_USUAL = os.terminal_size((100, 40))


class Screen:
    """Where the view is drawn; `keys`: whether somebody can type."""

    def __init__(self) -> None:
        self.keys = sys.stdin.isatty() and sys.stdout.isatty()
        self._settings: list[object] | None = None

    def enter(self) -> None:
        """Take the terminal over."""
        if self.keys:
            self._settings = termios.tcgetattr(sys.stdin)
            tty.setcbreak(sys.stdin)
        click.echo(_ENTER, nl=False)

    def leave(self) -> None:
        """Give it back as it was, be it that it has gone away meanwhile."""
        with suppress(OSError, termios.error):
            if self._settings is not None:
                termios.tcsetattr(sys.stdin, termios.TCSADRAIN, self._settings)  # type: ignore[arg-type]
        self._settings = None
        with suppress(OSError):
            click.echo(_LEAVE, nl=False)

    def size(self) -> os.terminal_size:
        """Columns and lines of the window."""
        try:
            found = os.get_terminal_size(sys.stdout.fileno())
        except (OSError, ValueError):
            return _USUAL
        return found if found.columns and found.lines else _USUAL

    def draw(self, lines: Sequence[str]) -> None:
        """Show `lines` from the top, and nothing below them."""
        text = "\r\n".join(f"{line}\x1b[K" for line in lines)
        click.echo(f"\x1b[H{text}\x1b[J", nl=False)


@contextmanager
def settings_kept() -> Iterator[None]:
    """Afterwards the terminal takes keys as before, although a process that had changed that was killed."""
    if not sys.stdin.isatty():
        yield
        return
    before = termios.tcgetattr(sys.stdin)
    try:
        yield
    finally:
        with suppress(OSError, termios.error):
            termios.tcsetattr(sys.stdin, termios.TCSANOW, before)
