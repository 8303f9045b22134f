"""How figures look, and how they become files that are the same each time. Needs matplotlib."""

import io
import re
import warnings
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from bentod.analysis.circuits import Circuit
from bentod.analysis.material import Material
from bentod.analysis.numbers import thin
from bentod.analysis.table import Floats
from bentod.errors import BadRequest
from bentod.frames import Value

COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#7a5195", "#8c6d31")
"""Told apart by colour-blind readers: Okabe and Ito, https://jfly.uni-koeln.de/color/ (and two more)."""

GREY = "#8a8f98"
INK = "#22262e"
ALARM = "#c0392b"

STYLE: Mapping[str, object] = {
    "svg.hashsalt": "bentod",  # else the same figure has other names inside each time
    "svg.fonttype": "none",
    "pdf.fonttype": 42,
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"],
    "font.size": 9,
    "text.parse_math": False,  # a condition may have dollars in its name
    "axes.titlesize": 9,
    "axes.titlelocation": "left",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.edgecolor": GREY,
    "axes.labelcolor": INK,
    "axes.grid": True,
    "grid.color": "#e6e8ec",
    "grid.linewidth": 0.7,
    "axes.axisbelow": True,
    "xtick.color": INK,
    "ytick.color": INK,
    "lines.linewidth": 1.1,
    "legend.frameon": False,
    "legend.fontsize": 8,
    "figure.facecolor": "white",
    "savefig.dpi": 160,
}

WIDTH = 7.2
"""Inches: a page of a paper, both columns."""

_METADATA: Mapping[str, dict[str, None]] = {
    "svg": {"Date": None},
    "pdf": {"CreationDate": None},
    "png": {"Software": None},
}
"""No time of making in the file."""


@dataclass(frozen=True, slots=True)
class Drawn:
    """A figure with its words, and the numbers that it shows."""

    name: str
    title: str
    caption: str
    figure: Figure
    numbers: Mapping[str, Value]


@contextmanager
def style() -> Iterator[None]:
    """While entered, figures are made and saved as bentod's."""
    with mpl.rc_context(dict(STYLE)), warnings.catch_warnings():  # type: ignore[arg-type]
        warnings.filterwarnings("ignore", message="Glyph .* missing")  # a name may be in any script
        yield


def blank(height: float) -> Figure:
    """An empty figure of `height` inches, known to no window and no global list, so that nothing stays."""
    return Figure(figsize=(WIDTH, height), layout="constrained")


def panels(height: float, rows: int, shared: bool = True) -> tuple[Figure, list[Axes]]:
    """A figure with panels below one another, on one time axis if `shared`."""
    figure = blank(height)
    axes = figure.subplots(rows, 1, sharex=shared, squeeze=False)
    return figure, list(axes[:, 0])


def save(drawn: Drawn, path: Path) -> None:
    """Write a figure as the kind of file that the name says.

    Raises:
        BadRequest: there is no such kind of file.
        OSError: it cannot be written.
    """
    kind = path.suffix.removeprefix(".").lower()
    if kind not in _METADATA:
        raise BadRequest(f"a figure can be .{', .'.join(_METADATA)}, not '{path.name}'", "output")
    with style():
        drawn.figure.savefig(path, format=kind, metadata=_METADATA[kind])


def svg(drawn: Drawn) -> str:
    """A figure as an SVG element to be put into a page, with names of its own for its parts."""
    buffer = io.StringIO()
    with style():
        drawn.figure.savefig(buffer, format="svg", metadata=_METADATA["svg"])
    text = buffer.getvalue()
    text = text[text.index("<svg") :]
    text = re.sub(r"<metadata>.*?</metadata>", "", text, flags=re.DOTALL)  # it names addresses
    mine = f"{drawn.name}-"
    text = re.sub(r'\bid="', f'id="{mine}', text)
    text = re.sub(r"url\(#", f"url(#{mine}", text)
    return re.sub(r'xlink:href="#', f'xlink:href="#{mine}', text)


def curve(axes: Axes, x: Floats, y: Floats, gid: str, **look: object) -> None:
    """A line that can be found in the file by `gid`."""
    thin_x, thin_y = thin(x, y)
    (line,) = axes.plot(thin_x, thin_y, **look)  # type: ignore[arg-type]
    line.set_gid(gid)


def colour(names: Sequence[str], name: str) -> str:
    """Always the same colour for the same one of `names`."""
    return COLOURS[names.index(name) % len(COLOURS)]


def conditions(material: Material) -> list[str]:
    """The conditions of the trials, in the order of time."""
    return list(dict.fromkeys(circuit.condition for circuit in material.circuits))


def shade_trials(axes: Axes, material: Material) -> None:
    """Mark when trials ran, by the colour of their condition."""
    known = conditions(material)
    for circuit in material.circuits:
        begin = circuit.start - material.header.started
        axes.axvspan(begin, begin + circuit.time, color=_of(known, circuit), alpha=0.10, linewidth=0)


def legend_beside(axes: Axes) -> None:
    """Say which colour is what, to the right of the panel, if there is anything to be said."""
    if axes.get_legend_handles_labels()[0]:
        axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))


def name_trials(axes: Axes, material: Material) -> None:
    """Say above the panel which colour is which condition."""
    known = conditions(material)
    patches = [Patch(color=colour(known, one), alpha=0.3, label=one or "(no condition)") for one in known]
    if patches:
        axes.legend(handles=patches, loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=len(patches))


def _of(known: Sequence[str], circuit: Circuit) -> str:
    return colour(known, circuit.condition)


def time_axis(axes: Axes, material: Material) -> None:
    """Name the time axis, and let it end where the ticks end."""
    axes.set_xlabel("time since the session started (s)")
    time = material.time
    if time[-1] > time[0]:
        axes.set_xlim(float(time[0]), float(time[-1]))
