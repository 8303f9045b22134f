"""Line charts as SVG, written by hand: a plot is no reason for a dependency."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

Points: TypeAlias = Sequence[tuple[float, float]]

WIDTH, HEIGHT = 420, 300
LEFT, RIGHT, TOP, BOTTOM = 52, 16, 34, 46

COLOURS = ("#1b7837", "#d95f02", "#7570b3", "#666666", "#1f78b4", "#a6761d")


@dataclass(frozen=True, slots=True)
class Panel:
    """One chart."""

    title: str
    across: str  # label of the axis
    up: str
    lines: Mapping[str, Points]  # by name; the same name has the same colour in every panel


def figure(panels: Sequence[Panel]) -> str:
    """`panels` side by side, with one legend below."""
    names = list(dict.fromkeys(name for panel in panels for name in panel.lines))
    colours = {name: COLOURS[at % len(COLOURS)] for at, name in enumerate(names)}
    width, height = WIDTH * len(panels), HEIGHT + 26
    body = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" '
        f'height="{height}" font-family="sans-serif" font-size="12">',
        f'<rect width="{width}" height="{height}" fill="white"/>',
    ]
    for at, panel in enumerate(panels):
        body += [f'<g transform="translate({at * WIDTH} 0)">', *_panel(panel, colours), "</g>"]
    for at, name in enumerate(names):
        x = LEFT + at * (width - LEFT) / len(names)
        body.append(_line([(x, HEIGHT + 6), (x + 24, HEIGHT + 6)], colours[name]))
        body.append(_text(x + 30, HEIGHT + 10, name, "start"))
    return "\n".join([*body, "</svg>", ""])


def _panel(panel: Panel, colours: Mapping[str, str]) -> Iterable[str]:
    points = [point for line in panel.lines.values() for point in line]
    right = max(x for x, _ in points)
    step = _step(max(y for _, y in points))
    top = step * (int(max(y for _, y in points) / step) + 1)

    def place(x: float, y: float) -> tuple[float, float]:
        across, up = WIDTH - LEFT - RIGHT, HEIGHT - TOP - BOTTOM
        return LEFT + across * x / right, HEIGHT - BOTTOM - up * y / top

    yield _text(WIDTH / 2, 18, panel.title, "middle", bold=True)
    for count in range(round(top / step) + 1):
        y = place(0, count * step)[1]
        yield f'<path d="M{LEFT} {y:.1f}H{WIDTH - RIGHT}" stroke="#ddd"/>'
        yield _text(LEFT - 6, y + 4, f"{count * step:g}", "end")
    for x in sorted({x for x, _ in points}):
        yield _text(place(x, 0)[0], HEIGHT - BOTTOM + 16, f"{x:g}", "middle")
    yield _text(WIDTH / 2, HEIGHT - 12, panel.across, "middle")
    yield f'<g transform="translate(14 {HEIGHT / 2}) rotate(-90)">{_text(0, 0, panel.up, "middle")}</g>'
    for name, line in panel.lines.items():
        placed = [place(x, y) for x, y in line]
        yield _line(placed, colours[name])
        yield from (f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" fill="{colours[name]}"/>' for x, y in placed)


def _step(greatest: float) -> float:
    """Between two lines of the grid: 1, 2 or 5 of a power of ten, for four to eight lines."""
    candidates = [digit * 10.0**power for power in range(-3, 4) for digit in (1, 2, 5)]
    return next((step for step in candidates if greatest / step <= 8), candidates[-1])


def _line(points: Points, colour: str) -> str:
    path = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
    return f'<polyline points="{path}" fill="none" stroke="{colour}" stroke-width="2"/>'


def _text(x: float, y: float, text: str, anchor: str, bold: bool = False) -> str:
    weight = ' font-weight="bold"' if bold else ""
    escaped = text.replace("&", "&amp;").replace("<", "&lt;")
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}"{weight}>{escaped}</text>'
