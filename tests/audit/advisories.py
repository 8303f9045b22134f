"""Whether an advisory is known for any version in constraints.txt: `python -m tests.audit.advisories`."""

import json
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypedDict

import click

CONSTRAINTS = Path(__file__).parents[2] / "constraints.txt"

PATIENCE = 300.0
"""s for all questions together."""

VULNERABLE, UNANSWERED = 1, 3
"""Exit codes; the second only with --strict."""


class Advisory(TypedDict):
    """One known weakness, as pip-audit tells it."""

    id: str
    fix_versions: list[str]


class Entry(TypedDict, total=False):
    """One package, as pip-audit tells it."""

    name: str
    version: str
    vulns: list[Advisory]
    skip_reason: str


@dataclass(frozen=True, slots=True)
class Audit:
    """What came of asking."""

    asked: int  # packages
    vulnerable: tuple[str, ...] = ()  # a sentence each
    unanswered: tuple[str, ...] = ()  # why nothing is known of some or all packages

    @property
    def complete(self) -> bool:
        """Whether every package was answered for."""
        return not self.unanswered


def ask(constraints: Path, extra: Sequence[str] = ()) -> Audit:
    """Ask the advisory service about every pinned version; a service that is out of reach is no exception."""
    command = [sys.executable, "-m", "pip_audit", "--vulnerability-service=osv", "--format=json"]
    pins = ["--no-deps", "--disable-pip", "--progress-spinner=off", f"--requirement={constraints}"]
    try:
        done = subprocess.run([*command, *pins, *extra], capture_output=True, text=True, timeout=PATIENCE)
    except subprocess.TimeoutExpired:
        return Audit(pinned(constraints), unanswered=(f"no answer within {PATIENCE:g} s",))
    return understood(done.stdout, done.stderr, pinned(constraints))


def pinned(constraints: Path) -> int:
    """How many versions a file pins."""
    lines = constraints.read_text(encoding="utf-8").splitlines()
    return sum("==" in line for line in lines if not line.startswith("#"))


def understood(output: str, complaints: str, asked: int) -> Audit:
    """What pip-audit's JSON says; without JSON, its last complaint is the reason."""
    try:
        entries: list[Entry] = json.loads(output)["dependencies"]
    except (ValueError, KeyError, TypeError):
        why = (complaints.strip().splitlines() or ["pip-audit said nothing"])[-1]
        return Audit(asked, unanswered=(why,))
    unanswered = [f"{entry['name']}: {entry['skip_reason']}" for entry in entries if "skip_reason" in entry]
    if len(entries) < asked:
        unanswered.append(f"{asked - len(entries)} of {asked} packages were left out")
    vulnerable = [_sentence(entry, found) for entry in entries for found in entry.get("vulns", [])]
    return Audit(asked, tuple(vulnerable), tuple(unanswered))


def _sentence(entry: Entry, advisory: Advisory) -> str:
    fixes = ", ".join(advisory["fix_versions"]) or "no version yet"
    return f"{entry['name']} {entry['version']}: {advisory['id']}, mended in {fixes}."


def verdict(audit: Audit, strict: bool) -> int:
    """Say what was found; the exit code."""
    for sentence in audit.vulnerable:
        click.echo(f"VULNERABLE  {sentence}", err=True)
    if audit.unanswered:
        click.echo(
            "NOT AUDITED: nothing is known of what follows. Ask again where the service can be reached.",
            err=True,
        )
        for why in audit.unanswered:
            click.echo(f"NOT AUDITED  {why}", err=True)
    elif not audit.vulnerable:
        click.echo(f"No advisory is known for any of the {audit.asked} pinned versions.")
    if audit.vulnerable:
        return VULNERABLE
    return UNANSWERED if strict and not audit.complete else 0


@click.command()
@click.option("--strict", is_flag=True, help="Fail when the service cannot be reached, too.")
def main(strict: bool) -> None:
    """Fail if an advisory is known for a version that bentod is tested with."""
    raise SystemExit(verdict(ask(CONSTRAINTS), strict))


if __name__ == "__main__":
    main()
