"""`bentod study`: experiments of the thesis, run again in simulation, with what must come out checked."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import cast

import click

from bentod.analysis.extras import load_extra
from bentod.cli.telling import echo_table, errors_as_sentences
from bentod.errors import BadRequest, nearest
from sim.studies.catalogue import STUDIES
from sim.studies.study import CLAIM_HEAD, SETTING_HEAD, Findings, People, Study, Trials

Write = Callable[[Study, Findings, str, Path], Sequence[Path]]


@click.command()
@click.argument("name", required=False)
@click.option(
    "--seed", default=1, show_default=True, type=click.IntRange(0, 2**32 - 1), help="Of all chance."
)
@click.option("--minutes", type=float, help="Simulated; default: as long as the thesis, or as it takes.")
@click.option("--operators", type=click.IntRange(1, 200), help="How many take part, where any do.")
@click.option("--circuits", type=click.IntRange(1, 1000), help="Of each kind, where operators do them.")
@click.option("--modes", default="", help="Assists, with commas; default: all that the study knows.")
@click.option("--splits", type=click.IntRange(2, 1000), help="Into training and test data, where any are.")
@click.option("--sweep", is_flag=True, help="All parameters of all features, where there are features.")
@click.option(
    "--recording",
    "recordings",
    multiple=True,
    type=click.Path(path_type=Path),
    help="Of labelled muscle signals, to be tried too; may be given several times.",
)
@click.option("--jobs", default=1, show_default=True, type=click.IntRange(1, 64), help="Processes at once.")
@click.option("--out", type=click.Path(path_type=Path, file_okay=False), help="Folder; default: study-NAME.")
def study(
    name: str | None,
    seed: int,
    minutes: float | None,
    operators: int | None,
    circuits: int | None,
    modes: str,
    splits: int | None,
    sweep: bool,
    recordings: tuple[Path, ...],
    jobs: int,
    out: Path | None,
) -> None:
    """Run a study again: claims to the terminal; report, figures and numbers to a folder.

    Without NAME, tell what studies there are. Exits with 1 if a claim of the thesis does not come out.
    """
    if name is None:
        for known, one in STUDIES.items():
            click.echo(f"{known:10} {one.about}")
        return
    with errors_as_sentences():
        people = People(operators, circuits, tuple(filter(None, modes.split(","))), jobs)
        trials = Trials(operators, splits, sweep, recordings, jobs)
        held = _run(name, seed, minutes, (people, trials), out or Path(f"study-{name}"))
    raise SystemExit(0 if held else 1)


def _run(name: str, seed: int, minutes: float | None, asked: tuple[People, Trials], out: Path) -> bool:
    """Whether all claims hold.

    Raises:
        BadRequest: no such study, too short a time for it, or it knows no such people or assists.
        MissingExtra: there is no matplotlib.
        OSError: a file cannot be written.
    """
    chosen = _chosen(name)
    run, how = _ordered(chosen, name, seed, minutes, asked)
    write = cast("Write", load_extra("sim.studies.report:write"))
    out.mkdir(parents=True, exist_ok=True)  # before long work, not after it
    findings = run()
    _tell(chosen, findings)
    for path in write(chosen, findings, how, out):
        click.echo(str(path))
    return findings.hold


def _ordered(
    chosen: Study, name: str, seed: int, minutes: float | None, asked: tuple[People, Trials]
) -> tuple[Callable[[], Findings], str]:
    """What runs the study, and the command that does it again."""
    people, trials = asked
    tried, take_part = chosen.trials, chosen.people
    if tried is not None:
        return lambda: tried(seed, trials), f"bentod study {name} --seed {seed}{_tries(name, minutes, asked)}"
    _no_signals(name, trials)
    if take_part is not None:
        if minutes is not None:
            raise BadRequest(f"'{name}' takes as long as its operators do: use --circuits", "minutes")
        return lambda: take_part(seed, people), f"bentod study {name} --seed {seed}{people.words}"
    if people.words:
        raise BadRequest(f"no operators take part in '{name}':{people.words} means nothing", "operators")
    length = chosen.minutes if minutes is None else _long_enough(chosen, name, minutes)
    return lambda: chosen.run(seed, length), f"bentod study {name} --seed {seed} --minutes {length:g}"


def _tries(name: str, minutes: float | None, asked: tuple[People, Trials]) -> str:
    """The options that ask for these trials."""
    people, trials = asked
    if minutes is not None or people.circuits is not None or people.modes:
        raise BadRequest(f"'{name}' knows neither --minutes nor --circuits nor --modes", "minutes")
    return trials.words


def _no_signals(name: str, trials: Trials) -> None:
    words = replace(trials, people=None).words
    if words:
        raise BadRequest(f"no muscle signals are told apart in '{name}':{words} means nothing", "recording")


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
    for listing in findings.listings:
        click.echo(f"{listing.title}\n")
        echo_table(listing.rows[0], listing.rows[1:])
        click.echo(f"{listing.note}\n" if listing.note else "")
    echo_table(SETTING_HEAD, [(one.name, one.thesis, one.ours) for one in findings.settings])
    click.echo()
    for text in (findings.simulated, *findings.remarks):
        click.echo(f"{text}\n")
    failed = [claim for claim in findings.claims if not claim.holds]
    click.echo(f"{len(findings.claims) - len(failed)} of {len(findings.claims)} claims hold.\n")
