"""A session as one HTML page: what was asked, what happened, why, and whether anything is missing."""

from collections.abc import Callable
from pathlib import Path

from bentod.analysis import figures, figures_health, overview, page, tasks
from bentod.analysis.circuits import circuits
from bentod.analysis.drawing import Drawn, save, style, svg
from bentod.analysis.material import Material, gather
from bentod.analysis.overview import Overview
from bentod.analysis.page import Section
from bentod.analysis.stream import UnfitRecording
from bentod.errors import BadRequest, nearest
from bentod.record.reader import Recording

Draw = Callable[[Material], Drawn]

FIGURES: dict[str, Draw] = {
    "joints": figures.joints,
    "plane": figures.plane,
    "holders": figures.holders,
    "predictions": figures.predictions,
    "learning": figures.learning,
    "trials": figures.trials,
    "emg": figures_health.emg,
    "lateness": figures_health.lateness,
    "timeline": figures_health.timeline,
}
"""What can be drawn."""

_CHAPTERS = (
    ("trials", "Trials", ("trials",)),
    ("arm", "What the arm did, and by whom", ("joints", "plane", "holders")),
    ("expected", "What was expected", ("predictions", "learning")),
    ("muscles", "Muscles", ("emg",)),
    ("time", "Events and punctuality", ("timeline", "lateness")),
)


def plot(
    recording: Recording, what: str, out: Path, start: float | None = None, end: float | None = None
) -> None:
    """Draw one of FIGURES, from `start` to `end` (s since the session started), to a .png, .svg or .pdf.

    Raises:
        BadRequest: there is no such figure, or no such kind of file.
        BentodError: the recording cannot be read, or does not hold what the figure shows.
        OSError: the file cannot be written.
    """
    if what not in FIGURES:
        raise BadRequest(f"there is no figure '{what}'{nearest(what, FIGURES)}", "what")
    material = gather(recording, start, end)
    with style():
        drawn = FIGURES[what](material)
    save(drawn, out)


def report(recording: Recording) -> str:
    """The page of a recording. Raises BentodError: it cannot be read, or holds no tick."""
    found = overview.overview(recording)
    material = gather(recording)
    sections = [_glance(found), _completeness(found)]
    number = 1
    for name, title, drawn in _CHAPTERS:
        html, entries = _trials(recording) if name == "trials" else "", []
        for figure in drawn:
            part, number = _figure(material, figure, number)
            html += part
            entries.append((f"figure-{figure}", FIGURE_TITLES[figure]))
        sections.append(Section(name, title, html, tuple(entries)))
    sections += [_happened(found), _origin(found)]
    subtitle = (
        f"{found.header.arm} · {overview.wall_time(found.header.started_wall)} · "
        f"{overview.duration(found.info.duration)} · {overview.state(found.info)}"
    )
    return page.page(f"Session {found.header.session}", subtitle, sections)


FIGURE_TITLES = {
    "joints": "Joint paths",
    "plane": "Path in joint space",
    "holders": "Who moved each joint",
    "predictions": "Predictions against ideal returns",
    "learning": "Prediction error over time",
    "trials": "Toggles and time per trial",
    "emg": "Muscle signals",
    "lateness": "Punctuality and costs",
    "timeline": "What happened when",
}


def _figure(material: Material, name: str, number: int) -> tuple[str, int]:
    """A figure, or why there is none, and the number of the next."""
    try:
        with style():
            drawn = FIGURES[name](material)
    except UnfitRecording as reason:
        text = f"{FIGURE_TITLES[name]}: {reason}."
        return f'<div id="figure-{name}">{page.paragraph(text, "note")}</div>\n', number
    html = page.figure(number, name, drawn.title, drawn.caption, svg(drawn), dict(drawn.numbers))
    return html, number + 1


def _glance(found: Overview) -> Section:
    rows = [line.strip().partition(" ") for line in overview.sentences(found)[1:]]
    cells = [(first, rest.strip()) for first, _, rest in rows]
    return Section("glance", "At a glance", page.table(("", ""), cells, "glance-table"))


def _completeness(found: Overview) -> Section:
    look = "good" if found.info.whole else "bad"
    verdict = "".join(page.paragraph(_sentence(line), look) for line in overview.missing(found.info))
    rows = overview.completeness(found.info)
    html = verdict + page.table(overview.COMPLETENESS_HEAD, rows, "completeness-table")
    return Section("completeness", "Is anything missing?", html + _gaps(found))


def _sentence(line: str) -> str:
    return f"Missing: {line}."


def _gaps(found: Overview) -> str:
    gaps = [("ticks", gap) for gap in found.info.tick_gaps]
    gaps += [("EMG samples", gap) for gap in found.info.emg_gaps]
    since = found.header.started
    rows = [
        (what, f"{gap.start - since:.3f}", f"{gap.end - since:.3f}", str(gap.missing)) for what, gap in gaps
    ]
    listed = page.table(("what", "from (s)", "to (s)", "missing"), rows, "gaps-table")
    return page.folded(f"{len(rows)} gaps", listed) if rows else ""


def _trials(recording: Recording) -> str:
    found = circuits(recording)
    if not found:
        return page.paragraph("There is no trial in this recording.", "note")
    rows = tasks.table(tasks.summaries(found))
    html = page.table(tasks.HEAD, rows, "trials-table")
    html += "".join(page.paragraph(tasks.sentence(one)) for one in tasks.comparisons(found))
    html += page.paragraph(tasks.HOW, "note") + page.paragraph(tasks.CAVEAT, "note")
    listed = page.table(tasks.CIRCUIT_HEAD, [tasks.circuit_row(one) for one in found], "circuits-table")
    return html + page.folded("Every circuit", listed)


def _happened(found: Overview) -> Section:
    since = found.header.started
    rows = [(f"{event.time - since:.2f}", event.kind, event.text) for event in found.important]
    html = (
        page.table(("s", "kind", "what"), rows, "events-table")
        if rows
        else page.paragraph("No fault, and no complaint of a servo or of the recorder.", "good")
    )
    counts = ", ".join(f"{count} {kind}" for kind, count in sorted(found.events.items())) or "none"
    return Section(
        "events", "Faults and complaints", html + page.paragraph(f"Events in all: {counts}.", "note")
    )


def _origin(found: Overview) -> Section:
    header = found.header
    rows = [(name, version) for name, version in header.versions.items()]
    rows += [("schema", str(header.schema)), *(("file", path.name) for path in found.info.files)]
    html = page.table(("what", "version"), rows, "versions-table")
    html += page.folded(f"The config, {header.config_name or 'without a name'}", page.block(header.config))
    return Section("origin", "Config and versions", html)
