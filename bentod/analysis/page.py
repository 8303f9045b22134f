"""One HTML page that stands alone: no script, no request, the same bytes each time."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

from bentod.frames import Value

STYLE = """
:root { color-scheme: light; --ink: #22262e; --soft: #5c6470; --line: #dfe2e7; --wash: #f6f7f9; }
* { box-sizing: border-box; }
body { margin: 0; color: var(--ink); background: #fff; font: 15px/1.55 system-ui, "DejaVu Sans", sans-serif; }
.sheet { display: grid; grid-template-columns: 15rem minmax(0, 56rem); gap: 2.5rem; max-width: 76rem;
         margin: 0 auto; padding: 2rem 1.5rem 5rem; }
nav { position: sticky; top: 1.5rem; align-self: start; font-size: 13.5px; }
nav ol { list-style: none; margin: 0; padding: 0; } nav li { margin: .2rem 0; }
nav ol ol { padding-left: 1rem; color: var(--soft); }
a { color: inherit; text-decoration: none; } a:hover { text-decoration: underline; }
h1 { font-size: 1.55rem; line-height: 1.25; margin: 0 0 .3rem; }
.sub { color: var(--soft); margin: 0 0 1.5rem; }
h2 { font-size: 1.15rem; margin: 2.6rem 0 .7rem; padding-top: .6rem; border-top: 1px solid var(--line); }
h3 { font-size: .95rem; margin: 1.6rem 0 .4rem; }
figure { margin: 1.2rem 0 2rem; } figure svg { width: 100%; height: auto; display: block; }
figcaption { font-size: 13.5px; color: var(--soft); margin-top: .5rem; } figcaption b { color: var(--ink); }
.wide { overflow-x: auto; } table { border-collapse: collapse; font-size: 13px; margin: .6rem 0; }
th, td { text-align: left; padding: .28rem .8rem .28rem 0; border-bottom: 1px solid var(--line);
         vertical-align: top; font-variant-numeric: tabular-nums; white-space: nowrap; }
td:last-child { white-space: normal; } th { color: var(--soft); font-weight: 600; }
pre { background: var(--wash); padding: 1rem; font-size: 12px; line-height: 1.45; overflow-x: auto; }
summary { cursor: pointer; color: var(--soft); font-size: 13px; }
.good, .bad { padding: .6rem .9rem; border-left: 4px solid #009e73; background: #eef8f4; margin: .6rem 0; }
.bad { border-color: #c0392b; background: #fbefed; } .note { color: var(--soft); font-size: 13.5px; }
@media (max-width: 60rem) { .sheet { display: block; } nav { position: static; margin-bottom: 2rem; } }
@media print { nav { display: none; } .sheet { display: block; } figure { break-inside: avoid; } }
"""

POLICY = "default-src 'none'; style-src 'unsafe-inline'; img-src data:"
"""What a browser may do for the page: draw it. What a client called itself cannot become more than text."""


@dataclass(frozen=True, slots=True)
class Section:
    """A part of the page."""

    id: str
    title: str
    html: str
    entries: tuple[tuple[str, str], ...] = ()  # id and title of what the table of contents lists below it


def page(title: str, subtitle: str, sections: Sequence[Section]) -> str:
    """The whole page."""
    body = "\n".join(
        f'<section id="{section.id}"><h2>{escape(section.title)}</h2>\n{section.html}</section>'
        for section in sections
    )
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        f'<meta http-equiv="Content-Security-Policy" content="{POLICY}">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{escape(title)}</title>\n<style>{STYLE}</style>\n</head>\n<body>\n"
        f'<div class="sheet">\n<nav aria-label="Contents"><ol>{_contents(sections)}</ol></nav>\n<main>\n'
        f'<h1>{escape(title)}</h1>\n<p class="sub">{escape(subtitle)}</p>\n{body}\n</main>\n</div>\n'
        "</body>\n</html>\n"
    )


def _contents(sections: Sequence[Section]) -> str:
    return "".join(
        f"<li>{_link(section.id, section.title)}"
        + (
            f"<ol>{''.join(f'<li>{_link(*entry)}</li>' for entry in section.entries)}</ol>"
            * bool(section.entries)
        )
        + "</li>"
        for section in sections
    )


def _link(target: str, title: str) -> str:
    return f'<a href="#{target}">{escape(title)}</a>'


def paragraph(text: str, look: str = "") -> str:
    """A paragraph of plain text."""
    return f'<p class="{look}">{escape(text)}</p>\n' if look else f"<p>{escape(text)}</p>\n"


def table(head: Sequence[str], rows: Sequence[Sequence[str]], name: str = "") -> str:
    """A table of plain texts."""
    cells = "".join(f'<th scope="col">{escape(title)}</th>' for title in head)
    lines = "".join(f"<tr>{''.join(f'<td>{escape(cell)}</td>' for cell in row)}</tr>\n" for row in rows)
    mark = f' id="{name}"' if name else ""
    inner = f"<thead><tr>{cells}</tr></thead>\n<tbody>{lines}</tbody>"
    return f'<div class="wide"><table{mark}>{inner}</table></div>\n'


def block(text: str) -> str:
    """Text as it is, e.g. a config file."""
    return f"<pre>{escape(text)}</pre>\n"


def folded(title: str, html: str) -> str:
    """What is shown on a click."""
    return f"<details><summary>{escape(title)}</summary>\n{html}</details>\n"


def figure(number: int, name: str, title: str, caption: str, svg: str, numbers: Value) -> str:
    """A figure with its caption and, for programs, its numbers."""
    data = json.dumps(numbers, ensure_ascii=False, sort_keys=True).replace("</", "<\\/")
    labelled = svg.replace("<svg", f'<svg role="img" aria-label="{escape(title, quote=True)}"', 1)
    return (
        f'<figure id="figure-{name}">\n{labelled}\n<figcaption><b>Figure {number}. {escape(title)}.</b> '
        f"{escape(caption)}</figcaption>\n"
        f'<script type="application/json" id="numbers-{name}">{data}</script>\n</figure>\n'
    )
