"""Pictures and charts of studies as figures. Needs matplotlib."""

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes

from bentod.analysis.drawing import COLOURS, INK, Drawn, blank, curve, panels
from bentod.frames import Value
from sim.studies.measures import nrmse
from sim.studies.study import Chart, Picture, Plot, Role

BLUE, RED, GREEN = COLOURS[0], COLOURS[1], COLOURS[2]

LOOKS: Mapping[Role, Mapping[str, object]] = {
    "target": {"color": BLUE, "linewidth": 1.0, "drawstyle": "steps-post", "label": "target"},
    "prediction": {"color": RED, "linewidth": 1.6, "label": "prediction"},
    "ideal": {"color": GREEN, "linewidth": 1.1, "linestyle": (0, (4, 2)), "label": "ideal prediction"},
}
"""As the thesis colours them: target blue, prediction red, ideal green and broken."""

ORDER: tuple[Role, ...] = ("target", "prediction", "ideal")


def draw(picture: Picture) -> Drawn:
    """A figure with a panel for each signal; to be called, and saved, in the style of `drawing`."""
    count = len(picture.panels)
    figure, axes = panels(0.9 + 1.5 * count, count)
    errors: dict[str, Value] = {}
    for panel, one in zip(axes, picture.panels, strict=True):
        for role in ORDER:
            if role in one.curves:
                gid = f"{one.title}.{role}"
                curve(panel, picture.time, one.curves[role], gid, **LOOKS[role])
        error = nrmse(one.curves["prediction"], one.curves["ideal"])
        errors[one.title] = error if np.isfinite(error) else None
        panel.set_title(one.title, color=INK)
        panel.set_ylim(-0.12, 1.18)
        panel.set_yticks([0, 0.5, 1])
        panel.set_xlim(float(picture.time[0]), float(picture.time[-1]))
    axes[-1].set_xlabel(picture.axis)
    axes[0].legend(loc="lower right", bbox_to_anchor=(1.0, 1.02), ncols=len(ORDER))
    return Drawn(picture.name, picture.title, picture.caption, figure, {"nrmse_shown": errors})


def draw_chart(chart: Chart) -> Drawn:
    """A figure with a pair of axes for each plot, row by row."""
    rows = -(-len(chart.plots) // chart.columns)
    figure = blank(0.6 + chart.height * rows)
    axes = figure.subplots(rows, chart.columns, squeeze=False).ravel().tolist()
    for panel, plot in zip(axes, chart.plots, strict=False):
        _plot(panel, plot)
    for panel in axes[len(chart.plots) :]:
        panel.set_axis_off()
    return Drawn(chart.name, chart.title, chart.caption, figure, {})


def _plot(panel: Axes, plot: Plot) -> None:
    for line in plot.lines:
        shape = {"marker": ".", "linestyle": "none"} if line.points else {"linewidth": line.width}
        panel.plot(line.x, line.y, color=line.colour, label=line.label or None, **shape)
    panel.set_title(plot.title, color=INK)
    panel.set_xlabel(plot.x_axis)
    panel.set_ylabel(plot.y_axis)
    if plot.ticks:
        panel.set_xticks(range(len(plot.ticks)), plot.ticks)
    if plot.equal:
        panel.set_aspect("equal", adjustable="datalim")
    if any(line.label for line in plot.lines):
        panel.legend(loc="best")
