"""What stands below the joints in the live view: groups, muscles, help, goals, health, the session."""

import math
from collections.abc import Iterator

from bentod.cli.view_joints import selected
from bentod.cli.view_style import BOLD, OFF, RED
from bentod.cli.view_values import Table, as_number, clock_time, entries, fields, number, text


def group_lines(frame: Table, keys: str) -> list[str]:
    """What each group does; `keys`: the one that keys are for, empty if there are none."""
    return [_group(fields(group), keys) for group in entries(frame, "groups")]


def _group(group: Table, keys: str) -> str:
    name, effort = text(group, "name"), number(group, "effort")
    what = "all together" if group.get("together") else ", ".join(selected(group)).replace("_", " ")
    who = text(group, "operator")
    drive = f"   {effort:+.0%} by {who}" if who else "   nobody moves it"
    return f"  {name:<9.9} {BOLD}{what}{OFF}{drive}" + ("   [keys]" if name == keys else "")


def muscle_lines(frame: Table) -> list[str]:
    """How strongly each site is contracted, or why that is not known."""
    emg = fields(frame.get("emg"))
    problem = text(emg, "problem")
    if problem:
        return [f"  muscles   {RED}{problem}{OFF}"]
    sites = "   ".join(f"{site} {_gauge(as_number(v))}" for site, v in fields(emg.get("effort")).items())
    paused = "   (paused)" if emg.get("paused") else ""
    return [f"  muscles   {sites}   toggles {number(emg, 'toggles'):.0f}{paused}"]


def _gauge(effort: float, width: int = 10) -> str:
    full = round(effort * width) if math.isfinite(effort) else 0
    return "█" * full + "░" * (width - full)


def assist_lines(frame: Table) -> list[str]:
    """What helps, and with what all at once may be done: a cue at any moment (thesis 5.6.6)."""
    assist = fields(frame.get("assist"))
    told = [f"  assist    {text(assist, 'reason')}"]
    if any(fields(group).get("together") for group in entries(frame, "groups")):
        return [*told, f"  {BOLD}together  push to go on, pull to go back, toggle to leave{OFF}"]
    return [*told, "  together  may be selected"] if assist.get("offers_together") else told


def goal_lines(frame: Table) -> list[str]:
    """The newest goal, and how far it is."""
    goal = fields(frame.get("goal"))
    if not goal:
        return []
    reason = f": {text(goal, 'reason')}" if goal.get("reason") else ""
    return [f"  {text(goal, 'kind'):<9} {text(goal, 'status')} {number(goal, 'progress'):.0%}{reason}"]


def health_lines(frame: Table) -> list[str]:
    """The hottest joint, the lowest supply, and who does not answer or complains."""
    joints = [fields(joint) for joint in entries(frame, "joints")]
    if not joints:
        return []
    hottest = max(joints, key=lambda joint: _known(number(joint, "temperature"), -math.inf))
    supply = min(_known(number(joint, "voltage"), math.inf) for joint in joints)
    parts = [f"hottest {text(hottest, 'name').replace('_', ' ')} {number(hottest, 'temperature'):.0f} °C"]
    parts += [f"supply {supply:.1f} V"] if math.isfinite(supply) else []
    return [f"  health    {'   '.join([*parts, *_complaints(joints)])}"]


def _complaints(joints: list[Table]) -> Iterator[str]:
    silent = [text(joint, "name") for joint in joints if joint.get("freshness") != "fresh"]
    yield f"{RED}silent: {', '.join(silent)}{OFF}" if silent else "all answer"
    for joint in joints:
        if errors := entries(joint, "errors"):
            yield f"{RED}{text(joint, 'name')}: {', '.join(map(str, errors))}{OFF}"


def _known(value: float, missing: float) -> float:
    return value if math.isfinite(value) else missing


def recording_lines(told: Table) -> list[str]:
    """How the recording goes, as `get_recording` tells it; nothing where that is refused."""
    if not told:
        return []
    file, problem = text(told, "file").rpartition("/")[2], text(told, "problem")
    if problem:
        return [f"  recording {RED}■ {problem}{OFF}"]
    if told.get("recording") is not True:
        return ["  recording ■ nothing is recorded"]
    lost = number(told, "dropped")
    missing = f"{RED}{lost:.0f} entries lost{OFF}" if lost > 0 else "nothing lost"
    size = f"{number(told, 'bytes') / 1e6:.1f} MB"
    return [f"  recording ● {clock_time(number(told, 'duration_s'))}   {size}   {missing}   {file}"]


def trial_lines(frame: Table) -> list[str]:
    """The trial that runs."""
    trial = fields(frame.get("trial"))
    if not trial:
        return []
    condition = f", {text(trial, 'condition')}" if trial.get("condition") else ""
    running = clock_time(number(frame, "time") - number(trial, "started"))
    return [f"  trial     {number(trial, 'number'):.0f} ({text(trial, 'name')}{condition})   {running}"]
