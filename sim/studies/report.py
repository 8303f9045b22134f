"""What a study found, as files: one HTML page that stands alone, PNGs of its figures, CSVs of its numbers."""

import csv
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from bentod.analysis import page
from bentod.analysis.drawing import Drawn, save, style, svg
from bentod.analysis.page import Section
from bentod.contracts import Vector
from sim.studies.figures import draw, draw_chart
from sim.studies.study import CLAIM_HEAD, SETTING_HEAD, Findings, Listing, Study

NRMSE = (
    "NRMSE: root mean square error against the ideal prediction, as a share of the standard deviation of the "
    "latter, so that the best constant has 1."
)


def write(study: Study, findings: Findings, how: str, out: Path) -> tuple[Path, ...]:
    """Write everything into the folder `out`, which must be there. `how`: the command that does it again.

    Returns the paths.

    Raises:
        OSError: a file cannot be written.
    """
    with style():
        drawn = [draw(picture) for picture in findings.pictures]
        drawn += [draw_chart(chart) for chart in findings.charts]
    paths = [out / "report.html", out / "claims.csv", out / "settings.csv", out / "series.csv"]
    paths[0].write_text(_page(study, findings, drawn, how), encoding="utf-8")
    _rows(paths[1], CLAIM_HEAD, [claim.row for claim in findings.claims])
    _rows(paths[2], SETTING_HEAD, [(one.name, one.thesis, one.ours) for one in findings.settings])
    _columns(paths[3], findings.series)
    for listing in (Listing("comparison", "", findings.comparison), *findings.listings):
        paths.append(out / f"{listing.name}.csv")
        _rows(paths[-1], listing.rows[0], listing.rows[1:])
    for figure in drawn:
        paths.append(out / f"figure-{figure.name}.png")
        save(figure, paths[-1])
    return tuple(paths)


def _page(study: Study, findings: Findings, drawn: Sequence[Drawn], how: str) -> str:
    entries = tuple((f"figure-{figure.name}", figure.title) for figure in drawn)
    figures = "".join(
        page.figure(number, one.name, one.title, one.caption, svg(one), dict(one.numbers))
        for number, one in enumerate(drawn, 1)
    )
    settings = [(one.name, one.thesis, one.ours) for one in findings.settings]
    sections = (
        Section("claims", "What must come out, and does it?", _claims(findings)),
        Section("figures", "Figures", figures, entries),
        Section("comparison", "Beside others", page.table(findings.comparison[0], findings.comparison[1:])),
        *(_listing(listing) for listing in findings.listings),
        Section("settings", "Settings", page.table(SETTING_HEAD, settings, "settings-table")),
        Section("simulated", "What is simulated", _words(findings)),
        Section("again", "Run it again", page.block(how)),
    )
    return page.page(study.title, study.about, sections)


def _claims(findings: Findings) -> str:
    failed = sum(not claim.holds for claim in findings.claims)
    told = f"{failed} of {len(findings.claims)} claims do not hold." if failed else "Every claim holds."
    verdict = page.paragraph(told, "bad" if failed else "good")
    note = (
        "NRMSE: root mean square error against the ideal prediction, as a share of its standard deviation; "
    )
    rows = [claim.row for claim in findings.claims]
    return (
        verdict
        + page.table(CLAIM_HEAD, rows, "claims-table")
        + page.paragraph(note + "the best constant has 1.", "note")
    )


def _listing(listing: Listing) -> Section:
    told = page.paragraph(listing.note, "note") if listing.note else ""
    return Section(listing.name, listing.title, page.table(listing.rows[0], listing.rows[1:]) + told)


def _words(findings: Findings) -> str:
    return "".join(page.paragraph(text) for text in (findings.simulated, *findings.remarks))


def _rows(path: Path, head: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    with path.open("w", encoding="utf-8", newline="") as file:
        csv.writer(file).writerows([head, *rows])


def _columns(path: Path, series: Mapping[str, Vector]) -> None:
    """One row a step."""
    table = np.column_stack(list(series.values()))
    np.savetxt(path, table, fmt="%.7g", delimiter=",", header=",".join(series), comments="")
