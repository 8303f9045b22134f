import io
import logging
import os
import re
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import TextIO

import pytest

from bentod import logs

LOGGER = logging.getLogger("bentod.arm")


@pytest.fixture
def journal(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[TextIO]:
    with (tmp_path / "journal").open("w+") as stream:
        found = os.fstat(stream.fileno())
        monkeypatch.setenv("JOURNAL_STREAM", f"{found.st_dev}:{found.st_ino}")
        yield stream


def test_a_record_becomes_one_line_with_time_level_and_name() -> None:
    stream = io.StringIO()
    with logs.setup("info", stream):
        LOGGER.info("joint %d is home", 3)
    assert re.fullmatch(
        r"\d{4}-\d\d-\d\d \d\d:\d\d:\d\d\.\d{3} INFO    bentod\.arm: joint 3 is home\n", stream.getvalue()
    )


def test_a_message_cannot_pretend_to_be_two() -> None:
    stream = io.StringIO()
    with logs.setup("info", stream):
        LOGGER.info("client %s left", "x\n2026-01-01 00:00:00.000 ERROR fake")
    assert len(stream.getvalue().splitlines()) == 1


def test_records_below_the_level_are_not_written() -> None:
    stream = io.StringIO()
    with logs.setup("warning", stream):
        LOGGER.info("calm")
        LOGGER.warning("degraded")
    assert "calm" not in stream.getvalue()
    assert "degraded" in stream.getvalue()


def test_a_traceback_follows_its_message() -> None:
    stream = io.StringIO()
    with logs.setup("info", stream):
        try:
            raise ValueError("bad")
        except ValueError:
            LOGGER.exception("tick failed")
    assert stream.getvalue().splitlines()[0].endswith("tick failed")
    assert stream.getvalue().endswith("ValueError: bad\n")


def test_the_journal_is_given_a_level_on_every_line(journal: TextIO) -> None:
    with logs.setup("debug", journal):
        LOGGER.info("up")
        LOGGER.warning("late")
        LOGGER.debug("detail")
        LOGGER.error("broken", exc_info=ValueError("bad"))
    journal.seek(0)
    lines = journal.read().splitlines()
    assert lines[:3] == ["<6>bentod.arm: up", "<4>bentod.arm: late", "<7>bentod.arm: detail"]
    assert lines[3:] == ["<3>bentod.arm: broken", "<3>ValueError: bad"]


def test_another_stream_than_the_journals_is_written_for_people(journal: TextIO) -> None:
    assert logs.journal_reads(journal, os.environ)
    assert not logs.journal_reads(io.StringIO(), os.environ)
    assert not logs.journal_reads(journal, {})


def test_a_file_gets_the_lines_too_and_keeps_its_old_ones(tmp_path: Path) -> None:
    file = tmp_path / "bentod.log"
    for word in ("first", "second"):
        with logs.setup("info", io.StringIO(), file):
            LOGGER.info(word)
    assert [line.rsplit(" ", 1)[-1] for line in file.read_text().splitlines()] == ["first", "second"]


def test_the_writer_is_another_thread_and_everything_is_written_before_the_exit() -> None:
    writers: list[str] = []

    class Stream(io.StringIO):
        def write(self, text: str) -> int:
            writers.append(threading.current_thread().name)
            return super().write(text)

    stream = Stream()
    with logs.setup("info", stream):
        for k in range(100):
            LOGGER.info("%d", k)
    assert len(stream.getvalue().splitlines()) == 100
    assert threading.current_thread().name not in writers


def test_a_stuck_stream_costs_records_not_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    may_write, is_writing = threading.Event(), threading.Event()

    class Stuck(io.StringIO):
        def write(self, text: str) -> int:
            is_writing.set()
            may_write.wait(10)
            return super().write(text)

    monkeypatch.setattr(logs, "LIMIT", 5)
    stream = Stuck()
    with logs.setup("info", stream):
        LOGGER.info("first")
        is_writing.wait(10)
        for k in range(8):
            LOGGER.info("waiting %d", k)
        may_write.set()
        while "waiting 4" not in stream.getvalue():
            pass
        LOGGER.info("after")
    lines = stream.getvalue().splitlines()
    assert len(lines) == 7
    assert lines[-1].endswith("after [3 records before this one were lost]")


def test_logging_is_as_before_after_the_exit() -> None:
    root = logging.getLogger()
    level, handlers = root.level, list(root.handlers)
    with logs.setup("debug", io.StringIO()):
        assert root.level == logging.DEBUG
    assert (root.level, root.handlers) == (level, handlers)


def test_a_level_that_does_not_exist_is_refused() -> None:
    with pytest.raises(ValueError, match="LOUD"), logs.setup("loud", io.StringIO()):
        pass


def test_a_file_that_cannot_be_opened_is_an_error_at_once(tmp_path: Path) -> None:
    with (
        pytest.raises(FileNotFoundError),
        logs.setup("info", io.StringIO(), tmp_path / "missing" / "bentod.log"),
    ):
        pass
