"""Logging that never makes a tick wait: records leave the loop through a queue, a thread writes them."""

import logging
import os
import sys
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from logging.handlers import QueueHandler, QueueListener
from pathlib import Path
from queue import SimpleQueue
from typing import TextIO

LIMIT = 10_000
"""Records that may wait for a slow terminal or disk; more are dropped and counted."""

_SYSLOG = ((logging.ERROR, 3), (logging.WARNING, 4), (logging.INFO, 6), (logging.DEBUG, 7))


@contextmanager
def setup(level: str = "INFO", stream: TextIO | None = None, file: Path | None = None) -> Iterator[None]:
    """Log from `level` up to `stream` (default: standard error) and to the end of `file`, until the exit.

    Raises:
        OSError: `file` cannot be opened.
        ValueError: no such level.
    """
    with ExitStack() as stack:
        handlers = [_stream_handler(stream or sys.stderr)]
        if file is not None:
            handlers.append(_file_handler(file, stack))
        waiting: SimpleQueue[logging.LogRecord | None] = SimpleQueue()
        listener = QueueListener(waiting, *handlers)
        stack.enter_context(_root_logs(_Leaving(waiting), level))
        listener.start()
        stack.callback(listener.stop)
        yield


def journal_reads(stream: TextIO, environment: Mapping[str, str]) -> bool:
    """Whether `stream` is the one that systemd connected to the journal."""
    try:
        found = os.fstat(stream.fileno())
    except (OSError, ValueError):  # not a file at all, or closed
        return False
    return environment.get("JOURNAL_STREAM") == f"{found.st_dev}:{found.st_ino}"


class _Message(logging.Formatter):
    """The text of a record. A line break in it (a client chose its name) must not look like a new record."""

    def formatMessage(self, record: logging.LogRecord) -> str:  # noqa: N802, the base class's name
        return record.message.replace("\r", "\\r").replace("\n", "\\n")


class _Line(logging.Formatter):
    """Time, level, who, what."""

    default_msec_format = "%s.%03d"

    def __init__(self) -> None:
        super().__init__("%(asctime)s %(levelname)-7s %(name)s: %(message)s")


class _Journal(logging.Formatter):
    """Who and what, each line with the level's number in front; the journal keeps the time itself."""

    def __init__(self) -> None:
        super().__init__("%(name)s: %(message)s")

    def format(self, record: logging.LogRecord) -> str:
        number = next((number for level, number in _SYSLOG if record.levelno >= level), 7)
        return "\n".join(f"<{number}>{line}" for line in super().format(record).split("\n"))


class _Leaving(QueueHandler):
    """Puts records into the queue, and drops them when nobody empties it."""

    def __init__(self, waiting: SimpleQueue[logging.LogRecord | None]) -> None:
        super().__init__(waiting)
        self.setFormatter(_Message())
        self._waiting = waiting
        self._dropped = 0

    def enqueue(self, record: logging.LogRecord) -> None:
        if self._waiting.qsize() >= LIMIT:
            self._dropped += 1
            return
        if self._dropped:
            record.msg = f"{record.msg} [{self._dropped} records before this one were lost]"
            self._dropped = 0
        self._waiting.put_nowait(record)


def _stream_handler(stream: TextIO) -> logging.Handler:
    handler = logging.StreamHandler(stream)
    handler.setFormatter(_Journal() if journal_reads(stream, os.environ) else _Line())
    return handler


def _file_handler(file: Path, stack: ExitStack) -> logging.Handler:
    handler = logging.FileHandler(file, encoding="utf-8")
    stack.callback(handler.close)
    handler.setFormatter(_Line())
    return handler


@contextmanager
def _root_logs(handler: logging.Handler, level: str) -> Iterator[None]:
    root = logging.getLogger()
    before = root.level
    root.setLevel(level.upper())
    root.addHandler(handler)
    try:
        yield
    finally:
        root.removeHandler(handler)
        root.setLevel(before)
