"""The campaign as a program: a table of every fault; it ends with 1 if a promise was broken."""

import asyncio
from collections.abc import Iterator
from pathlib import Path

import click

from sim.clock import run
from tests.system.campaign import bus_faults, emg_faults, host_faults, real_faults
from tests.system.campaign.case import Case, undergo
from tests.system.campaign.outcome import HEAD, Outcome, grouped, row, table, worst

VIRTUAL: tuple[Case, ...] = (*host_faults.CASES, *bus_faults.CASES, *emg_faults.CASES)

SEEDS = 10
"""Arms of each virtual fault, broken at different moments of different motions."""

REAL_TIMES = 2
"""How often each fault of a real process is tried."""

REAL_SLACK = 0.1
"""s that a machine with other work may add to what real processes do."""

BEGIN = "<!-- faults: made by `make faults` -->"
END = "<!-- end of faults -->"


def virtual(seeds: int = SEEDS) -> Iterator[Outcome]:
    """The faults of virtual time, each the worst of so many arms."""
    for case in VIRTUAL:
        yield worst([run(undergo(case, seed)) for seed in range(seeds)])


def real(times: int = REAL_TIMES) -> Iterator[Outcome]:
    """The faults of real processes, each the worst of so many times."""
    for case in real_faults.CASES:
        yield worst([asyncio.run(case()) for _ in range(times)])


def shown(outcomes: Iterator[Outcome]) -> Iterator[Outcome]:
    """The same, each as a row of the table as soon as it is there."""
    for seen in outcomes:
        click.echo(row(seen))
        yield seen


def broken(virtual: list[Outcome], real: list[Outcome]) -> list[str]:
    """Every promise that was not kept, as sentences."""
    found = [text for outcome in virtual for text in outcome.broken()]
    return found + [text for outcome in real for text in outcome.broken(REAL_SLACK)]


def renewed(page: str, rows: str) -> str:
    """`page` with its table replaced. Raises ValueError: it has no place for one."""
    before, after = page.index(BEGIN) + len(BEGIN), page.index(END)
    return f"{page[:before]}\n\n{rows}\n\n{page[after:]}"


@click.command()
@click.argument("readme", required=False, type=click.Path(path_type=Path, exists=True))
@click.argument("page", required=False, type=click.Path(path_type=Path, exists=True))
@click.option("--seeds", default=SEEDS, type=click.IntRange(min=1), help="Arms for each virtual fault.")
def main(readme: Path | None, page: Path | None, seeds: int) -> None:
    """Break everything around a simulated arm in motion; renew the table in PAGE, and its gist in README."""
    click.echo(HEAD)
    dreamt, done = list(shown(virtual(seeds))), list(shown(real()))
    seen = [*done, *dreamt]
    problems = broken(dreamt, done)
    for problem in problems:
        click.echo(problem, err=True)
    for file, rows in ((readme, grouped(seen)), (page, seen)):
        if file:
            file.write_text(renewed(file.read_text(encoding="utf-8"), table(rows)), encoding="utf-8")
    raise SystemExit(1 if problems else 0)


if __name__ == "__main__":
    main()
