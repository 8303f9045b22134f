"""Figures of the measuring itself: muscles, punctuality, events, and what is missing."""

import math
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

from bentod.analysis import numbers
from bentod.analysis.drawing import (
    ALARM,
    COLOURS,
    GREY,
    Drawn,
    blank,
    curve,
    panels,
    shade_trials,
    time_axis,
)
from bentod.analysis.material import Levels, Material
from bentod.analysis.setup import SiteSetup
from bentod.analysis.stream import UnfitRecording
from bentod.frames import Value
from bentod.record.session import Gap

MODES = ("limp", "holding", "paused", "active", "fault")
_MODE_COLOURS = ("#d4d7dc", "#b8c4d6", "#e69f00", "#009e73", ALARM)


def emg(material: Material) -> Drawn:
    """Level of each site with its threshold and maximum."""
    levels = material.levels
    if levels is None:
        raise UnfitRecording(f"{material.header.session} holds no EMG")
    channels = range(levels.volts.shape[1])
    named = [site for site in material.setup.sites if site.channel in channels]
    shown = named or [SiteSetup(f"channel {n}", n, 1.0, math.nan, math.nan) for n in channels]
    figure, axes = panels(0.5 + 1.15 * len(shown), len(shown))
    time = material.since_start(levels.time)
    for number, (site, panel) in enumerate(zip(shown, axes, strict=True)):
        shade_trials(panel, material)
        volts = site.gain * levels.volts[:, site.channel]
        look = COLOURS[number % len(COLOURS)]
        curve(panel, time, 1e6 * volts, f"emg.{site.name}", color=look, linewidth=0.7)
        for value, line in ((site.threshold, "--"), (site.maximum, ":")):
            panel.axhline(1e6 * value, color=GREY, linestyle=line, linewidth=0.9)
        panel.set_title(site.name)
        panel.set_ylabel("µV")
        panel.set_ylim(bottom=0)
    time_axis(axes[-1], material)
    caption = (
        "Mean absolute value of each site over the controller's window, after gain (the greatest of each "
        "50 ms). Dashed: threshold, dotted: maximum, as the config has them; changes during the session are "
        "among the commands."
    )
    shares: dict[str, Value] = {**numbers.levels_above(material)}
    return Drawn("emg", "Muscle signals", caption, figure, {"share_above_threshold": shares} | _peak(levels))


def _peak(levels: Levels) -> dict[str, Value]:
    return {"levels": len(levels.time), "channels": levels.volts.shape[1]}


def lateness(material: Material) -> Drawn:
    """Histogram of lateness, and what the phases of a tick cost."""
    figure = blank(2.8)
    left, right = figure.subplots(1, 2, width_ratios=[1.5, 1])
    values = 1e3 * material.ticks.floats("lateness_s")
    values = values[np.isfinite(values)]
    spread = max(float(values.max() - values.min()), 0.1)
    counts, edges = np.histogram(values, bins=60, range=(float(values.min()), float(values.min()) + spread))
    patches = left.stairs(counts, edges, fill=True, color=COLOURS[0])
    patches.set_gid("lateness.histogram")
    left.set_yscale("symlog", linthresh=1)
    left.set_xlabel("start of the tick after its deadline (ms)")
    left.set_ylabel("ticks")
    found = numbers.punctuality(material)
    _costs(right, found, 1e3 / material.header.rate_hz)
    caption = (
        f"Left: lateness of {len(values)} ticks, logarithmic above 1 tick. Right: median (bar) and 99th "
        f"percentile (line) of the phases of a tick, whose period is {1e3 / material.header.rate_hz:.1f} ms."
    )
    told: dict[str, Value] = {name: {**one} for name, one in numbers.plain(found).items()}
    told["histogram"] = [int(count) for count in counts]
    return Drawn("lateness", "Punctuality and costs", caption, figure, told)


def _costs(axes: Axes, found: dict[str, numbers.Spread], period: float) -> None:
    for at, cost in enumerate(numbers.COSTS):
        one = found[cost]
        axes.barh(at, 1e3 * one.median, color=COLOURS[0], height=0.6)
        axes.plot([1e3 * one.median, 1e3 * one.p99], [at, at], color=GREY)
    axes.set_yticks(range(len(numbers.COSTS)), numbers.COSTS)
    axes.invert_yaxis()
    axes.set_xlabel("ms")
    axes.grid(visible=False, axis="y")
    most = max(1e3 * found[cost].p99 for cost in numbers.COSTS)
    axes.set_xlim(0, most * 1.1 if most > 0 else period)


def timeline(material: Material) -> Drawn:
    """Modes, events by kind, and where ticks or samples are missing."""
    events = numbers.events_by_kind(material)
    figure, (upper, lower) = panels(1.6 + 0.24 * (len(events) + 3), 2)
    _modes(upper, material)
    rows = [*sorted(events, key=lambda kind: kind != "fault"), "EMG gaps", "tick gaps"]
    for at, kind in enumerate(rows[:-2]):
        look = ALARM if kind == "fault" else COLOURS[at % len(COLOURS)]
        (dots,) = lower.plot(events[kind], np.full(len(events[kind]), at), "|", color=look, markersize=9)
        dots.set_gid(f"timeline.{kind}")
    _gaps(lower, material, material.info.emg_gaps, len(rows) - 2)
    _gaps(lower, material, material.info.tick_gaps, len(rows) - 1)
    lower.set_yticks(range(len(rows)), rows)
    lower.set_ylim(len(rows) - 0.5, -0.5)
    time_axis(lower, material)
    caption = (
        "Above: the mode of the arm. Below: events by kind, and where EMG samples or ticks are missing "
        "(red; an empty row: none). Shaded: trials."
    )
    counts: dict[str, Value] = {kind: len(times) for kind, times in events.items()}
    return Drawn("timeline", "What happened when", caption, figure, {"events": counts})


def _modes(axes: Axes, material: Material) -> None:
    codes, labels = material.ticks.coded("mode")
    for start, end, code in numbers.stretches(material.time, codes):
        at = MODES.index(labels[code]) if labels[code] in MODES else 0
        axes.broken_barh([(start, max(end - start, 1e-3))], (at - 0.4, 0.8), color=_MODE_COLOURS[at])
    axes.set_yticks(range(len(MODES)), MODES)
    axes.set_ylim(-0.6, len(MODES) - 0.4)
    shade_trials(axes, material)


def _gaps(axes: Axes, material: Material, gaps: Sequence[Gap], row: int) -> None:
    since = material.header.started
    spans = [(gap.start - since, max(gap.end - gap.start, 1e-3)) for gap in gaps]
    axes.broken_barh(spans, (row - 0.35, 0.7), color=ALARM, linewidth=1, edgecolor=ALARM)
