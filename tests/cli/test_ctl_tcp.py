"""`bentod ctl` over TCP: the token comes from a file, and from nowhere else."""

import asyncio
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from bentod.cli.ctl import ctl
from bentod.cli.watch import watch
from tests.serve.doors import OPERATOR, TLS, Files, strict

pytestmark = pytest.mark.real_time


@pytest.fixture
def files(tmp_path: Path) -> Files:
    return Files(tmp_path)


@pytest.fixture
def port(files: Files) -> Iterator[int]:
    """Of a server with TLS, in a thread of its own."""
    ready, end = threading.Event(), asyncio.Event()
    found: list[tuple[asyncio.AbstractEventLoop, int]] = []

    async def serve() -> None:
        async with strict(files.folder / "bentod.sock", tcp=files.with_tls()) as server:
            found.append((asyncio.get_running_loop(), server.addresses[0][1]))
            ready.set()
            await end.wait()

    thread = threading.Thread(target=asyncio.run, args=(serve(),))
    thread.start()
    assert ready.wait(10)
    loop, number = found[0]
    yield number
    loop.call_soon_threadsafe(end.set)
    thread.join(10)


def run(port: int, *words: str) -> Result:
    return CliRunner().invoke(ctl, ["--socket", f"tls://127.0.0.1:{port}", *words])


def test_ctl_moves_the_arm_over_tls_with_the_operators_token(port: int, files: Files) -> None:
    way = ["--token-file", str(files.folder / "operator"), "--ca-file", str(TLS / "certificate.pem")]
    result = run(port, *way, "call", "move")
    assert (result.exit_code, result.output) == (0, "moved\n")
    assert OPERATOR not in result.output


def test_ctl_finds_the_files_in_the_environment(
    port: int, files: Files, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("BENTOD_TOKEN_FILE", str(files.folder / "observer"))
    monkeypatch.setenv("BENTOD_CA_FILE", str(TLS / "certificate.pem"))
    monkeypatch.setenv("BENTOD_SOCKET", f"tls://127.0.0.1:{port}")
    result = CliRunner().invoke(ctl, ["call", "move"])
    assert result.exit_code == 1
    assert "move needs the role operator. Your token is the observer's." in result.stderr


def test_without_a_token_or_an_authority_ctl_says_what_is_missing(port: int, files: Files) -> None:
    result = run(port, "--ca-file", str(TLS / "certificate.pem"), "stop")
    assert (result.exit_code, "name its file in BENTOD_TOKEN_FILE" in result.stderr) == (2, True)
    result = run(port, "--token-file", str(files.folder / "operator"), "stop")
    assert (result.exit_code, "cannot prove who it is" in result.stderr) == (3, True)
    (files.folder / "operator").chmod(0o644)
    result = run(port, "--token-file", str(files.folder / "operator"), "stop")
    assert (result.exit_code, "open to others" in result.stderr) == (2, True)


def test_watch_says_what_is_missing_too(port: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("bentod.cli.watch.PATIENCE_S", 0.0)  # it asks once, and does not wait for a daemon
    result = CliRunner().invoke(watch, ["--socket", f"tls://127.0.0.1:{port}"])
    assert (result.exit_code, "cannot prove who it is" in result.stderr) == (3, True)
