"""Pictures of studies as figures. Needs matplotlib."""

from collections.abc import Mapping

import numpy as np

from bentod.analysis.drawing import COLOURS, INK, Drawn, curve, panels
from bentod.frames import Value
from sim.studies.measures import nrmse
from sim.studies.study import Picture, Role

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
