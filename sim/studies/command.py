"""`bentod study`: experiments of the thesis, run again in simulation, with what must come out checked."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import cast

import click

from bentod.analysis.extras import load_extra
from bentod.cli.telling import echo_table, errors_as_sentences
from bentod.errors import BadRequest, nearest
from sim.studies.catalogue import STUDIES
from sim.studies.study import CLAIM_HEAD, SETTING_HEAD, Findings, Study

Write = Callable[[Study, Findings, str, Path], Sequence[Path]]


@click.command()
@click.argument("name", required=False)
@click.option(
    "--seed", default=1, show_default=True, type=click.IntRange(0, 2**32 - 1), help="Of all chance."
)
@click.option("--minutes", type=float, help="Simulated; default: as long as the thesis, or as it takes.")
@click.option("--out", type=click.Path(path_type=Path, file_okay=False), help="Folder; default: study-NAME.")
def study(name: str | None, seed: int, minutes: float | None, out: Path | None) -> None:
    """Run a study again: claims to the terminal; report, figures and numbers to a folder.

    Without NAME, tell what studies there are. Exits with 1 if a claim of the thesis does not come out.
    """
    if name is None:
        for known, one in STUDIES.items():
            click.echo(f"{known:10} {one.about}")
        return
    with errors_as_sentences():
        held = _run(name, seed, minutes, out or Path(f"study-{name}"))
    raise SystemExit(0 if held else 1)


def _run(name: str, seed: int, minutes: float | None, out: Path) -> bool:
    """Whether all claims hold.

    Raises:
        BadRequest: no such study, or too short a time for it.
        MissingExtra: there is no matplotlib.
        OSError: a file cannot be written.
    """
    chosen = _chosen(name)
    length = chosen.minutes if minutes is None else _long_enough(chosen, name, minutes)
    write = cast("Write", load_extra("sim.studies.report:write"))
    out.mkdir(parents=True, exist_ok=True)  # before long work, not after it
    findings = chosen.run(seed, length)
    _tell(chosen, findings)
    how = f"bentod study {name} --seed {seed} --minutes {length:g}"
    for path in write(chosen, findings, how, out):
        click.echo(str(path))
    return findings.hold


def _chosen(name: str) -> Study:
    if name not in STUDIES:
        raise BadRequest(f"there is no study '{name}'{nearest(name, STUDIES)}", "name")
    return STUDIES[name]


def _long_enough(chosen: Study, name: str, minutes: float) -> float:
    if not chosen.least_minutes <= minutes <= 1000:
        raise BadRequest(
            f"--minutes {minutes:g}: '{name}' takes {chosen.least_minutes:g} to 1000 minutes", "minutes"
        )
    return minutes


def _tell(chosen: Study, findings: Findings) -> None:
    click.echo(f"{chosen.title}\n")
    echo_table(CLAIM_HEAD, [claim.row for claim in findings.claims])
    click.echo()
    echo_table(findings.comparison[0], findings.comparison[1:])
    click.echo()
    echo_table(SETTING_HEAD, [(one.name, one.thesis, one.ours) for one in findings.settings])
    click.echo()
    for text in (findings.simulated, *findings.remarks):
        click.echo(f"{text}\n")
    failed = [claim for claim in findings.claims if not claim.holds]
    click.echo(f"{len(findings.claims) - len(failed)} of {len(findings.claims)} claims hold.\n")
