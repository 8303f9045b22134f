"""Where the page is: told to the user who serves it, for both roles, and no longer than it is served."""

from pathlib import Path

import pytest
from click.testing import CliRunner

from bentod.cli.dashboard import dashboard
from bentod.dashboard.page_file import Links, announced, page_file, told, told_links

PAGE = Links("http://127.0.0.1:8780/#one", "http://127.0.0.1:8780/#two")


@pytest.fixture
def socket(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    return tmp_path / "bentod.sock"


def test_both_addresses_are_kept_the_operators_first_while_the_page_is_served(socket: Path) -> None:
    with announced(socket, PAGE):
        assert page_file(socket).read_text() == f"{PAGE.operator}\n{PAGE.observer}\n"
        assert page_file(socket).stat().st_mode & 0o777 == 0o600
        assert told_links(socket) == PAGE
        assert told(socket) == PAGE.operator
    assert told_links(socket) is None
    assert told(socket) == ""


def test_what_another_page_has_told_meanwhile_stays(socket: Path) -> None:
    other = Links("http://127.0.0.1:8781/#three", "http://127.0.0.1:8781/#four")
    with announced(socket, other):
        with announced(socket, PAGE):
            page_file(socket).write_text(f"{other.operator}\n{other.observer}\n")
        assert told_links(socket) == other


def test_a_file_that_tells_something_else_tells_nothing(socket: Path) -> None:
    with announced(socket, PAGE):
        page_file(socket).write_text("one line\nand two more words\n")
        assert told_links(socket) is None


def test_both_addresses_are_printed_for_whoever_asks_where_the_page_is(socket: Path) -> None:
    with announced(socket, PAGE):
        told_where = CliRunner().invoke(dashboard, ["--where", "--socket", str(socket)])
    assert told_where.exit_code == 0
    assert told_where.output.splitlines() == [
        f"The page is at {PAGE.operator}",
        f"To look only:   {PAGE.observer}",
    ]
    assert CliRunner().invoke(dashboard, ["--where", "--socket", str(socket)]).exit_code == 1
