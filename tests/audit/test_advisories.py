"""The audit fails on what is known, and says aloud what it could not find out."""

import importlib.util
import json
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, HTTPServer
from pathlib import Path

import pytest

from tests.audit.advisories import (
    CONSTRAINTS,
    UNANSWERED,
    VULNERABLE,
    Audit,
    ask,
    pinned,
    understood,
    verdict,
)


def told(*dependencies: dict[str, object]) -> str:
    return json.dumps({"dependencies": dependencies, "fixes": []})


SOUND: dict[str, object] = {"name": "numpy", "version": "2.4.6", "vulns": []}
WEAK: dict[str, object] = {
    "name": "click",
    "version": "8.0",
    "vulns": [{"id": "PYSEC-1", "fix_versions": ["8.1"], "aliases": [], "description": "Oh."}],
}
SKIPPED: dict[str, object] = {"name": "msgpack", "skip_reason": "not found"}


@pytest.mark.parametrize("strict", [False, True])
def test_a_known_weakness_fails_the_audit_by_name(strict: bool, capsys: pytest.CaptureFixture[str]) -> None:
    audit = understood(told(SOUND, WEAK, SKIPPED), "", 3)
    assert verdict(audit, strict) == VULNERABLE
    assert "VULNERABLE  click 8.0: PYSEC-1, mended in 8.1." in capsys.readouterr().err


def test_nothing_known_passes(capsys: pytest.CaptureFixture[str]) -> None:
    assert verdict(understood(told(SOUND), "", 1), strict=True) == 0
    assert "any of the 1 pinned versions" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("output", "complaint", "why"),
    [
        ("", "Traceback\nConnectionError: no route", "ConnectionError: no route"),
        ("", "", "pip-audit said nothing"),
        ("[]", "", "pip-audit said nothing"),
        (told(SKIPPED), "", "msgpack: not found"),
        (told(), "", "1 of 1 packages were left out"),
    ],
)
def test_what_was_not_answered_is_told_and_fails_only_the_strict(
    output: str, complaint: str, why: str, capsys: pytest.CaptureFixture[str]
) -> None:
    audit = understood(output, complaint, 1)
    assert verdict(audit, strict=False) == 0
    assert f"NOT AUDITED  {why}" in capsys.readouterr().err
    assert verdict(audit, strict=True) == UNANSWERED


def test_every_pin_is_counted() -> None:
    assert pinned(CONSTRAINTS) > 30


@contextmanager
def advisory_service(weak: str) -> Iterator[str]:
    """A service that knows one advisory, of `weak`; its address."""

    class Answers(BaseHTTPRequestHandler):
        def do_POST(self) -> None:
            asked = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
            known = [ADVISORY] if asked["package"]["name"] == weak else []
            body = json.dumps({"vulns": known} if known else {}).encode()
            self.send_response(200)
            self.send_header("Content-Length", str(len(body)))
            self.end_headers()
            self.wfile.write(body)

        def log_message(self, format: str, *args: object) -> None:
            pass

    with HTTPServer(("127.0.0.1", 0), Answers) as server:
        thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01})
        thread.start()
        try:
            yield f"http://127.0.0.1:{server.server_port}/v1/query"
        finally:
            server.shutdown()
            thread.join()


ADVISORY = {
    "id": "PYSEC-0000-1",
    "summary": "Oh.",
    "published": "2026-01-01T00:00:00Z",
    "modified": "2026-01-01T00:00:00Z",
    "affected": [
        {
            "package": {"name": "click", "ecosystem": "PyPI"},
            "ranges": [{"type": "ECOSYSTEM", "events": [{"introduced": "0"}, {"fixed": "9.9"}]}],
            "versions": ["8.5.1"],
        }
    ],
}


@pytest.mark.skipif(importlib.util.find_spec("pip_audit") is None, reason="pip-audit is not installed")
def test_the_tool_itself_is_understood(tmp_path: Path) -> None:
    pins = tmp_path / "pins.txt"
    pins.write_text("click==8.5.1\nnumpy==2.4.6\n")
    with advisory_service("click") as address:
        found = ask(pins, [f"--osv-url={address}"])
    assert found == Audit(2, ("click 8.5.1: PYSEC-0000-1, mended in 9.9.",))
    gone = ask(pins, [f"--osv-url={address}"])
    assert (gone.vulnerable, gone.complete) == ((), False)
