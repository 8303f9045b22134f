"""Figures of the arm: where it went, what was expected, who moved it, and how trials went."""

import math
from collections.abc import Iterable, Sequence

import numpy as np
from matplotlib.axes import Axes

from bentod.analysis import numbers
from bentod.analysis.circuits import Circuit
from bentod.analysis.drawing import (
    COLOURS,
    GREY,
    INK,
    Drawn,
    blank,
    colour,
    conditions,
    curve,
    legend_beside,
    name_trials,
    panels,
    shade_trials,
    time_axis,
)
from bentod.analysis.material import Material
from bentod.analysis.statistics import describe
from bentod.analysis.stream import UnfitRecording
from bentod.analysis.table import Floats
from bentod.frames import Value

SHOWN_S = 60.0
"""The figure of predictions shows the last so many seconds in which they can be judged."""


def joints(material: Material) -> Drawn:
    """Each joint's path, and where it was expected."""
    names = material.joints
    figure, axes = panels(0.4 + 1.05 * len(names), len(names))
    for name, panel in zip(names, axes, strict=True):
        shade_trials(panel, material)
        curve(panel, material.time, material.position(name), f"joints.{name}", color=colour(names, name))
        panel.set_title(name)
        panel.set_ylabel("rad")
    time_axis(axes[-1], material)
    name_trials(axes[0], material)
    found: dict[str, Value] = {name: _range(material.position(name)) for name in names}
    shaded = " Shaded: trials, by condition." if material.circuits else ""
    return Drawn("joints", "Joint paths", f"Position of each joint as read (rad).{shaded}", figure, found)


def _range(values: Floats) -> dict[str, Value]:
    return {
        "min_rad": float(np.nanmin(values)),
        "max_rad": float(np.nanmax(values)),
        "travel_rad": float(np.nansum(np.abs(np.diff(values)))),
    }


def plane(material: Material) -> Drawn:
    """The path in the plane of two joints, one curve for each condition: thesis Figures 5.4 and 5.9."""
    names = (*material.setup.predicting, *material.joints)
    x, y = list(dict.fromkeys(name for name in names if name in material.joints))[:2]
    figure = blank(4.6)
    axes = figure.subplots()
    known, time = conditions(material), material.ticks.floats("time_s")
    curves = _by_condition(material.circuits, time) if known else {"": np.ones(len(time), dtype=bool)}
    for number, (condition, inside) in enumerate(curves.items()):
        across = np.where(inside, material.position(x), np.nan)
        label = condition or "(no condition)"
        (line,) = axes.plot(across, material.position(y), color=COLOURS[number % len(COLOURS)], label=label)
        line.set_gid(f"plane.{condition or 'all'}")
        line.set_linewidth(0.8)
    axes.set_xlabel(f"{x} (rad)")
    axes.set_ylabel(f"{y} (rad)")
    if known:
        legend_beside(axes)
    ticks: dict[str, Value] = {condition: int(inside.sum()) for condition, inside in curves.items()}
    caption = (
        f"Path in the plane of {x} and {y}, during trials, by condition."
        if known
        else (f"Path in the plane of {x} and {y}, over the whole recording: there are no trials.")
    )
    return Drawn("plane", "Path in joint space", caption, figure, {"ticks": ticks})


def _by_condition(circuits: Sequence[Circuit], time: Floats) -> dict[str, np.ndarray]:
    inside: dict[str, np.ndarray] = {}
    for circuit in circuits:
        during = (time >= circuit.start) & (time < circuit.start + circuit.time)
        inside[circuit.condition] = inside.get(circuit.condition, np.zeros(len(time), dtype=bool)) | during
    return inside


def predictions(material: Material) -> Drawn:
    """Position, prediction and ideal return over the last minute that can be judged: thesis Figure 5.5."""
    found = numbers.prediction_errors(material)
    if not found:
        raise UnfitRecording(f"{material.header.session} holds no predictions that can be judged")
    chosen = _chosen(material, found)
    figure, axes = panels(0.5 + 2.0 * len(chosen), len(chosen))
    for name, panel in zip(chosen, axes, strict=True):
        _expectations(panel, material, name)
    axes[0].legend(loc="lower left", bbox_to_anchor=(0.0, 1.08), ncols=6)
    time_axis(axes[-1], material)
    end = _judged_until(material, chosen[0])
    axes[-1].set_xlim(max(float(material.time[0]), end - SHOWN_S), end)
    caption = (
        "Position (thin), prediction (solid) and ideal return (dashed, what a perfect learner would have "
        f"expected, thesis 5.3) for each timescale in steps, over the last {SHOWN_S:g} s of which the "
        "returns are known. Numbers: root mean square of prediction minus ideal return, whole recording."
    )
    rms: dict[str, Value] = {name: {**by_scale} for name, by_scale in found.items()}
    return Drawn("predictions", "Predictions against ideal returns", caption, figure, {"rms_rad": rms})


def _chosen(material: Material, found: Iterable[str]) -> list[str]:
    """The joints that predictions are made from, or the first two of those that are predicted."""
    return [name for name in found if name in material.setup.predicting] or list(found)[:2]


def _expectations(panel: Axes, material: Material, joint: str) -> None:
    time = material.time
    shown = time >= _judged_until(material, joint) - SHOWN_S
    position = material.position(joint)[shown]
    curve(panel, time[shown], position, f"predictions.{joint}", color=INK, linewidth=0.8, label="position")
    for number, (scale, expected) in enumerate(material.predictions(joint).items()):
        look = {"color": COLOURS[number % len(COLOURS)]}
        ideal = numbers.ideal(material, joint, float(scale))[shown]
        gid = f"predictions.{joint}.{scale}"
        curve(panel, time[shown], expected[shown], gid, label=f"predicted, {scale}", **look)
        curve(panel, time[shown], ideal, f"{gid}.ideal", linestyle="--", label=f"ideal, {scale}", **look)
    panel.set_title(joint)
    panel.set_ylabel("rad")


def _judged_until(material: Material, joint: str) -> float:
    """Seconds since the start of the last tick of which the longest returns are known."""
    longest = max(map(float, material.predictions(joint)))
    known = np.flatnonzero(np.isfinite(numbers.ideal(material, joint, longest)))
    return float(material.time[known[-1]]) if len(known) else float(material.time[-1])


def learning(material: Material) -> Drawn:
    """How the error of predictions changed in the course of the recording."""
    found = numbers.prediction_errors(material)
    if not found:
        raise UnfitRecording(f"{material.header.session} holds no predictions that can be judged")
    edges = np.linspace(material.time[0], material.time[-1] + 1e-9, 25)
    middle = (edges[:-1] + edges[1:]) / 2
    figure = blank(2.6)
    axes = figure.subplots()
    series: dict[str, Value] = {}
    for joint in _chosen(material, found):
        scales = found[joint]
        for style, scale in zip(("-", "--", ":", "-."), scales, strict=False):
            error = material.predictions(joint)[scale] - numbers.ideal(material, joint, float(scale))
            values = numbers.binned_rms(material.time, error, edges)
            look = {"color": colour(material.joints, joint), "linestyle": style}
            curve(axes, middle, values, f"learning.{joint}.{scale}", label=f"{joint}, {scale}", **look)
            series[f"{joint}.{scale}"] = [None if math.isnan(v) else float(v) for v in values]
    axes.set_ylabel("RMS error (rad)")
    axes.set_ylim(bottom=0)
    legend_beside(axes)
    time_axis(axes, material)
    caption = "Root mean square of prediction minus ideal return, by joint and timescale in steps."
    return Drawn("learning", "Prediction error over time", caption, figure, {"rms_rad": series})


def holders(material: Material) -> Drawn:
    """Who moved each joint: shares of its way."""
    ways = numbers.way_by_holder(material)
    known = list(dict.fromkeys(holder for found in ways.values() for holder in found))
    known.sort(key=lambda holder: holder in (numbers.NOBODY, numbers.UNKNOWN))
    figure = blank(0.9 + 0.32 * len(ways))
    axes = figure.subplots()
    left = np.zeros(len(ways))
    for holder in known:
        rest = holder in (numbers.NOBODY, numbers.UNKNOWN)
        shares = np.array([found.get(holder, 0.0) / (sum(found.values()) or 1.0) for found in ways.values()])
        look = "#d4d7dc" if rest else colour(known, holder)
        bars = axes.barh(list(ways), 100 * shares, left=100 * left, color=look, label=holder, height=0.7)
        for joint, bar in zip(ways, bars, strict=True):
            bar.set_gid(f"holders.{joint}.{holder}")
        left += shares
    axes.invert_yaxis()
    axes.set_xlim(0, 100)
    axes.set_xlabel("share of the joint's way (%)")
    axes.grid(visible=False, axis="y")
    legend_beside(axes)
    caption = (
        "Who held each joint while it travelled: muscles (emg), the assist, a client by name, going home, or "
        "the mode that stopped it. Nobody: it coasted, sagged, or its reading was noisy."
    )
    rad: dict[str, Value] = {joint: {**found} for joint, found in ways.items()}
    return Drawn("holders", "Who moved each joint", caption, figure, {"way_rad": rad})


def trials(material: Material) -> Drawn:
    """Toggles and time of each circuit, and means with standard errors: thesis Figure 5.10."""
    circuits = [circuit for circuit in material.circuits if circuit.whole]
    if not circuits:
        raise UnfitRecording(f"{material.header.session} holds no trial that came to its end")
    figure = blank(4.2)
    axes = figure.subplots(2, 2, width_ratios=[3.2, 1], sharey="row")
    toggles = [float(circuit.toggles) for circuit in circuits]
    times = [circuit.time for circuit in circuits]
    for row, (values, label) in enumerate(((toggles, "toggles"), (times, "circuit time (s)"))):
        _bars(axes[row, 0], circuits, values, conditions(material), label)
        _means(axes[row, 1], circuits, values, conditions(material))
    axes[1, 0].set_xlabel("circuit")
    caption = (
        "Toggles and time of each circuit, by condition; right: means with their standard errors. How "
        "circuits and toggles are counted is said with the table of trials."
    )
    found: dict[str, Value] = {"toggles": list(map(int, toggles)), "time_s": list(times)}
    return Drawn("trials", "Toggles and time per trial", caption, figure, found)


def _bars(
    axes: Axes, circuits: Sequence[Circuit], values: Sequence[float], known: list[str], label: str
) -> None:
    colours = [colour(known, circuit.condition) for circuit in circuits]
    bars = axes.bar(range(1, len(values) + 1), values, color=colours)
    for number, bar in enumerate(bars, 1):
        bar.set_gid(f"trials.{label.split()[0]}.{number}")
    axes.set_ylabel(label)
    axes.grid(visible=False, axis="x")


def _means(axes: Axes, circuits: Sequence[Circuit], values: Sequence[float], known: list[str]) -> None:
    for at, condition in enumerate(known):
        chosen = [v for c, v in zip(circuits, values, strict=True) if c.condition == condition]
        if not chosen:
            continue
        found = describe(chosen)
        error = 0.0 if math.isnan(found.deviation) else found.error
        axes.bar(at, found.mean, yerr=error, color=colour(known, condition), capsize=3, ecolor=GREY)
    axes.set_xticks(range(len(known)), [condition or "(none)" for condition in known])
    axes.grid(visible=False, axis="x")
